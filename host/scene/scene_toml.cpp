// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/scene/scene_toml.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "host/base/error.h"
#include "host/scene/files.h"
#include "host/scene/storage_text.h"
#include "host/scene/text.h"
#include "host/scene/toml_view.h"

namespace fs = std::filesystem;

namespace vitrine {
namespace {

constexpr uint64_t kLargestToml = 4 << 20;
constexpr double kFar = 1e9;
constexpr double kBright = 1e9;
constexpr double kManyTurns = 36000;  // degrees

bool is_model(const fs::path& file) { return file.extension() == ".glb" || file.extension() == ".gltf"; }

fs::path toml_file_of(const fs::path& scene) {
  std::error_code error;
  if (!fs::exists(scene, error)) throw InputError(shown(scene), "there is no such scene", "make one with: vitrine new DIR");
  if (!fs::is_directory(scene, error)) {
    if (is_model(scene))
      throw InputError(shown(scene), "this is a model, not a scene",
                       "make a scene of it with: vitrine new DIR --from " + shown(scene));
    return scene;
  }
  if (!fs::exists(scene / "scene.toml", error))
    throw InputError(shown(scene), "the folder holds no scene.toml", "make a scene with: vitrine new DIR");
  return scene / "scene.toml";
}

toml::table parse(const fs::path& file) {
  const Bytes bytes = read_file(file, kLargestToml);
  try {
    return toml::parse(std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  } catch (const toml::parse_error& e) {
    throw InputError(fmt::format("{}: line {}", shown(file), static_cast<uint32_t>(e.source().begin.line)),
                     printable(e.description(), 200), "correct this line");
  }
}

float radians(double degrees) { return static_cast<float>(degrees * std::numbers::pi / 180); }

OrbitDescription read_orbit(const TomlView& view) {
  view.allow({"target", "radius", "height", "from", "to", "yfov"});
  OrbitDescription orbit;
  orbit.target = view.vec3("target", orbit.target, -kFar, kFar);
  orbit.radius = static_cast<float>(view.number("radius", orbit.radius, 1e-6, kFar));
  orbit.height = static_cast<float>(view.number("height", orbit.height, -kFar, kFar));
  orbit.from = static_cast<float>(view.number("from", orbit.from, -kManyTurns, kManyTurns));
  orbit.to = static_cast<float>(view.number("to", orbit.to, -kManyTurns, kManyTurns));
  if (view.has("yfov")) orbit.yfov = static_cast<float>(view.number("yfov", 40, 0.1, 179));
  return orbit;
}

LampDescription read_lamp(const TomlView& view) {
  view.allow({"target", "radius", "elevation", "from", "to", "size", "color", "strength"});
  LampDescription lamp;
  lamp.target = view.vec3("target", lamp.target, -kFar, kFar);
  lamp.radius = static_cast<float>(view.number("radius", lamp.radius, 1e-6, kFar));
  lamp.elevation = static_cast<float>(view.number("elevation", lamp.elevation, -90, 90));
  lamp.from = static_cast<float>(view.number("from", lamp.from, -kManyTurns, kManyTurns));
  lamp.to = static_cast<float>(view.number("to", lamp.to, -kManyTurns, kManyTurns));
  lamp.size = static_cast<float>(view.number("size", lamp.size, 1e-6, kFar));
  lamp.color = view.vec3("color", lamp.color, 0, kBright);
  lamp.strength = static_cast<float>(view.number("strength", lamp.strength, 0, kBright));
  return lamp;
}

AxisKind read_kind(const TomlView& view, AxisKind otherwise) {
  if (!view.has("kind")) return otherwise;
  const std::string kind = view.text("kind", "");
  if (kind == "linear") return AxisKind::kLinear;
  if (kind == "periodic") return AxisKind::kPeriodic;
  if (kind == "discrete") return AxisKind::kDiscrete;
  view.fail("there is no kind " + in_quotes(kind), "write \"linear\", \"periodic\" or \"discrete\"");
}

// Axis names stand in --at NAME=0.5 and in the header of scripts.
void check_name(const TomlView& view, const std::string& name) {
  const bool good =
      !name.empty() && name.size() <= 64 && name != "frame" &&
      std::all_of(name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) || c == '_' || c == '-'; });
  if (!good) view.fail("the name " + in_quotes(name) + " cannot be used", "use letters, digits, - and _, and not \"frame\"");
}

// What the axis drives; the number of values where that is a switch, else 0.
int read_drive(const TomlView& view, AxisDescription& axis) {
  static const std::vector<std::string> kDrives = {"animation", "orbit", "variants", "lights", "lamp"};
  const auto count = std::count_if(kDrives.begin(), kDrives.end(), [&](const std::string& key) { return view.has(key.c_str()); });
  if (count != 1)
    view.fail(count == 0 ? "the axis drives nothing" : "the axis drives two things", "give it exactly one of " + joined(kDrives));
  axis.animation = view.text("animation", "");
  if (view.has("animation") && axis.animation.empty()) view.fail("\"animation\" is empty", "name an animation of the model");
  if (const auto orbit = view.table("orbit")) axis.orbit = read_orbit(*orbit);
  if (const auto lamp = view.table("lamp")) axis.lamp = read_lamp(*lamp);
  if (view.has("variants")) {
    axis.variants = view.texts("variants");
    return static_cast<int>(axis.variants.size());
  }
  if (!view.has("lights")) return 0;
  axis.lights = view.text_lists("lights");
  return static_cast<int>(axis.lights->size());
}

AxisDescription read_axis(const TomlView& numbered) {
  numbered.allow({"name", "kind", "samples", "max_speed", "names", "animation", "orbit", "variants", "lights", "lamp"});
  AxisDescription axis;
  axis.name = numbered.text("name", "");
  if (!numbered.has("name")) numbered.fail("the axis has no name", "write name = \"view\"");
  check_name(numbered, axis.name);
  axis.place = numbered.place() + " (" + in_quotes(axis.name) + ")";
  const TomlView& view = numbered;
  const int values = read_drive(view, axis);
  const bool is_switch = axis.lights || view.has("variants");
  if (is_switch && (values < 1 || values > kMostValues))
    view.fail(fmt::format("a switch of {} values", values), fmt::format("give it 1 to {} values", kMostValues));
  axis.kind = read_kind(view, is_switch ? AxisKind::kDiscrete : AxisKind::kLinear);
  if (is_switch && axis.kind != AxisKind::kDiscrete)
    view.fail("a switch has nothing between its values", "write kind = \"discrete\", or leave it out");
  if (!is_switch && !view.has("samples")) view.fail("the axis has no \"samples\"", "write samples = 32");
  axis.samples = view.integer("samples", values, 1, kMostSamples);
  if (is_switch && axis.samples != values)
    view.fail(fmt::format("{} samples for {} values", axis.samples, values), "leave \"samples\" out");
  axis.max_speed = static_cast<float>(view.number("max_speed", axis.max_speed, 1e-6, 1e6));
  axis.names = view.texts("names");
  if (!axis.names.empty() && (axis.kind != AxisKind::kDiscrete || axis.names.size() != static_cast<size_t>(axis.samples)))
    view.fail("\"names\" does not fit", "give a discrete axis one name per value, others none");
  return axis;
}

ObjectDescription read_object(const TomlView& view) {
  view.allow({"node", "representation", "resolution_scale", "weight"});
  if (!view.has("node")) view.fail("the entry names no node", "write node = \"NAME\"");
  ObjectDescription object;
  object.place = view.place();
  object.node = view.text("node", "");
  object.representation = view.text("representation", object.representation);
  if (object.representation != "texture")
    view.fail("the representation " + in_quotes(object.representation) + " does not exist in this version",
              "write \"texture\", the only one");
  object.resolution_scale = static_cast<float>(view.number("resolution_scale", 1, 1.0 / 64, 64));
  object.weight = static_cast<float>(view.number("weight", 1, 1e-3, 1e3));
  return object;
}

void check_storage(const TomlView& view, const std::string& storage) {
  if (!parse_storage(storage))
    view.fail("\"storage\" is " + in_quotes(storage),
              "write a size per block (\"150 KB/block\"), a ratio (\"384:1\") or a size in all (\"12 MB\")");
}

NodeCoder read_codec(const TomlView& view) {
  const std::string name = view.text("codec", "dct");
  if (name != "dct" && name != "spiht")
    view.fail("\"codec\" is " + in_quotes(name), "write \"dct\" (decodes fastest) or \"spiht\" (may be cut off anywhere)");
  return name == "spiht" ? NodeCoder::kSpiht : NodeCoder::kDct;
}

void read_target(const TomlView& view, const fs::path& folder, Settings& settings) {
  view.allow({"profile", "storage", "codec", "interpolate", "between", "smoothing", "exposure", "worst_object"});
  settings.profile = view.text("profile", settings.profile);
  std::error_code error;
  if (fs::is_regular_file(folder / settings.profile, error)) settings.profile = (folder / settings.profile).string();
  settings.storage = view.text("storage", settings.storage);
  check_storage(view, settings.storage);
  settings.codec = read_codec(view);
  settings.interpolate = view.boolean("interpolate", settings.interpolate);
  settings.between = view.boolean("between", settings.between);
  settings.worst_object = static_cast<float>(view.number("worst_object", settings.worst_object, 1, 1e6));
  settings.smoothing = static_cast<float>(view.number("smoothing", settings.smoothing, 0, 1e3));
  settings.exposure = static_cast<float>(view.number("exposure", settings.exposure, 1e-6, 1e6));
}

void read_environment(const TomlView& view, SceneDescription& scene) {
  if (view.is_text("environment"))
    scene.environment_file = scene.folder / view.text("environment", "");
  else if (view.has("environment"))
    scene.environment_color = view.vec3("environment", {}, 0, kBright);
  scene.environment_rotation = radians(view.number("environment_rotation", 0, -kManyTurns, kManyTurns));
  if (!view.is_text("background")) {
    if (view.has("background")) scene.background_color = view.vec3("background", {}, 0, kBright);
    return;
  }
  if (view.text("background", "") != "environment")
    view.fail("\"background\" is " + in_quotes(view.text("background", "")), "write \"environment\" or [r, g, b]");
  if (!view.has("environment"))
    view.fail("\"background\" shows an environment, but there is none", "give one, or a colour [r, g, b]");
}

void check_grid(const TomlView& view, const SceneDescription& scene) {
  if (scene.axes.size() > static_cast<size_t>(kMaxAxes))
    view.fail(fmt::format("there are {} axes", scene.axes.size()), fmt::format("leave {} at most", kMaxAxes));
  int64_t grid = 1;
  for (size_t a = 0; a < scene.axes.size(); ++a) {
    grid *= scene.axes[a].samples;
    for (size_t b = 0; b < a; ++b)
      if (scene.axes[a].name == scene.axes[b].name)
        view.fail("two axes are named " + in_quotes(scene.axes[a].name), "rename one");
  }
  if (grid > kMostGridSamples)
    view.fail(fmt::format("the grid has {} samples", grid),
              fmt::format("reduce samples until their product is {} at most", kMostGridSamples));
}

void check_objects(const TomlView& view, const SceneDescription& scene) {
  std::set<std::string> nodes;
  for (const ObjectDescription& object : scene.objects)
    if (!nodes.insert(object.node).second)
      view.fail("two [[object]] entries are for node " + in_quotes(object.node), "make them one");
}

}  // namespace

