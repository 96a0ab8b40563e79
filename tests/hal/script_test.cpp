// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <random>
#include <string>

#include "hal/backends.h"

namespace vitrine::hal {
namespace {

constexpr const char* kAxes[] = {"view", "lamp"};

Result<std::unique_ptr<Input>> read(const std::string& csv) { return create_script_input(csv.data(), csv.size(), kAxes, 2); }

TEST(Script, PositionsBetweenRowsAreInterpolated) {
  auto input = read("frame,lamp,view\n0,0,1\r\n\n4, 1 ,0.5\n");
  ASSERT_TRUE(input.ok()) << input.status().detail();
  std::array<ControlEvent, 8> events;
  ASSERT_EQ(input.value()->poll(1, events), 2);
  EXPECT_EQ(events[0].kind, ControlKind::kAbsolute);
  EXPECT_EQ(events[0].control, 1);
  EXPECT_FLOAT_EQ(events[0].value, 0.25f);
  EXPECT_EQ(events[1].control, 0);
  EXPECT_FLOAT_EQ(events[1].value, 0.875f);
  ASSERT_EQ(input.value()->poll(4, events), 2);
  EXPECT_EQ(events[0].value, 1);
  ASSERT_EQ(input.value()->poll(5, events), 1);
  EXPECT_EQ(events[0].kind, ControlKind::kQuit);
}

TEST(Script, AnArrayTooSmallGetsTheRestNextTime) {
  auto input = read("frame,view,lamp\n0,0.25,0.75\n9,1,1\n");
  std::array<ControlEvent, 1> one;
  ASSERT_EQ(input.value()->poll(0, one), 1);
  EXPECT_EQ(one[0].value, 0.25f);
  ASSERT_EQ(input.value()->poll(0, one), 1);
  EXPECT_EQ(one[0].value, 0.75f);
  EXPECT_EQ(input.value()->poll(0, one), 0);
}

TEST(Script, RowsThatStartLateHoldTheFirstPosition) {
  auto input = read("frame,view\n10,0.5\n20,1\n");
  std::array<ControlEvent, 2> events;
  ASSERT_EQ(input.value()->poll(0, events), 1);
  EXPECT_EQ(events[0].value, 0.5f);
}

TEST(Script, EveryKindOfMistakeIsRefusedWithASentence) {
  const std::string zero("frame,view\n0,0\0\n", 16);
  for (const std::string& csv : {std::string(),
                                 std::string("\n\n"),
                                 std::string("view,frame\n0,0\n"),
                                 std::string("frame\n0\n"),
                                 std::string("frame,view\n"),
                                 std::string("frame,door\n0,0\n"),
                                 std::string("frame,view,view\n0,0,0\n"),
                                 std::string("frame,view\n0\n"),
                                 std::string("frame,view\n0,0,0\n"),
                                 std::string("frame,view\n-1,0\n"),
                                 std::string("frame,view\n1.5,0\n"),
                                 std::string("frame,view\n0,0\n0,1\n"),
                                 std::string("frame,view\n5,0\n4,1\n"),
                                 std::string("frame,view\n0,1.01\n"),
                                 std::string("frame,view\n0,-0.1\n"),
                                 std::string("frame,view\n0,nan\n"),
                                 std::string("frame,view\n0,inf\n"),
                                 std::string("frame,view\n0,abc\n"),
                                 std::string("frame,view\n0,0.5x\n"),
                                 std::string("frame,view\n0,\n"),
                                 std::string("frame,view\n99999999999999999999,0\n"),
                                 std::string("frame,view\n2000000000,0\n"),
                                 zero}) {
    const auto input = read(csv);
    EXPECT_FALSE(input.ok()) << csv;
    EXPECT_GT(std::string(input.status().detail()).size(), 10u);
  }
}

TEST(Script, RandomBytesNeverCrashIt) {
  std::mt19937 random(1);
  const std::string alphabet = "frame,view lamp\n\r0123456789.-+e\xef\xbb\xbf\"";
  for (int i = 0; i < 20000; ++i) {
    std::string csv = i % 2 ? "frame,view\n" : "";
    for (size_t n = random() % 40; n > 0; --n) csv += alphabet[random() % alphabet.size()];
    auto input = read(csv);
    std::array<ControlEvent, 2> events;
    if (input.ok()) input.value()->poll(static_cast<int64_t>(random() % 100), events);
  }
}

}  // namespace
}  // namespace vitrine::hal
