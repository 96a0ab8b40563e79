// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "hal/storage.h"
#include "host/base/error.h"
#include "host/base/output_file.h"
#include "host/compile/compile.h"
#include "host/frames/store.h"
#include "host/trace/tracer.h"
#include "host/verify/reference.h"
#include "tools/axis_position.h"
#include "tools/commands/commands.h"
#include "tools/commands/print_json.h"
#include "tools/commands/scene_input.h"
#include "tools/png.h"
#include "tools/usage_error.h"

namespace vitrine {
namespace {

bool ends_with(const std::string& text, const char* suffix) {
  const std::string s = suffix;
  return text.size() >= s.size() && text.compare(text.size() - s.size(), s.size(), s) == 0;
}

void write_picture(const std::string& file, const Frame& frame, float exposure) {
  std::vector<uint8_t> rgb;
  rgb.reserve(frame.combined.size() * 3);
  for (const glm::vec3& radiance : frame.combined)
    for (int c = 0; c < 3; ++c) rgb.push_back(srgb8_from_radiance(radiance[c] * exposure));
  const Status status = write_png(file, frame.width, frame.height, rgb);
  if (!status.ok()) throw InputError(file, status.detail(), "check that the folder exists and has room");
}

void write_layers(const std::string& file, const Scene& scene, const Frame& frame) {
  const std::string exr = exr_of_frame(scene, frame);
  const Status status = hal::write_file_atomically(file.c_str(), std::as_bytes(std::span(exr)));
  if (!status.ok()) throw InputError(file, status.detail(), "check that the folder exists and has room");
}

// Estimated while tracing: decibels between two seeds, per object and layer.
nlohmann::json noise_of_objects(const Scene& scene, const Frame& frame) {
  nlohmann::json objects = nlohmann::json::object();
  for (const NoiseReport& n : frame.noise)
    objects[scene.objects[static_cast<size_t>(n.object)].name] = {{"diffuse_db", n.diffuse_db}, {"specular_db", n.specular_db}};
  return objects;
}

}  // namespace

void RenderCommand::run() const {
  if (!ends_with(output, ".exr") && !ends_with(output, ".png"))
    throw InputError(output, "its ending says no format", "end it in .exr (linear) or .png (sRGB)");
  if (layers && !ends_with(output, ".exr")) throw InputError(output, "a PNG holds no layers", "write an .exr, or leave --layers out");
  check_output_file(output);
  const auto jobs = limit_jobs(common);
  const auto progress = make_progress(common);
  const auto loaded = load_scene_with(scene, common, [&](Scene& s) {
    apply_size(s, size);
    if (samples_per_pixel > 0) s.settings.samples_per_pixel = samples_per_pixel;
  });
  std::vector<std::string> names;
  for (const Axis& axis : loaded->axes) names.push_back(axis.name);
  Position position;
  try {
    position = parse_position(at, names, loaded->space());
  } catch (const PositionError& error) {
    throw UsageError(std::string("--at: ") + error.what());
  }

  TraceOptions trace = trace_options(*loaded);
  trace.noise_db = noise_db;
  trace.views = 1;
  trace.seed = seed;
  trace.layers = layers;
  Tracer tracer(*loaded);
  const Frame frame = tracer.render(position, trace, *progress);
  if (ends_with(output, ".exr"))
    write_layers(output, *loaded, frame);
  else
    write_picture(output, frame, loaded->settings.exposure);
  if (common.json)
    print_json({{"output", output},
                {"width", frame.width},
                {"height", frame.height},
                {"samples_per_pixel", frame.rays_per_pixel},
                {"noise", noise_of_objects(*loaded, frame)},
                {"max_radiance", loaded->settings.max_radiance}});
}

}  // namespace vitrine
