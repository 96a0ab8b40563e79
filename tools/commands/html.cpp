// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "tools/commands/html.h"

#include <span>

#include "hal/storage.h"
#include "host/base/error.h"

namespace vitrine {

const char* const kPageStyle =
    "body{font:14px/1.5 sans-serif;max-width:60em;margin:2em auto;color:#222}table{border-collapse:collapse;width:100%}"
    "td,th{padding:.2em .6em;text-align:left;border-bottom:1px solid "
    "#ddd}td.n{text-align:right;font-variant-numeric:tabular-nums}";

std::string html_escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '<')
      result += "&lt;";
    else if (c == '&')
      result += "&amp;";
    else if (c == '"')
      result += "&quot;";
    else
      result += c;
  }
  return result;
}

void write_page(const std::filesystem::path& file, const std::string& html) {
  const Status status = hal::write_file_atomically(file.c_str(), std::as_bytes(std::span(html)));
  if (!status.ok()) throw InputError(file.string(), status.detail(), "check that the folder exists and has room");
}

}  // namespace vitrine
