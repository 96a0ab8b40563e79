// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// A recorded script as an input device. CSV: "frame,AXIS,AXIS,..." and then a row per key: a frame number and a position in
// [0, 1] per axis. Lines end with \n or \r\n; blank lines are skipped; nothing is quoted.
#include <algorithm>
#include <array>
#include <charconv>
#include <string_view>
#include <vector>

#include "hal/backends.h"

namespace vitrine::hal {
namespace {

constexpr size_t kMaxScriptBytes = size_t{1} << 26;
constexpr int64_t kMaxFrame = 1'000'000'000;

Status malformed(const char* detail) { return {StatusCode::kMalformed, detail}; }

std::string_view trimmed(std::string_view text) {
  const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
  while (!text.empty() && blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && blank(text.back())) text.remove_suffix(1);
  return text;
}

// Cuts off and returns what stands before `separator` (all, where there is none).
std::string_view take(std::string_view& text, char separator) {
  const size_t end = std::min(text.find(separator), text.size());
  const std::string_view piece = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return trimmed(piece);
}

template <typename Number>
bool parse(std::string_view text, Number& number) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc{} && end == text.data() + text.size();
}

struct Key {
  int64_t frame = 0;
  size_t first = 0;  // of its positions
};

class ScriptInput final : public Input {
 public:
  Status read(std::string_view csv, std::span<const char* const> axis_names);
  int poll(int64_t frame, std::span<ControlEvent> events) override;

 private:
  Status read_header(std::string_view line, std::span<const char* const> axis_names);
  Status read_row(std::string_view line);
  float position(size_t column, int64_t frame) const;

  std::vector<uint16_t> axes_;  // per column: which axis of the image
  std::vector<Key> keys_;
  std::vector<float> positions_;
  size_t key_ = 0;         // the last one at or before the frame asked for
  size_t next_event_ = 0;  // of the current frame, where the caller's array was too small
  int64_t frame_ = -1;
};

Status ScriptInput::read(std::string_view csv, std::span<const char* const> axis_names) {
  if (csv.size() > kMaxScriptBytes) return malformed("the script is larger than 64 MB");
  if (csv.find('\0') != std::string_view::npos) return malformed("the script is not text");
  if (csv.starts_with("\xef\xbb\xbf")) csv.remove_prefix(3);  // a byte order mark
  bool header = true;
  while (!csv.empty()) {
    const std::string_view line = take(csv, '\n');
    if (line.empty()) continue;
    if (Status status = header ? read_header(line, axis_names) : read_row(line); !status.ok()) return status;
    header = false;
  }
  if (header) return malformed("the script is empty: it needs a header \"frame,AXIS,...\"");
  return keys_.empty() ? malformed("the script has no rows") : Status{};
}

Status ScriptInput::read_header(std::string_view line, std::span<const char* const> axis_names) {
  if (take(line, ',') != "frame") return malformed("the script's header does not begin with \"frame\"");
  while (!line.empty()) {
    const std::string_view name = take(line, ',');
    const auto found = std::find_if(axis_names.begin(), axis_names.end(), [&](const char* axis) { return name == axis; });
    if (found == axis_names.end()) return malformed("the script's header names an axis that the image has not");
    const auto axis = static_cast<uint16_t>(found - axis_names.begin());
    if (std::find(axes_.begin(), axes_.end(), axis) != axes_.end()) return malformed("the script's header names an axis twice");
    axes_.push_back(axis);
  }
  return axes_.empty() ? malformed("the script's header names no axis") : Status{};
}

Status ScriptInput::read_row(std::string_view line) {
  if (static_cast<size_t>(std::count(line.begin(), line.end(), ',')) != axes_.size())
    return malformed("a row of the script has more or fewer cells than its header");
  Key key{.first = positions_.size()};
  if (!parse(take(line, ','), key.frame) || key.frame < 0 || key.frame > kMaxFrame)
    return malformed("a frame number in the script is not a whole number from 0 to 1000000000");
  if (!keys_.empty() && key.frame <= keys_.back().frame) return malformed("frames of the script do not ascend");
  for (size_t column = 0; column < axes_.size(); ++column) {
    float value = 0;
    if (!parse(take(line, ','), value) || !(value >= 0 && value <= 1))
      return malformed("a position in the script is not a number from 0 to 1");
    positions_.push_back(value);
  }
  keys_.push_back(key);
  return {};
}

float ScriptInput::position(size_t column, int64_t frame) const {
  const Key& a = keys_[key_];
  const float from = positions_[a.first + column];
  if (key_ + 1 == keys_.size() || frame <= a.frame) return from;
  const Key& b = keys_[key_ + 1];
  const float t = static_cast<float>(frame - a.frame) / static_cast<float>(b.frame - a.frame);
  return from + t * (positions_[b.first + column] - from);
}

// Every axis of the script each frame; kQuit on the frame after the last row.
int ScriptInput::poll(int64_t frame, std::span<ControlEvent> events) {
  if (frame != frame_) next_event_ = 0;
  if (frame < frame_) key_ = 0;  // played again
  frame_ = frame;
  while (key_ + 1 < keys_.size() && keys_[key_ + 1].frame <= frame) ++key_;
  const bool over = frame > keys_.back().frame;
  const size_t total = over ? 1 : axes_.size();
  int count = 0;
  for (; next_event_ < total && count < static_cast<int>(events.size()); ++next_event_)
    events[static_cast<size_t>(count++)] =
        over ? ControlEvent{ControlKind::kQuit, 0, 1}
             : ControlEvent{ControlKind::kAbsolute, axes_[next_event_], position(next_event_, frame)};
  return count;
}

}  // namespace

Result<std::unique_ptr<Input>> create_script_input(const char* csv, size_t size, const char* const* axis_names, int axis_count) {
  auto input = std::make_unique<ScriptInput>();
  const std::span<const char* const> names(axis_names, static_cast<size_t>(std::max(axis_count, 0)));
  if (Status status = input->read({csv, size}, names); !status.ok()) return status;
  return Result<std::unique_ptr<Input>>(std::move(input));
}

}  // namespace vitrine::hal
