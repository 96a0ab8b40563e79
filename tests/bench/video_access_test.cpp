// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/bench/video_access.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

namespace vitrine::test {
namespace {

std::vector<std::byte> units(const std::vector<std::vector<int>>& headers) {
  std::vector<std::byte> stream;
  for (const auto& header : headers) {
    for (const int byte : {0, 0, 1}) stream.push_back(std::byte(byte));
    for (const int byte : header) stream.push_back(std::byte(byte));
    for (int i = 0; i < 4; ++i) stream.push_back(std::byte{0x55});
  }
  return stream;
}

// H.264: parameter sets, then slices that begin a picture. 0x65: key; 0x41: referred to; 0x01: not.
TEST(VideoAccess, h264_counts_what_others_refer_to_since_the_key_frame) {
  EXPECT_EQ(decodes_of_h264(units({{0x67, 0}, {0x68, 0}, {0x65, 0x88}, {0x41, 0x9a}, {0x01, 0x9e}, {0x01, 0x9e}})), 3);
  EXPECT_EQ(decodes_of_h264(units({{0x65, 0x88}, {0x41, 0x9a}, {0x41, 0x9a}, {0x01, 0x9e}, {0x65, 0x88}, {0x01, 0x9e}})), 4);
  EXPECT_EQ(decodes_of_h264(units({{0x65, 0x88}, {0x65, 0x88}})), 1);
  EXPECT_EQ(decodes_of_h264(units({{0x65, 0x88}, {0x65, 0x08}})), 1) << "a second slice of the same picture";
}

// HEVC, two bytes of header: 19 IDR, 1 TRAIL_R, 0 TRAIL_N.
TEST(VideoAccess, hevc_counts_what_others_refer_to_since_the_key_frame) {
  const int key = 19 << 1, referred = 1 << 1, other = 0;
  EXPECT_EQ(decodes_of_hevc(units({{64, 1, 0}, {key, 1, 0x80}, {referred, 1, 0x80}, {other, 1, 0x80}, {other, 1, 0x80}})), 3);
  EXPECT_EQ(decodes_of_hevc(units({{key, 1, 0x80}, {referred, 1, 0x80}, {key, 1, 0x80}, {other, 1, 0x80}})), 2);
}

TEST(VideoAccess, mpeg4_counts_what_others_refer_to_since_the_key_frame) {
  EXPECT_EQ(decodes_of_mpeg4(units({{0xb6, 0x10}, {0xb6, 0x50}, {0xb6, 0x90}, {0xb6, 0x90}, {0xb6, 0x50}, {0xb6, 0x90}})), 4);
}

std::string av1_frame(int type, bool shown, int refresh, const std::vector<int>& refers) {
  std::string text;
  const auto line = [&](const std::string& name, int value) {
    text += "[trace] 24   " + name + "    0 = " + std::to_string(value) + "\n";
  };
  line("show_existing_frame", 0);
  line("frame_type", type);
  line("show_frame", shown);
  if (!(type == 0 && shown)) line("refresh_frame_flags", refresh);
  for (size_t i = 0; i < refers.size(); ++i) line("ref_frame_idx[" + std::to_string(i) + "]", refers[i]);
  return text;
}

const std::string kAv1Key = av1_frame(0, true, 0, {});

TEST(VideoAccess, av1_counts_what_a_frame_may_be_made_of) {
  const std::string fourth = av1_frame(1, false, 1, {2, 2}), second = av1_frame(1, false, 2, {2, 0});
  EXPECT_EQ(decodes_of_av1(kAv1Key), 1);
  EXPECT_EQ(decodes_of_av1(kAv1Key + fourth + second), 3);
  // The first frame is kept, but the third does not refer to it; and then it does.
  const std::string first = av1_frame(1, true, 4, {3, 1, 0});
  EXPECT_EQ(decodes_of_av1(kAv1Key + fourth + second + first + av1_frame(1, true, 0, {3, 1, 0})), 4);
  EXPECT_EQ(decodes_of_av1(kAv1Key + fourth + second + first + av1_frame(1, true, 0, {2, 1, 0})), 5);
}

TEST(VideoAccess, av1_begins_anew_with_a_key_frame) {
  const std::string chain = av1_frame(1, true, 255, {0});
  EXPECT_EQ(decodes_of_av1(kAv1Key + chain + chain + kAv1Key + chain), 3);
}

}  // namespace
}  // namespace vitrine::test
