// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/bench/video_access.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <set>
#include <sstream>

namespace vitrine {
namespace {

// Counts as frames come in decoding order.
class Group {
 public:
  void add(bool key, bool referenced) {
    if (key) before_ = 0;
    most_ = std::max(most_, before_ + 1);
    if (referenced) ++before_;
  }
  int most() const { return most_; }

 private:
  int before_ = 0, most_ = 0;  // frames since the key frame that others may refer to
};

// body(unit) for what follows each start code 00 00 01.
template <typename Body>
void for_each_unit(std::span<const std::byte> stream, const Body& body) {
  for (size_t i = 0; i + 5 < stream.size(); ++i)
    if (stream[i] == std::byte{0} && stream[i + 1] == std::byte{0} && stream[i + 2] == std::byte{1}) body(stream.subspan(i + 3));
}

int byte_of(std::span<const std::byte> unit, size_t i) { return std::to_integer<int>(unit[i]); }

// The number that a line of trace_headers ends with, where the line is of that name.
bool reads(const std::string& line, const std::string& name, int& value) {
  const size_t at = line.find(' ' + name + ' '), equals = line.rfind("= ");
  if (at == std::string::npos || equals == std::string::npos) return false;
  value = std::atoi(line.c_str() + equals + 2);
  return true;
}

// The state of an AV1 decoder as far as who needs whom.
class Av1Frames {
 public:
  void begin() { needs_.clear(), inter_ = shown_ = true; }
  void set_type(int type) { inter_ = type == 1, key_ = type == 0; }
  void set_shown(bool shown) { shown_ = shown; }
  void refer(int slot) {
    const auto& theirs = slots_[static_cast<size_t>(slot)];
    if (inter_) needs_.insert(theirs.begin(), theirs.end());
  }
  // The frame's header is complete. A key frame that is shown fills all slots, and does not say so.
  void end(int refresh) {
    needs_.insert(++number_);
    most_ = std::max(most_, static_cast<int>(needs_.size()));
    for (size_t slot = 0; slot < slots_.size(); ++slot)
      if ((key_ && shown_) || (refresh >> slot & 1)) slots_[slot] = needs_;
  }
  int most() const { return most_; }

 private:
  std::array<std::set<int>, 8> slots_;  // the frames that what lies there was decoded from, itself included
  std::set<int> needs_;
  bool inter_ = false, key_ = false, shown_ = true;
  int number_ = 0, most_ = 0;
};

}  // namespace

int decodes_of_h264(std::span<const std::byte> stream) {
  Group group;
  for_each_unit(stream, [&](std::span<const std::byte> unit) {
    const int type = byte_of(unit, 0) & 31, referenced = byte_of(unit, 0) >> 5 & 3;
    const bool first_slice = byte_of(unit, 1) & 0x80;  // first_mb_in_slice is 0
    if ((type == 1 || type == 5) && first_slice) group.add(type == 5, referenced != 0);
  });
  return group.most();
}

int decodes_of_hevc(std::span<const std::byte> stream) {
  Group group;
  for_each_unit(stream, [&](std::span<const std::byte> unit) {
    const int type = byte_of(unit, 0) >> 1 & 63;
    const bool first_slice = byte_of(unit, 2) & 0x80, key = type >= 16 && type <= 23;
    if (type < 32 && first_slice) group.add(key, key || type % 2 == 1);  // even: ..._N, not referred to
  });
  return group.most();
}

int decodes_of_mpeg4(std::span<const std::byte> stream) {
  Group group;
  for_each_unit(stream, [&](std::span<const std::byte> unit) {
    const int type = byte_of(unit, 1) >> 6;  // vop_coding_type: I, P, B
    if (byte_of(unit, 0) == 0xb6) group.add(type == 0, type != 2);
  });
  return group.most();
}

int decodes_of_av1(const std::string& headers) {
  Av1Frames frames;
  std::istringstream lines(headers);
  bool open = false;
  int refresh = 0, value = 0;
  const auto close = [&] {
    if (open) frames.end(refresh);
    open = false, refresh = 0;
  };
  for (std::string line; std::getline(lines, line);) {
    if (reads(line, "show_existing_frame", value)) {
      close();
      if (value == 0) frames.begin(), open = true;
    } else if (reads(line, "frame_type", value)) {
      frames.set_type(value);
    } else if (reads(line, "show_frame", value)) {
      frames.set_shown(value != 0);
    } else if (reads(line, "refresh_frame_flags", value)) {
      refresh = value;
    } else if (open) {
      for (int i = 0; i < 7; ++i)
        if (reads(line, "ref_frame_idx[" + std::to_string(i) + "]", value)) frames.refer(value & 7);
    }
  }
  close();
  return frames.most();
}

}  // namespace vitrine
