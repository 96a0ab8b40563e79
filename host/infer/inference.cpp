// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/infer/inference.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#include "host/base/field_blocks.h"
#include "host/infer/geometry_states.h"
#include "host/infer/inference_run.h"
#include "host/infer/light_survey.h"
#include "host/infer/mesh_cuts.h"
#include "host/infer/parameterization.h"
#include "host/infer/texture_layout.h"
#include "host/infer/texture_store.h"

namespace vitrine {
namespace {

constexpr double kPatchesPay = 0.9;  // of the texels without them, at most: content that ends at a gutter costs bits, too

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

// Objects that some state shows.
std::vector<DrawnObject> visible_objects(std::vector<DrawnObject> all, std::vector<std::vector<VisibleSurface>>& surfaces) {
  std::vector<DrawnObject> visible;
  std::vector<std::vector<VisibleSurface>> theirs(surfaces.size());
  for (size_t i = 0; i < all.size(); ++i) {
    if (std::none_of(surfaces.begin(), surfaces.end(), [&](const auto& state) { return state[i].visible(); })) continue;
    visible.push_back(std::move(all[i]));
    for (size_t s = 0; s < surfaces.size(); ++s) theirs[s].push_back(std::move(surfaces[s][i]));
  }
  surfaces = std::move(theirs);
  return visible;
}

// Surfaces of the states of `from` for those of `to`: without the objects that are not seen, fewer states differ.
std::vector<std::vector<VisibleSurface>> in_order_of(const StateTable& to, const StateTable& from,
                                                     std::vector<std::vector<VisibleSurface>> surfaces) {
  std::vector<std::vector<VisibleSurface>> result;
  for (const auto& samples : to.samples_of_state)
    result.push_back(std::move(surfaces[static_cast<size_t>(from.state_of_sample[static_cast<size_t>(samples.front())])]));
  return result;
}

std::vector<Field> make_fields(const Scene& scene, const std::vector<DrawnObject>& objects,
                               const std::vector<ObjectLight>& lights) {
  std::vector<Field> fields;
  for (size_t i = 0; i < objects.size(); ++i)
    for (const Layer layer : kLayers) {
      const auto object = static_cast<size_t>(objects[i].object);
      if (!carries_light(lights[object][static_cast<size_t>(layer)])) continue;
      Field field;
      field.drawn_object = static_cast<int>(i);
      field.layer = layer_name(layer);
      field.axes = field_axes(scene, scene.objects[object], layer);
      field.space = scene.space().restricted(field.axes);
      fields.push_back(std::move(field));
    }
  for (size_t f = 0; f < fields.size(); ++f) {
    fields[f].block_size = block_size_of(fields[f].space);
    fields[f].stagger = stagger_of(static_cast<int>(f), static_cast<int>(fields.size()), fields[f].space, fields[f].block_size);
  }
  return fields;
}

LayoutOptions layout_options(const Scene& scene, const std::vector<ObjectLight>& lights, const InferenceOptions& options,
                             int number) {
  const Object& object = scene.objects[static_cast<size_t>(number)];
  LayoutOptions layout{options.fit, options.max_texture_size, options.layout, scene.settings.interpolate};
  layout.fit.texels_per_pixel *= object.resolution_scale;
  if (is_constant_backdrop(object, lights[static_cast<size_t>(number)])) layout.max_size = 8;
  return layout;
}

double texels_of(std::span<Field* const> fields) {
  double texels = 0;
  for (const Field* field : fields) texels += static_cast<double>(field->texture_width) * field->texture_height;
  return texels;
}

// Lays an object's textures on patches, along which it cuts it, where that saves texels, else on the whole domain.
void lay_out_object(const Scene& scene, const StateTable& states, std::span<const VisibleSurface* const> surfaces,
                    const LayoutOptions& options, DrawnObject& object, std::span<Field* const> fields) {
  const auto lay_out_on = [&](std::span<const DomainPart> patches) {
    for (Field* field : fields) lay_out(states, scene.space(), surfaces, patches, options, *field);
    return texels_of(fields);
  };
  const double whole = lay_out_on({&VisibleSurface::kWholeDomain, 1});
  if (options.layout != TextureLayout::kFitted || fields.empty()) return;
  const std::vector<DomainPart> patches =
      patches_for(states, scene.space(), surfaces, options, std::vector<const Field*>(fields.begin(), fields.end()));
  if (patches.size() == 1) return;
  if (lay_out_on(patches) < kPatchesPay * whole)
    object = cut_into_patches(object, patches);
  else
    lay_out_on({&VisibleSurface::kWholeDomain, 1});
}

void lay_out_objects(const Scene& scene, const std::vector<ObjectLight>& lights, const InferenceOptions& options,
                     const StateTable& states, const std::vector<std::vector<VisibleSurface>>& surfaces, Inference& inference) {
  for (size_t i = 0; i < inference.objects.size(); ++i) {
    DrawnObject& object = inference.objects[i];
    std::vector<const VisibleSurface*> own;
    for (const auto& state : surfaces) own.push_back(&state[i]);
    std::vector<Field*> fields;
    for (Field& field : inference.fields)
      if (field.drawn_object == static_cast<int>(i)) fields.push_back(&field);
    lay_out_object(scene, states, own, layout_options(scene, lights, options, object.object), object, fields);
  }
}

// Shown, and black in every picture: most often a closed room without a lamp, or a lamp that does not reach.
std::vector<std::string> warn_of_darkness(const Scene& scene, const std::vector<DrawnObject>& objects,
                                          const std::vector<Field>& fields) {
  std::vector<std::string> warnings;
  for (size_t i = 0; i < objects.size(); ++i)
    if (std::none_of(fields.begin(), fields.end(), [&](const Field& f) { return f.drawn_object == static_cast<int>(i); }))
      warnings.push_back(fmt::format(
          "\"{}\" is black in all pictures: no light reaches it; add a lamp where it does, or open the room to the environment",
          scene.objects[static_cast<size_t>(objects[i].object)].name));
  return warnings;
}

}  // namespace

Inference infer_textures(const Scene& scene, const std::vector<StoreKey>& frames, const Store& store, hal::Gpu& gpu,
                         const InferenceOptions& options, Progress& progress) {
  const std::vector<ObjectLight> lights = survey_light(scene, frames, store);
  std::vector<BetweenSample> between;
  if (static_cast<int64_t>(frames.size()) > scene.space().sample_count()) between = between_samples(scene);
  const float aspect = static_cast<float>(options.width) / static_cast<float>(options.height);
  const auto states_of = [&](const std::vector<DrawnObject>& objects) {
    return make_geometry_states(scene, geometry_axes(scene), objects, aspect, between);
  };
  Inference inference;
  std::vector<DrawnObject> all = draw_objects(scene);
  const GeometryStates all_states = states_of(all);
  inference.objects = objects_in_picture(std::move(all), all_states.states);
  const GeometryStates in_picture = states_of(inference.objects);
  auto surfaces = survey_surfaces(gpu, options, inference.objects, in_picture.states);
  inference.objects = visible_objects(std::move(inference.objects), surfaces);
  GeometryStates geometry = states_of(inference.objects);
  surfaces = in_order_of(geometry.table, in_picture.table, std::move(surfaces));
  inference.fields = make_fields(scene, inference.objects, lights);
  inference.warnings = warn_of_darkness(scene, inference.objects, inference.fields);
  lay_out_objects(scene, lights, options, geometry.table, surfaces, inference);
  InferenceRun run(scene, frames, store, gpu, options, geometry.table, std::move(geometry.states), inference);
  run.solve_missing(progress);
  if (options.axis_smoothing > 0) smooth_fields(store, options.axis_smoothing, inference, progress);
  return inference;
}

}  // namespace vitrine
