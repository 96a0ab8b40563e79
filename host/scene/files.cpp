// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/scene/files.h"

#include <array>
#include <fstream>
#include <stdexcept>

#include "host/base/error.h"
#include "host/scene/text.h"

namespace fs = std::filesystem;

namespace vitrine {
namespace {

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

std::string undo_percent_encoding(const std::string& uri) {
  std::string text;
  for (size_t i = 0; i < uri.size(); ++i) {
    if (uri[i] != '%') {
      text += uri[i];
      continue;
    }
    const int high = i + 2 < uri.size() ? hex_digit(uri[i + 1]) : -1;
    const int low = i + 2 < uri.size() ? hex_digit(uri[i + 2]) : -1;
    if (high < 0 || low < 0) throw std::runtime_error("has a broken percent-encoding");
    text += static_cast<char>(high * 16 + low);
    i += 2;
  }
  return text;
}

std::array<int8_t, 256> base64_values() {
  std::array<int8_t, 256> values;
  values.fill(-1);
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  for (size_t i = 0; i < digits.size(); ++i) values[static_cast<unsigned char>(digits[i])] = static_cast<int8_t>(i);
  return values;
}

Bytes decode_base64(std::string_view text) {
  static const std::array<int8_t, 256> values = base64_values();
  while (!text.empty() && text.back() == '=') text.remove_suffix(1);
  if (text.size() % 4 == 1) throw std::runtime_error("has truncated base64 data");
  Bytes bytes;
  bytes.reserve(text.size() / 4 * 3 + 2);
  uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    const int value = values[static_cast<unsigned char>(c)];
    if (value < 0) throw std::runtime_error("has a character that is not base64");
    bits = bits << 6 | static_cast<uint32_t>(value);
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes.push_back(static_cast<uint8_t>(bits >> count));
  }
  return bytes;
}

// Whether `path` (normal) lies in `root` (normal).
bool lies_within(const fs::path& path, const fs::path& root) {
  const fs::path relative = path.lexically_relative(root);
  return !relative.empty() && *relative.begin() != "..";
}

}  // namespace

std::string shown(const fs::path& path) { return printable(path.string(), 400); }

Bytes read_file(const fs::path& path, uint64_t largest) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) throw InputError(shown(path), "there is no such file", "check the name");
  if (!fs::is_regular_file(status)) throw InputError(shown(path), "this is not a file", "name a file");
  const uint64_t size = fs::file_size(path, error);
  if (error) throw InputError(shown(path), "its size cannot be read", "check the disk");
  if (size > largest) throw InputError(shown(path), "it is larger than " + std::to_string(largest) + " bytes", "reduce it");
  std::ifstream stream(path, std::ios::binary);
  Bytes bytes(size);
  if (size > 0) stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
  if (!stream) throw InputError(shown(path), "it cannot be read", "check its permissions");
  return bytes;
}

void write_file(const fs::path& path, const void* data, size_t size) {
  std::ofstream stream(path, std::ios::binary);
  stream.write(static_cast<const char*>(data), static_cast<std::streamsize>(size));
  stream.close();
  if (!stream) throw InputError(shown(path), "it cannot be written", "check the folder's permissions and the free space");
}

bool is_data_uri(const std::string& uri) { return uri.rfind("data:", 0) == 0; }

Bytes decode_data_uri(const std::string& uri) {
  const size_t comma = uri.find(',');
  if (comma == std::string::npos) throw std::runtime_error("is a data: URI without data");
  const std::string_view head(uri.data(), comma);
  if (head.size() < 12 || head.substr(head.size() - 7) != ";base64")
    throw std::runtime_error("is a data: URI that is not base64");
  return decode_base64(std::string_view(uri).substr(comma + 1));
}

fs::path file_of_uri(const std::string& uri, const fs::path& folder, const fs::path& root) {
  const std::string text = undo_percent_encoding(uri);
  if (text.empty()) throw std::runtime_error("is empty");
  if (text.find('\0') != std::string::npos) throw std::runtime_error("holds a zero byte");
  const size_t colon = text.find(':');
  if (colon != std::string::npos && text.find('/') > colon)
    throw std::runtime_error("has a scheme (only relative files and data: are read)");
  const fs::path relative(text);
  if (relative.is_absolute() || text[0] == '\\') throw std::runtime_error("is an absolute path");
  const fs::path path = (fs::absolute(folder) / relative).lexically_normal();
  if (!lies_within(path, fs::absolute(root).lexically_normal())) throw std::runtime_error("leads out of the scene's folder");
  return folder / relative;
}

}  // namespace vitrine
