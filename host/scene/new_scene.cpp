// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/scene/new_scene.h"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <numbers>

#include "formats/text.h"
#include "host/base/error.h"
#include "host/scene/files.h"
#include "host/scene/framing.h"
#include "host/scene/gltf.h"
#include "host/scene/gltf_document.h"
#include "host/scene/sample_model.h"
#include "host/scene/studio.h"
#include "host/scene/text.h"

namespace fs = std::filesystem;

namespace vitrine {
namespace {

constexpr uint64_t kLargestModel = 2ull << 30;
constexpr float kYfov = 34, kElevation = 18;  // degrees: a long lens, a little from above
constexpr float kLampElevation = 65;

// {0} model, {1..3} target, {4} radius, {5} height, {6} yfov, {7} lamp radius, {8} lamp elevation, {9} lamp size, {10} lamp
// strength, {11} what else the model offers.
constexpr const char* kTemplate = R"(# A Vitrine scene. Render a picture:  vitrine render .  --at view=0.5 -o picture.png
#                  Compile it all:    vitrine compile . -o scene.vit
# Lengths are metres, angles degrees, colours linear. Every setting stands here with its value; a # switches one off.

scene = {0}                      # the model (.glb or .gltf) beside this file
{11}
environment = "studio.exr"            # light from all around: a lat-long .exr or .hdr, or one radiance [r, g, b]
environment_rotation = 0              # degrees about the vertical axis
background = [0.6, 0.6, 0.6]          # what is seen behind the model; "environment" shows the light itself
resolution = [640, 480]               # of the rendered pictures, width and height
samples_per_pixel = 128               # camera rays of a pixel in the mean, at most: more lets longer nights get cleaner
noise = 45                            # what compiled pictures are traced to, in decibels; rays go where they are needed for it
max_radiance = 0                      # bound of one path's indirect light, against fireflies; 0: none
caustics = false                      # true: glass focuses the light that it lets through; noisy with small lamps
exposure = 1.0                        # factor between radiance and the screen
# camera = "NAME"                     # a camera of the model, by name; used where no axis orbits (without it: the first)

[[axis]]                              # the first dial: walk around the model
name = "view"                         # its name on the command line: --at view=0.5
orbit = {{ target = [{1:.4g}, {2:.4g}, {3:.4g}], radius = {4:.4g}, height = {5:.4g}, from = -55, to = 55, yfov = {6:.4g} }}
                                      # looks at target from this horizontal distance and this height above it;
                                      # 0 degrees is in front (+Z), 90 on the right (+X)
kind = "linear"                       # it has two ends; "periodic" joins them to a circle (then from = 0, to = 360)
samples = 32                          # pictures along it, both ends included
max_speed = 0.25                      # the fastest motion that must stay smooth, in samples per frame

[[axis]]                              # the second dial: a lamp that travels above the model
name = "lamp"
lamp = {{ target = [{1:.4g}, {2:.4g}, {3:.4g}], radius = {7:.4g}, elevation = {8:.4g}, from = -60, to = 60, size = {9:.4g}, color = [1.0, 0.86, 0.68], strength = {10:.4g} }}
kind = "linear"
samples = 4
max_speed = 0.05

# A further axis may play an animation, choose a material variant or switch lights (four axes at most):
#   animation = "NAME"    variants = ["red", "blue"]    lights = [["lamp 1"], ["lamp 1", "lamp 2"], []]

# An object's own settings; one entry per node:
# [[object]]
# node = "NAME"
# representation = "texture"
# resolution_scale = 1.0              # 2: twice as many texels in each direction
# weight = 1.0                        # 2: its errors count twice where storage is shared out

[target]                              # what the result plays on
profile = "kiosk-60"                  # a small machine at 60 frames a second; or the path of a profile file
storage = "100:1"                     # a ratio to all pictures as plain pixels; or "150 KB/block", or "12 MB" in all
codec = "dct"                         # how textures are coded: "dct" decodes fastest; "spiht" is embedded
worst_object = 4                      # no object's coding error may be more than so many times that of the whole picture
interpolate = false                   # true: blends the pictures around a position of the dials
between = false                       # true: traces twice as many pictures, and shows better what lies between two of them
smoothing = 0.01                      # how strongly neighbouring pictures' textures are drawn together where a picture tells little
)";

std::string toml_string(const std::string& text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

void require_new(const fs::path& directory) {
  std::error_code error;
  if (!fs::exists(directory, error)) return;
  if (!fs::is_directory(directory, error)) throw InputError(shown(directory), "this is a file", "name a new folder");
  if (!fs::is_empty(directory, error) || error)
    throw InputError(shown(directory), "the folder is not empty", "name a new folder");
}

fs::path companion(const JsonView& uri, const fs::path& folder) {
  try {
    return file_of_uri(uri.text(), folder, folder);
  } catch (const std::runtime_error& e) {
    uri.fail(in_quotes(uri.text()) + ' ' + e.what(), "keep companion files beside the model and name them relative to it");
  }
}

// The model and, for a .gltf, its companions, named relative to the model's folder.
std::map<fs::path, Bytes> files_of_model(const fs::path& model) {
  const fs::path folder = model.has_parent_path() ? model.parent_path() : fs::path(".");
  std::vector<std::string> warnings;
  const GltfDocument document(model, folder, nullptr, &warnings);
  std::map<fs::path, Bytes> files;
  files[model.filename()] = read_file(model, kLargestModel);
  for (const char* collection : {"buffers", "images"})
    for (size_t i = 0; i < document.count(collection); ++i) {
      const auto uri = document.element(collection, static_cast<int>(i)).find("uri");
      if (!uri || is_data_uri(uri->text())) continue;
      const fs::path file = companion(*uri, folder);
      if (fs::exists(file)) files[file.lexically_relative(folder)] = read_file(file, kLargestModel);
    }
  return files;
}

GltfModel read_model(const fs::path& model) {
  GltfRequest request;
  request.model = model;
  return read_gltf(request);
}

GltfModel read_sample(const Bytes& bytes) {
  GltfRequest request;
  request.model = "model.glb";
  request.bytes = &bytes;
  return read_gltf(request);
}

// Comment lines that name what the model offers to further axes.
std::string offers(const GltfModel& model) {
  std::string lines;
  const auto add = [&](const char* what, const std::vector<std::string>& names) {
    if (!names.empty()) lines += fmt::format("# It has {}: {}\n", what, joined(names));
  };
  std::vector<std::string> cameras;
  for (const GltfCamera& camera : model.cameras) cameras.push_back(camera.name.empty() ? "(no name)" : camera.name);
  add("animations", model.animation_names);
  add("material variants", model.variant_names);
  add("cameras (used where no axis orbits)", cameras);
  return lines;
}

Sphere bounds_of_model(const GltfModel& model) {
  Scene scene;
  scene.nodes = model.nodes;
  scene.objects = model.objects;
  return bounds_of(scene);
}

std::string scene_text(const std::string& model_name, const GltfModel& model) {
  const Sphere bounds = bounds_of_model(model);
  const float degree = std::numbers::pi_v<float> / 180;
  const float distance = fitting_distance(bounds.radius, kYfov * degree, 640.0f / 480, 0.1f);
  glm::vec3 c = bounds.center;
  for (int i = 0; i < 3; ++i) c[i] = std::abs(c[i]) < 1e-3f * bounds.radius ? 0.0f : c[i];
  return fmt::format(kTemplate, toml_string(model_name), c.x, c.y, c.z, distance * std::cos(kElevation * degree),
                     distance * std::sin(kElevation * degree), kYfov, 2.5f * bounds.radius, kLampElevation, 0.5f * bounds.radius,
                     60.0f, offers(model));
}

std::vector<fs::path> write_scene(const fs::path& directory, const std::map<fs::path, Bytes>& files, const std::string& text) {
  std::vector<fs::path> written;
  for (const auto& [file, bytes] : files) {
    std::error_code error;  // of a folder that cannot be made the file tells
    fs::create_directories((directory / file).parent_path(), error);
    write_file(directory / file, bytes.data(), bytes.size());
    written.push_back(directory / file);
  }
  write_studio(directory / "studio.exr");
  write_file(directory / "scene.toml", text.data(), text.size());
  written.push_back(directory / "studio.exr");
  written.push_back(directory / "scene.toml");
  return written;
}

// As it was before a scene could not be written whole: it was empty, or not there.
void clear(const fs::path& directory, bool was_there) {
  std::error_code error;
  if (!was_there) return void(fs::remove_all(directory, error));
  for (const auto& entry : fs::directory_iterator(directory, error)) fs::remove_all(entry.path(), error);
}

}  // namespace

std::vector<fs::path> new_scene(const fs::path& directory, const std::optional<fs::path>& model) {
  require_new(directory);
  const std::string name = model ? model->filename().string() : "model.glb";
  if (!is_plain_text(name)) throw InputError(shown(*model), "its name is not plain UTF-8 text", "rename it");
  const std::string sample = sample_model_glb();
  const Bytes sample_bytes(sample.begin(), sample.end());
  const GltfModel read = model ? read_model(*model) : read_sample(sample_bytes);
  if (read.objects.empty())
    throw InputError(shown(*model), "there is nothing to see in it", "give a model with triangles in its scene");
  const std::map<fs::path, Bytes> files = model ? files_of_model(*model) : std::map<fs::path, Bytes>{{name, sample_bytes}};
  const std::string text = scene_text(name, read);

  std::error_code error;
  const bool was_there = fs::exists(directory, error);
  fs::create_directories(directory, error);
  if (error) throw InputError(shown(directory), "the folder cannot be made", "check the permissions");
  try {
    return write_scene(directory, files, text);
  } catch (...) {
    clear(directory, was_there);
    throw;
  }
}

}  // namespace vitrine
