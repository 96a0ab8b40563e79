// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// What the keys of frames are made of: each field of the scene that host/trace reads. Poses go into frame_key.
#include <glm/gtc/type_ptr.hpp>

#include "host/frames/store.h"
#include "host/scene/deformation.h"

namespace vitrine {
namespace {

template <typename T>
void append_array(KeyBuilder& key, const std::vector<T>& values) {
  key.bytes(values.data(), values.size() * sizeof(T));
}

void append(KeyBuilder& key, const glm::vec3& v) {
  for (int i = 0; i < 3; ++i) key.number(v[i]);
}

void append(KeyBuilder& key, const glm::mat4& m) {
  for (int i = 0; i < 16; ++i) key.number(glm::value_ptr(m)[i]);
}

void append(KeyBuilder& key, const TextureRef& t) {
  key.integer(t.image);
  if (!t) return;
  key.integer(t.texcoord);
  key.integer(static_cast<int>(t.wrap_s));
  key.integer(static_cast<int>(t.wrap_t));
  key.integer(t.nearest);
  for (int i = 0; i < 9; ++i) key.number(glm::value_ptr(t.transform)[i]);
}

void append_surface(KeyBuilder& key, const Material& m) {
  for (int i = 0; i < 4; ++i) key.number(m.base_color[i]);
  append(key, m.base_color_texture);
  key.number(m.metallic);
  key.number(m.roughness);
  append(key, m.metallic_roughness_texture);
  append(key, m.normal_texture);
  key.number(m.normal_scale);
  append(key, m.emissive);
  append(key, m.emissive_texture);
  key.integer(static_cast<int>(m.alpha_mode));
  key.number(m.alpha_cutoff);
  key.integer(m.double_sided);
  key.integer(m.unlit);
}

void append_extensions(KeyBuilder& key, const Material& m) {
  key.number(m.ior);
  key.number(m.specular);
  append(key, m.specular_texture);
  append(key, m.specular_color);
  append(key, m.specular_color_texture);
  key.number(m.transmission);
  append(key, m.transmission_texture);
  key.number(m.thickness);
  append(key, m.thickness_texture);
  append(key, m.attenuation_color);
  key.number(m.attenuation_distance);
  key.number(m.clearcoat);
  append(key, m.clearcoat_texture);
  key.number(m.clearcoat_roughness);
  append(key, m.clearcoat_roughness_texture);
  append(key, m.clearcoat_normal_texture);
  key.number(m.clearcoat_normal_scale);
}

void append_geometry(KeyBuilder& key, const Geometry& g) {
  append_array(key, g.positions);
  append_array(key, g.normals);
  append_array(key, g.tangents);
  for (const auto& texcoords : g.texcoords) append_array(key, texcoords);
  append_array(key, g.colors);
  append_array(key, g.indices);
}

// What the mesh of an object that an axis deforms is made from; at which pose, frame_key says.
void append_deformation(KeyBuilder& key, const Deformation& d) {
  key.integer(static_cast<int64_t>(d.primitives.size()));
  for (const MeshPrimitive& p : d.primitives) {
    key.integer(static_cast<int>(p.parts));
    append_geometry(key, p.vertices);
    key.integer(static_cast<int64_t>(p.targets.size()));
    for (const MorphTarget& target : p.targets) {
      append_array(key, target.positions);
      append_array(key, target.normals);
      append_array(key, target.tangents);
    }
    key.integer(static_cast<int64_t>(p.influences_per_vertex));
    append_array(key, p.influences);
    append_array(key, p.materials);
    key.integer(p.tangent_texcoord);
    for (int i = 0; i < 9; ++i) key.number(glm::value_ptr(p.tangent_transform)[i]);
  }
}

void append_object(KeyBuilder& key, const Object& o) {
  key.integer(o.follows_camera);
  if (!o.follows_camera) append_geometry(key, o.geometry);  // the dome is only looked up by direction
  append_array(key, o.geometry.triangle_materials);
  key.integer(static_cast<int64_t>(o.variant_materials.size()));
  for (const auto& row : o.variant_materials) append_array(key, row);
  if (o.deformation) append_deformation(key, *o.deformation);
}

// What a pose makes of an object that an axis deforms.
void append_deformed_pose(KeyBuilder& key, const Scene& scene, const Pose& pose, size_t object) {
  const MeshPose at = mesh_pose(scene, pose, static_cast<int>(object));
  append_array(key, at.weights);
  for (const glm::mat4& joint : at.world_from_bind) append(key, joint);
}

void append_light(KeyBuilder& key, const Light& l) {
  key.integer(static_cast<int>(l.kind));
  append(key, l.intensity);
  key.number(l.range);
  if (l.kind != LightKind::kSpot) return;
  key.number(l.inner_cone);
  key.number(l.outer_cone);
}

void append_camera(KeyBuilder& key, const Camera& c) {
  key.integer(c.perspective);
  key.number(c.perspective ? c.yfov : c.ymag);
  key.number(c.near_distance);
}

}  // namespace

StoreKey scene_key(const Scene& scene) {
  KeyBuilder key;
  for (const Image& image : scene.images) {
    key.integer(image.width);
    key.integer(image.height);
    append_array(key, image.rgba);
  }
  for (const Material& m : scene.materials) {
    append_surface(key, m);
    append_extensions(key, m);
  }
  key.text("objects");
  for (const Object& o : scene.objects) append_object(key, o);
  key.text("lights");
  for (const Light& l : scene.lights) append_light(key, l);
  key.text("environment");
  key.integer(scene.environment.width);
  key.integer(scene.environment.height);
  append_array(key, scene.environment.radiance);
  key.number(scene.environment.rotation);
  key.integer(scene.background_is_environment);
  append(key, scene.background_is_environment ? glm::vec3(0) : scene.background_color);
  append_camera(key, scene.camera);
  key.number(scene.settings.max_radiance);
  key.integer(scene.settings.caustics);
  return key.finish();
}

StoreKey frame_key(const StoreKey& scene_key, const Scene& scene, const Position& position, const TraceOptions& options) {
  const Pose pose = pose_scene(scene, position);
  KeyBuilder key;
  key.integer(kTracerVersion);
  key.integer(static_cast<int64_t>(scene_key.high));
  key.integer(static_cast<int64_t>(scene_key.low));
  key.integer(options.width);
  key.integer(options.height);
  key.integer(options.samples_per_pixel);
  key.integer(options.seed);
  key.integer(options.layers);
  key.number(options.noise_db);
  key.integer(options.views);
  append(key, pose.world_from_camera);
  key.integer(pose.variant);
  for (size_t i = 0; i < scene.objects.size(); ++i) {
    if (scene.objects[i].follows_camera) continue;
    append(key, world_from_object(scene, pose, static_cast<int>(i)));
    key.number(pose.object_emission[i]);
    if (scene.objects[i].deformation) append_deformed_pose(key, scene, pose, i);
  }
  for (size_t i = 0; i < scene.lights.size(); ++i) {
    append(key, pose.world_from_node[static_cast<size_t>(scene.lights[i].node)]);
    key.number(pose.light_emission[i]);
  }
  return key.finish();
}

}  // namespace vitrine
