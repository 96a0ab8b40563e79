// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "tools/commands/inspect_report.h"

#include <fmt/format.h>

#include <vector>

#include "tools/commands/html.h"

namespace vitrine {
namespace {

constexpr const char* kBarStyle = ".bar{background:#3b7ea1;height:.8em;min-width:1px}";

std::vector<uint64_t> bytes_of_levels(const ImageView& image, const fb::Field& field) {
  const FieldShape shape = image.shape_of(field);
  std::vector<uint64_t> bytes(shape.pyramid.level_count, 0);
  for (int node = 0; node < shape.node_count(); ++node) bytes[shape.level_of(node)] += field.node_bytes()->Get(node);
  return bytes;
}

void add_row(std::string& html, const std::string& what, uint64_t bytes, uint64_t all) {
  html += fmt::format("<tr><td>{}</td><td class=n>{}</td><td style=\"width:50%\"><div class=bar style=\"width:{:.2f}%\"></div></td></tr>\n",
                      html_escaped(what), bytes, 100.0 * static_cast<double>(bytes) / static_cast<double>(all));
}

}  // namespace

void write_inspect_report(const std::filesystem::path& file, const std::string& image_name, const ImageView& image, const nlohmann::json& summary) {
  std::string html = fmt::format("<!doctype html><meta charset=utf-8><title>{0}</title><style>{1}{2}</style><h1>{0}</h1>\n", html_escaped(image_name), kPageStyle, kBarStyle);
  html += fmt::format(
      "<p>Version {}, {} bytes, {} x {} pixels, {} filter.</p><h2>Axes</h2><table><tr><th>axis<th>kind<th>samples<th>samples a "
      "frame at most</tr>\n",
      image.version(), image.file_bytes(), image.directory().width(), image.directory().height(),
      summary["filter"].get<std::string>());
  for (const auto& axis : summary["axes"])
    html += fmt::format("<tr><td>{}<td>{}<td class=n>{}<td class=n>{}</tr>\n", html_escaped(axis["name"].get<std::string>()), axis["kind"].get<std::string>(),
                        axis["samples"].get<int>(), axis["max_speed"].get<double>());
  html += "</table><h2>Plan</h2><table>\n";
  for (const auto& [key, value] : summary["plan"].items()) html += fmt::format("<tr><td>{}<td class=n>{}</tr>\n", key, value.dump());
  html += "</table><h2>Bytes</h2><table>\n";
  for (const fb::Object* object : *image.directory().objects()) {
    add_row(html, object->name()->str() + " mesh", image.section(object->mesh()).size(), image.file_bytes());
    for (const fb::Field* field : *object->fields()) {
      const std::vector<uint64_t> levels = bytes_of_levels(image, *field);
      for (size_t level = 0; level < levels.size(); ++level)
        add_row(html, fmt::format("{} {} level {}", object->name()->str(), field->layer()->str(), level), levels[level], image.file_bytes());
    }
  }
  html += "</table>\n";
  write_page(file, html);
}

}  // namespace vitrine
