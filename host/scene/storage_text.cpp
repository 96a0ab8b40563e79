// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/scene/storage_text.h"

#include <algorithm>
#include <charconv>

namespace vitrine {

std::optional<StorageText> parse_storage(std::string text) {
  if (text.size() > 64) return std::nullopt;
  text.erase(std::remove(text.begin(), text.end(), ' '), text.end());
  StorageText storage;
  const char* end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, storage.amount, std::chars_format::fixed);
  if (error != std::errc() || !(storage.amount > 0 && storage.amount < 1e18)) return std::nullopt;
  std::string unit(rest, end);
  if (unit == ":1") {
    storage.unit = StorageUnit::kRatio;
    return storage.amount >= 1 ? std::optional(storage) : std::nullopt;
  }
  constexpr char kPerBlock[] = "/block";
  if (unit.ends_with(kPerBlock)) {
    storage.unit = StorageUnit::kBytesPerBlock;
    unit.resize(unit.size() - (sizeof kPerBlock - 1));
  }
  const double bytes = unit == "B" ? 1 : unit == "KB" ? 1e3 : unit == "MB" ? 1e6 : 0;
  if (bytes == 0) return std::nullopt;
  storage.amount *= bytes;
  return storage;
}

}  // namespace vitrine
