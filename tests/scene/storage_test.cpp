// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/scene/storage_text.h"

#include <gtest/gtest.h>

namespace vitrine {
namespace {

TEST(Storage, AmountsAreReadAsWritten) {
  const auto expect = [](const char* text, double amount, StorageUnit unit) {
    const auto storage = parse_storage(text);
    ASSERT_TRUE(storage) << text;
    EXPECT_DOUBLE_EQ(storage->amount, amount) << text;
    EXPECT_EQ(storage->unit, unit) << text;
  };
  expect("384:1", 384, StorageUnit::kRatio);
  expect(" 12.5 : 1 ", 12.5, StorageUnit::kRatio);
  expect("150 KB/block", 150e3, StorageUnit::kBytesPerBlock);
  expect("1 MB / block", 1e6, StorageUnit::kBytesPerBlock);
  expect("12MB", 12e6, StorageUnit::kBytes);
  expect("4223232 B", 4223232, StorageUnit::kBytes);
}

TEST(Storage, WhatIsNoAmountIsRefused) {
  for (const char* text : {"", "12", "MB", "-5 MB", "0:1", "0.5:1", "nan MB", "inf:1", "1e5 B", "1.2.3 MB", "5 GB", "100:2", "12 MB/blocks", "12 /block"})
    EXPECT_FALSE(parse_storage(text)) << text;
  std::string endless(100, '9');
  endless += " B";
  EXPECT_FALSE(parse_storage(endless));
}

}  // namespace
}  // namespace vitrine
