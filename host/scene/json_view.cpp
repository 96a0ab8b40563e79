// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/scene/json_view.h"

#include <fmt/format.h>

#include <cmath>

#include "host/base/error.h"
#include "host/scene/text.h"

namespace vitrine {
namespace {

constexpr int kDeepest = 64;             // levels of nesting; glTF itself needs fewer than ten
constexpr size_t kMostValues = 8 << 20;  // numbers, strings, arrays and objects in all: about 1 GB of memory

struct TooMuch : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace

void JsonView::fail(const std::string& problem, const std::string& remedy) const {
  throw InputError(where_.empty() ? *file_ : *file_ + ": " + printable(where_, 200), problem, remedy);
}

std::optional<JsonView> JsonView::find(const char* key) const {
  if (!value_->is_object()) fail("must be an object");
  const auto it = value_->find(key);
  if (it == value_->end()) return std::nullopt;
  return JsonView(*it, *file_, where_.empty() ? std::string(key) : where_ + '.' + key);
}

JsonView JsonView::at(const char* key) const {
  std::optional<JsonView> member = find(key);
  if (!member) fail(fmt::format("has no \"{}\"", key));
  return *member;
}

size_t JsonView::size() const {
  if (!value_->is_array()) fail("must be an array");
  return value_->size();
}

JsonView JsonView::operator[](size_t index) const {
  if (index >= size()) fail(fmt::format("has no element {}", index));
  return JsonView((*value_)[index], *file_, fmt::format("{}[{}]", where_, index));
}

double JsonView::number(double low, double high) const {
  if (!value_->is_number()) fail("must be a number");
  const double value = value_->get<double>();
  if (!std::isfinite(value) || value < low || value > high)
    fail(fmt::format("is {}, but must lie between {} and {}", value, low, high));
  return value;
}

int64_t JsonView::integer(int64_t low, int64_t high) const {
  const double value = number(static_cast<double>(low), static_cast<double>(high));
  if (value != std::floor(value)) fail(fmt::format("is {}, but must be a whole number", value));
  return static_cast<int64_t>(value);
}

const std::string& JsonView::text() const {
  if (!value_->is_string()) fail("must be a string");
  return value_->get_ref<const std::string&>();
}

bool JsonView::boolean() const {
  if (!value_->is_boolean()) fail("must be true or false");
  return value_->get<bool>();
}

void JsonView::numbers(std::span<float> out, double low, double high) const {
  if (size() != out.size()) fail(fmt::format("must have {} numbers", out.size()));
  for (size_t i = 0; i < out.size(); ++i) out[i] = static_cast<float>((*this)[i].number(low, high));
}

double JsonView::number_or(const char* key, double otherwise, double low, double high) const {
  const std::optional<JsonView> member = find(key);
  return member ? member->number(low, high) : otherwise;
}

int64_t JsonView::integer_or(const char* key, int64_t otherwise, int64_t low, int64_t high) const {
  const std::optional<JsonView> member = find(key);
  return member ? member->integer(low, high) : otherwise;
}

std::string JsonView::text_or(const char* key, const std::string& otherwise) const {
  const std::optional<JsonView> member = find(key);
  return member ? member->text() : otherwise;
}

bool JsonView::boolean_or(const char* key, bool otherwise) const {
  const std::optional<JsonView> member = find(key);
  return member ? member->boolean() : otherwise;
}

int JsonView::index_or_none(const char* key, const char* collection, size_t count) const {
  const std::optional<JsonView> member = find(key);
  if (!member) return -1;
  const int64_t index = member->integer(0, INT32_MAX);
  if (static_cast<size_t>(index) >= count) member->fail(fmt::format("is {}, but there are {} {}", index, count, collection));
  return static_cast<int>(index);
}

std::optional<JsonView> JsonView::extension(const char* name) const {
  const std::optional<JsonView> extensions = find("extensions");
  return extensions ? extensions->find(name) : std::nullopt;
}

nlohmann::json parse_json(std::span<const uint8_t> text, const std::string& file) {
  size_t values = 0;
  const auto bound = [&](int depth, nlohmann::json::parse_event_t, nlohmann::json&) {
    if (depth > kDeepest) throw TooMuch("is nested too deeply");
    if (++values > kMostValues) throw TooMuch("has too many values");
    return true;
  };
  try {
    return nlohmann::json::parse(text.begin(), text.end(), bound);
  } catch (const TooMuch& e) {
    throw InputError(file, std::string("its JSON ") + e.what(), "reduce the model");
  } catch (const nlohmann::json::parse_error& e) {
    throw InputError(file, fmt::format("its JSON is wrong at byte {}", e.byte), "export the model anew");
  } catch (const nlohmann::json::exception&) {
    throw InputError(file, "its JSON holds a number out of range", "export the model anew");
  }
}

}  // namespace vitrine
