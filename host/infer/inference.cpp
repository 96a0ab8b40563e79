// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/infer/inference.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#include "host/infer/geometry_states.h"
#include "host/infer/inference_run.h"
#include "host/infer/light_survey.h"
#include "host/infer/parameterization.h"
#include "host/infer/texture_size.h"

namespace vitrine {
namespace {

std::vector<DrawnObject> draw_objects(const Scene& scene) {
  const Pose pose = pose_scene(scene, scene.space().position_of({}));
  std::vector<DrawnObject> objects(scene.objects.size());
  tbb::parallel_for(size_t{0}, objects.size(), [&](size_t i) {
    objects[i] = make_drawn_object(scene, static_cast<int>(i), world_from_object(scene, pose, static_cast<int>(i)));
  });
  return objects;
}

// Without what is outside the picture in all states, like a lamp above it.
std::vector<DrawnObject> objects_in_picture(std::vector<DrawnObject> all, const std::vector<GeometryState>& states) {
  std::vector<DrawnObject> inside;
  for (size_t i = 0; i < all.size(); ++i)
    if (may_be_seen(all[i], i, states)) inside.push_back(std::move(all[i]));
  return inside;
}

bool is_constant_backdrop(const Object& object, const ObjectLight& light) {
  return object.follows_camera && is_constant(light[0]) && !carries_light(light[1]);
}

// Objects that some state shows, with their texture sizes.
std::vector<DrawnObject> fit_objects(const Scene& scene, std::vector<DrawnObject> all, const std::vector<ObjectSurvey>& surveys,
                                     const std::vector<ObjectLight>& lights, const InferenceOptions& options) {
  std::vector<DrawnObject> fitted;
  for (size_t i = 0; i < all.size(); ++i) {
    if (!surveys[i].visible()) continue;
    const Object& object = scene.objects[static_cast<size_t>(all[i].object)];
    const int limit = is_constant_backdrop(object, lights[static_cast<size_t>(all[i].object)]) ? 8 : options.max_texture_size;
    fit_texture(all[i], surveys[i], options.texels_per_pixel * object.resolution_scale, limit);
    fitted.push_back(std::move(all[i]));
  }
  return fitted;
}

std::vector<Field> make_fields(const Scene& scene, const std::vector<DrawnObject>& objects,
                               const std::vector<ObjectLight>& lights) {
  std::vector<Field> fields;
  for (size_t i = 0; i < objects.size(); ++i)
    for (const Layer layer : kLayers) {
      const auto object = static_cast<size_t>(objects[i].object);
      if (!carries_light(lights[object][static_cast<size_t>(layer)])) continue;
      const AxisMask axes = field_axes(scene, scene.objects[object], layer);
      fields.push_back({static_cast<int>(i), layer_name(layer), axes, scene.space().restricted(axes), {}, {}});
    }
  return fields;
}

// Shown, and black in every picture: most often a closed room without a lamp, or a lamp that does not reach.
std::vector<std::string> warn_of_darkness(const Scene& scene, const std::vector<DrawnObject>& objects, const std::vector<Field>& fields) {
  std::vector<std::string> warnings;
  for (size_t i = 0; i < objects.size(); ++i)
    if (std::none_of(fields.begin(), fields.end(), [&](const Field& f) { return f.drawn_object == static_cast<int>(i); }))
      warnings.push_back(fmt::format("\"{}\" is black in all pictures: no light reaches it; add a lamp where it does, or open the room to the environment",
                                     scene.objects[static_cast<size_t>(objects[i].object)].name));
  return warnings;
}

}  // namespace

Inference infer_textures(const Scene& scene, const std::vector<StoreKey>& frames, const Store& store, hal::Gpu& gpu,
                         const InferenceOptions& options, Progress& progress) {
  const std::vector<ObjectLight> lights = survey_light(scene, frames, store);
  const float aspect = static_cast<float>(options.width) / static_cast<float>(options.height);
  const auto states_of = [&](const std::vector<DrawnObject>& objects) {
    return make_geometry_states(scene, geometry_axes(scene), objects, aspect);
  };
  Inference inference;
  std::vector<DrawnObject> all = draw_objects(scene);
  const GeometryStates all_states = states_of(all);
  inference.objects = objects_in_picture(std::move(all), all_states.states);
  std::vector<ObjectSurvey> surveys;
  {
    TestRenderer renderer(gpu, options, inference.objects);
    surveys = survey_objects(renderer, inference.objects.size(), options.supersampling, states_of(inference.objects).states);
  }
  inference.objects = fit_objects(scene, std::move(inference.objects), surveys, lights, options);
  inference.fields = make_fields(scene, inference.objects, lights);
  inference.warnings = warn_of_darkness(scene, inference.objects, inference.fields);
  GeometryStates geometry = states_of(inference.objects);
  InferenceRun run(scene, frames, store, gpu, options, geometry.table, std::move(geometry.states), inference);
  run.solve_missing(progress);
  return inference;
}

}  // namespace vitrine
