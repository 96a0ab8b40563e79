// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <optional>

namespace vitrine {

// One object on one line of standard output. File names may be any bytes; what is not UTF-8 in them is shown as U+FFFD.
inline void print_json(const nlohmann::json& json) {
  fmt::print("{}\n", json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
}

// null where there is none.
inline nlohmann::json json_or_null(const std::optional<double>& number) { return number ? nlohmann::json(*number) : nlohmann::json(); }

}  // namespace vitrine
