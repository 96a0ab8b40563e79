// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// How a scene or a command line says what an image may weigh.
#pragma once

#include <optional>
#include <string>

namespace vitrine {

enum class StorageUnit { kRatio, kBytesPerBlock, kBytes };
struct StorageText {
  double amount = 0;  // > 0; of kRatio: raw bytes over image bytes, >= 1
  StorageUnit unit = StorageUnit::kBytes;
};

// "384:1", "150 KB/block", "12 MB", blanks anywhere between; nothing where the text is none of these.
std::optional<StorageText> parse_storage(std::string text);

}  // namespace vitrine