SceneDescription read_scene_description(const fs::path& path) {
  SceneDescription scene;
  scene.file = toml_file_of(path);
  scene.folder = scene.file.has_parent_path() ? scene.file.parent_path() : fs::path(".");
  const toml::table table = parse(scene.file);
  const TomlView view(table, shown(scene.file));
  view.allow({"scene", "environment", "environment_rotation", "background", "resolution", "samples_per_pixel", "noise",
              "max_radiance", "caustics", "camera", "exposure", "axis", "object", "target"});
  if (!view.has("scene")) view.fail("it does not name the model", "write scene = \"model.glb\"");
  scene.model = scene.folder / view.text("scene", "");
  read_environment(view, scene);
  scene.camera = view.text("camera", "");
  Settings& settings = scene.settings;
  if (view.has("resolution")) {
    const std::vector<double> size = view.numbers("resolution", 2, 1, 8192);
    settings.width = static_cast<int>(size[0]);
    settings.height = static_cast<int>(size[1]);
    if (settings.width != size[0] || settings.height != size[1])
      view.fail("\"resolution\" is not whole", "write resolution = [640, 480]");
  }
  settings.samples_per_pixel = view.integer("samples_per_pixel", settings.samples_per_pixel, 1, 1 << 20);
  settings.noise_db = static_cast<float>(view.number("noise", static_cast<double>(settings.noise_db), 10, 80));
  settings.max_radiance = static_cast<float>(view.number("max_radiance", settings.max_radiance, 0, kBright));
  settings.caustics = view.boolean("caustics", settings.caustics);
  settings.exposure = static_cast<float>(view.number("exposure", settings.exposure, 1e-6, 1e6));
  view.for_each_table("axis", [&](const TomlView& axis) { scene.axes.push_back(read_axis(axis)); });
  view.for_each_table("object", [&](const TomlView& object) { scene.objects.push_back(read_object(object)); });
  if (const auto target = view.table("target")) {
    if (view.has("exposure") && target->has("exposure")) view.fail("\"exposure\" stands twice", "remove one");
    read_target(*target, scene.folder, settings);
  }
  check_grid(view, scene);
  check_objects(view, scene);
  return scene;
}

}  // namespace vitrine
