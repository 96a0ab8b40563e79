// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "formats/text.h"

#include <gtest/gtest.h>

namespace vitrine {
namespace {

TEST(Text, NamesInAnyLanguageAreAccepted) {
  for (const char* name : {"vase", "Blumenvase \xc3\xbc", "\xe8\x8a\xb1\xe7\x93\xb6", "\xf0\x9f\x8f\xba", "a b", "\xed\x9f\xbf",
                           "\xee\x80\x80", "\xf4\x8f\xbf\xbf"})
    EXPECT_TRUE(is_plain_text(name)) << name;
}

TEST(Text, WhatCouldHarmATerminalOrIsNotUtf8IsRefused) {
  const std::string_view bad[] = {"",
                                  "\x1b[2J",
                                  "a\n",
                                  "\x7f",
                                  "\xc2\x9b",
                                  "\xc3",
                                  "\xc3(",
                                  "\x80",
                                  "\xc0\xaf",
                                  "\xe0\x80\xaf",
                                  "\xf0\x80\x80\xaf",
                                  "\xed\xa0\x80",
                                  "\xf4\x90\x80\x80",
                                  "\xf8\x88\x80\x80\x80",
                                  "\xff",
                                  "\xe8\x8a",
                                  "ok\xf0\x9f\x8f",
                                  {"a\0b", 3}};
  for (const std::string_view text : bad) EXPECT_FALSE(is_plain_text(text)) << text.size();
}

}  // namespace
}  // namespace vitrine
