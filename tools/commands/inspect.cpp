// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "formats/image.h"
#include "hal/storage.h"
#include "host/base/error.h"
#include "host/base/output_file.h"
#include "tools/bus_error.h"
#include "tools/commands/commands.h"
#include "tools/commands/print_json.h"
#include "tools/commands/inspect_report.h"

namespace vitrine {
namespace {

const char* kind_name(fb::AxisKind kind) {
  return kind == fb::AxisKind::linear ? "linear" : kind == fb::AxisKind::periodic ? "periodic" : "discrete";
}

uint64_t field_bytes(const ImageView& image, const fb::Field& field) {
  return image.section(field.nodes()).size();
}

nlohmann::json object_json(const ImageView& image, const fb::Object& object) {
  nlohmann::json layers = nlohmann::json::array();
  uint64_t bytes = image.section(object.mesh()).size();
  for (const fb::Field* field : *object.fields()) {
    const FieldShape shape = image.shape_of(*field);
    nlohmann::json cells = nlohmann::json::array();
    for (int level = 0; level < shape.pyramid.level_count; ++level) {
      std::string cell;
      for (int axis = 0; axis < shape.space.axis_count; ++axis) cell += fmt::format("{}{}", axis ? "x" : "", shape.pyramid.cell[level][axis]);
      if (shape.pyramid.has_differences(level))
        cell += ":" + image.directory().axes()->Get(static_cast<uint32_t>(shape.pyramid.halved[level]))->name()->str();
      cells.push_back(cell.empty() ? "1" : cell);
    }
    layers.push_back({{"name", field->layer()->str()},
                      {"texture", {field->texture_width(), field->texture_height()}},
                      {"maps", field->maps()->size() / kTextureMapValues / field->patches()},
                      {"coder", fb::EnumNameNodeCoder(field->coder())},
                      {"patches", field->patches()},
                      {"bytes", field_bytes(image, *field)},
                      {"samples", shape.space.sample_count()},
                      {"blocks", shape.block_count()},
                      {"levels", cells}});
    bytes += field_bytes(image, *field);
  }
  return {{"name", object.name()->str()},
          {"representation", fb::EnumNameRepresentation(object.representation())},
          {"layers", layers},
          {"bytes", bytes},
          {"triangles", object.index_count() / 3}};
}

nlohmann::json image_json(const ImageView& image) {
  const fb::Image& directory = image.directory();
  nlohmann::json axes = nlohmann::json::array(), objects = nlohmann::json::array();
  for (const fb::Axis* axis : *directory.axes())
    axes.push_back({{"name", axis->name()->str()}, {"kind", kind_name(axis->kind())}, {"samples", axis->samples()}, {"max_speed", axis->max_speed()}});
  for (const fb::Object* object : *directory.objects()) objects.push_back(object_json(image, *object));
  const fb::Plan& plan = *directory.plan();
  return {{"version", image.version()},
          {"bytes", image.file_bytes()},
          {"resolution", {directory.width(), directory.height()}},
          {"supersampling", directory.supersampling()},
          {"filter", fb::EnumNameSurfaceFilter(directory.filter())},
          {"interpolate", directory.interpolate()},
          {"axes", axes},
          {"objects", objects},
          {"plan",
           {{"units_budget", plan.units_budget()},
            {"units_worst", plan.units_worst()},
            {"upload_worst", plan.upload_worst()},
            {"cache_bytes", plan.cache_bytes()},
            {"settle_frames", plan.settle_frames()},
            {"horizon_frames", plan.horizon_frames()}}}};
}

void print_text(const nlohmann::json& report) {
  fmt::print("version {}, {} bytes, {} x {} pixels, {} filter\n", report["version"].get<int>(), report["bytes"].get<uint64_t>(),
             report["resolution"][0].get<int>(), report["resolution"][1].get<int>(), report["filter"].get<std::string>());
  for (const auto& axis : report["axes"])
    fmt::print("axis    {:16} {:9} {:4} samples, {} a frame at most\n", axis["name"].get<std::string>(), axis["kind"].get<std::string>(),
               axis["samples"].get<int>(), axis["max_speed"].get<double>());
  for (const auto& object : report["objects"]) {
    fmt::print("object  {:16} {:9} {:6} triangles, {} bytes\n", object["name"].get<std::string>(),
               object["representation"].get<std::string>(), object["triangles"].get<int>(), object["bytes"].get<uint64_t>());
    for (const auto& layer : object["layers"])
      fmt::print("  layer {:16} {} x {} texels by {} maps, {} samples in {} blocks, levels {}, {} bytes by {}\n",
                 layer["name"].get<std::string>(), layer["texture"][0].get<int>(), layer["texture"][1].get<int>(),
                 layer["maps"].get<int>(), layer["samples"].get<int>(), layer["blocks"].get<int>(), layer["levels"].dump(),
                 layer["bytes"].get<uint64_t>(), layer["coder"].get<std::string>());
  }
  const auto& plan = report["plan"];
  fmt::print("plan    {} units a frame of {}, cache {} bytes, upload {} bytes a frame, horizon {} frames, settles in {} frames\n",
             plan["units_worst"].get<uint64_t>(), plan["units_budget"].get<uint64_t>(), plan["cache_bytes"].get<uint64_t>(),
             plan["upload_worst"].get<uint64_t>(), plan["horizon_frames"].get<int>(), plan["settle_frames"].get<int>());
}

}  // namespace

void InspectCommand::run() const {
  if (!report.empty()) check_output_file(report);
  explain_bus_errors("vitrine", image);
  auto file = hal::MappedFile::open(image.c_str());
  if (!file.ok()) throw InputError(image, file.status().detail(), "name an image that vitrine compile wrote");
  const auto opened = ImageView::open(file.value().bytes());
  if (!opened.ok()) throw InputError(image, opened.status().detail(), "compile it again");
  const nlohmann::json contents = image_json(opened.value());
  if (!report.empty()) write_inspect_report(report, image, opened.value(), contents);
  if (common.json)
    print_json(contents);
  else
    print_text(contents);
}

}  // namespace vitrine
