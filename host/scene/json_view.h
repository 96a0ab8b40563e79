// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// A place in a JSON document that is not trusted: every access checks type and range and throws InputError that names
// the place ("model.glb: meshes[2].primitives[0].mode: ...").
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>

namespace vitrine {

class JsonView {
 public:
  // `value` and `file` must outlive the view. `where` is the place within the file, empty for the document itself.
  JsonView(const nlohmann::json& value, const std::string& file, std::string where)
      : value_(&value), file_(&file), where_(std::move(where)) {}

  // Members of an object. `find` is empty where the key is absent; `at` fails there. Both fail on what is no object.
  std::optional<JsonView> find(const char* key) const;
  JsonView at(const char* key) const;
  // Elements of an array; size() fails on what is none, and so does an index out of range.
  size_t size() const;
  JsonView operator[](size_t index) const;

  // The value itself; finite and within [low, high].
  double number(double low, double high) const;
  int64_t integer(int64_t low, int64_t high) const;
  const std::string& text() const;
  bool boolean() const;
  void numbers(std::span<float> out, double low, double high) const;  // an array of exactly out.size() numbers

  // Members with defaults.
  double number_or(const char* key, double otherwise, double low, double high) const;
  int64_t integer_or(const char* key, int64_t otherwise, int64_t low, int64_t high) const;
  std::string text_or(const char* key, const std::string& otherwise) const;
  bool boolean_or(const char* key, bool otherwise) const;
  // An index into the root's array `collection` of `count` elements; -1 where the key is absent.
  int index_or_none(const char* key, const char* collection, size_t count) const;
  // The member of "extensions" with this name.
  std::optional<JsonView> extension(const char* name) const;

  const std::string& where() const { return where_; }
  [[noreturn]] void fail(const std::string& problem, const std::string& remedy = "export the model anew or repair it") const;

 private:
  const nlohmann::json* value_;
  const std::string* file_;
  std::string where_;
};

// Reads JSON text with bounds on its depth and on the number of its values. Throws InputError naming `file`.
nlohmann::json parse_json(std::span<const uint8_t> text, const std::string& file);

}  // namespace vitrine
