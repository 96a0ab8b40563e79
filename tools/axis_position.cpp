// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "tools/axis_position.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <string_view>

namespace vitrine {
namespace {

template <typename Number>
bool parse_number(std::string_view text, Number& number) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc{} && end == text.data() + text.size();
}

int axis_of(const std::vector<std::string>& names, const std::string& name) {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found != names.end()) return static_cast<int>(found - names.begin());
  throw PositionError(fmt::format("there is no axis \"{}\": there is {}", name, names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "))));
}

float parse_value(const ParameterSpace& space, int axis, const std::string& name, const std::string& text) {
  float position = 0;
  int sample = 0;
  if (text.starts_with('#')) {
    if (!parse_number(std::string_view(text).substr(1), sample) || sample < 0 || sample >= space.axes[axis].samples)
      throw PositionError(
          fmt::format("\"{}\" is no sample of axis {}: its samples are #0 to #{}", text, name, space.axes[axis].samples - 1));
    GridIndex index{};
    index[axis] = sample;
    return space.position_of(index)[axis];
  }
  if (!parse_number(std::string_view(text), position) || !(position >= 0 && position <= 1))
    throw PositionError(
        fmt::format("\"{}\" is no position of axis {}: give a number from 0 to 1, or a grid sample as {}=#0", text, name, name));
  return position;
}

}  // namespace

Position parse_position(const std::string& text, const std::vector<std::string>& names, const ParameterSpace& space) {
  Position position{};
  std::vector<bool> given(names.size());
  for (size_t begin = 0; !text.empty() && begin <= text.size();) {
    const size_t end = std::min(text.find(',', begin), text.size());
    const std::string item = text.substr(begin, end - begin);
    const size_t equals = item.find('=');
    if (equals == std::string::npos) throw PositionError(fmt::format("\"{}\" is not AXIS=POSITION: write view=0.5 or view=#3", item));
    const std::string name = item.substr(0, equals);
    const int axis = axis_of(names, name);
    if (given[static_cast<size_t>(axis)]) throw PositionError(fmt::format("axis {} is given twice: give it once", name));
    given[static_cast<size_t>(axis)] = true;
    position[static_cast<size_t>(axis)] = parse_value(space, axis, name, item.substr(equals + 1));
    begin = end + 1;
  }
  return position;
}

}  // namespace vitrine
