// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/scene/toml_view.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "host/base/error.h"
#include "host/scene/text.h"

namespace vitrine {
namespace {

[[noreturn]] void fail_type(const TomlView& view, const char* key, const std::string& type) {
  view.fail(fmt::format("\"{}\" is not {}", key, type), fmt::format("write {} = {}", key, type));
}

double checked(const TomlView& view, const char* key, const toml::node& node, double low, double high) {
  const std::optional<double> value = node.is_number() ? node.value<double>() : std::nullopt;
  if (!value) fail_type(view, key, "a number");
  if (!std::isfinite(*value) || *value < low || *value > high)
    view.fail(fmt::format("\"{}\" is {}", key, *value), fmt::format("it must lie between {} and {}", low, high));
  return *value;
}

std::vector<std::string> texts_of(const TomlView& view, const char* key, const toml::node& node, const char* type) {
  const toml::array* array = node.as_array();
  if (!array) fail_type(view, key, type);
  std::vector<std::string> texts;
  for (const toml::node& element : *array) {
    if (!element.is_string()) fail_type(view, key, type);
    texts.push_back(**element.as_string());
  }
  return texts;
}

}  // namespace

void TomlView::fail(const std::string& problem, const std::string& remedy) const { throw InputError(place_, problem, remedy); }

void TomlView::allow(const std::vector<std::string>& keys) const {
  for (const auto& [key, value] : *table_) {
    const std::string name(key.str());
    if (std::find(keys.begin(), keys.end(), name) == keys.end())
      fail("there is no key " + in_quotes(name) + " here",
           "did you mean " + in_quotes(nearest_word(name, keys)) + "? Known are " + joined(keys, 20));
  }
}

std::string TomlView::text(const char* key, const std::string& otherwise) const {
  const toml::node* node = table_->get(key);
  if (!node) return otherwise;
  if (!node->is_string()) fail_type(*this, key, "a string in quotes");
  return **node->as_string();
}

bool TomlView::boolean(const char* key, bool otherwise) const {
  const toml::node* node = table_->get(key);
  if (!node) return otherwise;
  if (!node->is_boolean()) fail_type(*this, key, "true or false");
  return **node->as_boolean();
}

double TomlView::number(const char* key, double otherwise, double low, double high) const {
  const toml::node* node = table_->get(key);
  return node ? checked(*this, key, *node, low, high) : otherwise;
}

int TomlView::integer(const char* key, int otherwise, int low, int high) const {
  const double value = number(key, otherwise, low, high);
  if (value != std::floor(value)) fail_type(*this, key, "a whole number");
  return static_cast<int>(value);
}

std::vector<double> TomlView::numbers(const char* key, size_t count, double low, double high) const {
  const toml::array* array = table_->get(key) ? table_->get(key)->as_array() : nullptr;
  if (!array || array->size() != count) fail_type(*this, key, fmt::format("a list of {} numbers", count));
  std::vector<double> values;
  for (const toml::node& element : *array) values.push_back(checked(*this, key, element, low, high));
  return values;
}

glm::vec3 TomlView::vec3(const char* key, glm::vec3 otherwise, double low, double high) const {
  if (!has(key)) return otherwise;
  const std::vector<double> v = numbers(key, 3, low, high);
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

std::vector<std::string> TomlView::texts(const char* key) const {
  const toml::node* node = table_->get(key);
  return node ? texts_of(*this, key, *node, "a list of strings") : std::vector<std::string>();
}

std::vector<std::vector<std::string>> TomlView::text_lists(const char* key) const {
  const char* type = "a list of lists of node names";
  const toml::array* array = table_->get(key) ? table_->get(key)->as_array() : nullptr;
  if (!array) fail_type(*this, key, type);
  std::vector<std::vector<std::string>> lists;
  for (const toml::node& element : *array) lists.push_back(texts_of(*this, key, element, type));
  return lists;
}

std::optional<TomlView> TomlView::table(const char* key) const {
  const toml::node* node = table_->get(key);
  if (!node) return std::nullopt;
  if (!node->is_table()) fail_type(*this, key, "a table");
  return TomlView(*node->as_table(), place_ + ": " + key);
}

void TomlView::for_each_table(const char* key, const std::function<void(const TomlView&)>& visit) const {
  const toml::node* node = table_->get(key);
  if (!node) return;
  const toml::array* array = node->as_array();
  if (!array) fail(fmt::format("\"{}\" is not a list of tables", key), fmt::format("write [[{}]]", key));
  size_t number = 0;
  for (const toml::node& element : *array) {
    ++number;
    if (!element.is_table()) fail(fmt::format("\"{}\" is not a list of tables", key), fmt::format("write [[{}]]", key));
    visit(TomlView(*element.as_table(), fmt::format("{}: {} {}", place_, key, number)));
  }
}

}  // namespace vitrine
