// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// A table of a TOML file that is not trusted: types and ranges are checked, unknown keys refused.
#pragma once

#include <toml++/toml.h>

#include <functional>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace vitrine {

class TomlView {
 public:
  // `place` is what messages begin with: the file, and the table within it.
  TomlView(const toml::table& table, std::string place) : table_(&table), place_(std::move(place)) {}

  // Fails on the first key that is none of these and names the nearest one.
  void allow(const std::vector<std::string>& keys) const;
  bool has(const char* key) const { return table_->contains(key); }

  // Values; absent keys give `otherwise`, other types and values out of [low, high] fail.
  std::string text(const char* key, const std::string& otherwise) const;
  bool boolean(const char* key, bool otherwise) const;
  double number(const char* key, double otherwise, double low, double high) const;
  int integer(const char* key, int otherwise, int low, int high) const;
  glm::vec3 vec3(const char* key, glm::vec3 otherwise, double low, double high) const;
  std::vector<double> numbers(const char* key, size_t count, double low, double high) const;
  std::vector<std::string> texts(const char* key) const;
  std::vector<std::vector<std::string>> text_lists(const char* key) const;
  bool is_text(const char* key) const { return table_->get(key) && table_->get(key)->is_string(); }

  std::optional<TomlView> table(const char* key) const;
  void for_each_table(const char* key, const std::function<void(const TomlView&)>& visit) const;  // [[key]]

  const std::string& place() const { return place_; }
  // "PLACE: key ..." with what is wrong and what to do.
  [[noreturn]] void fail(const std::string& problem, const std::string& remedy) const;

 private:
  const toml::table* table_;
  std::string place_;
};

}  // namespace vitrine
