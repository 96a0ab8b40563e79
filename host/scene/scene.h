// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The scene: everything that glTF and scene.toml say, read once, checked in full, immutable. Units: metres, radians,
// radiance linear Rec. 709. Axis order is that of scene.toml.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <memory>
#include <string>
#include <vector>

#include "formats/node_coder.h"
#include "formats/parameter_space.h"
#include "formats/rig.h"

namespace vitrine {

// 8-bit pictures as glTF carries them; 16-bit PNGs are reduced. Row 0 is the top, as in glTF (v = 0).
struct Image {
  std::string name;
  int width = 0, height = 0;
  std::vector<uint8_t> rgba;  // [y][x][4]
};

enum class Wrap : uint8_t { kRepeat, kMirror, kClamp };

struct TextureRef {
  int image = -1;    // -1: none, the factor alone counts
  int texcoord = 0;  // set 0 or 1
  Wrap wrap_s = Wrap::kRepeat, wrap_t = Wrap::kRepeat;
  bool nearest = false;    // magnification filter
  glm::mat3 transform{1};  // KHR_texture_transform, on (u, v, 1)
  explicit operator bool() const { return image >= 0; }
};

enum class AlphaMode : uint8_t { kOpaque, kMask, kBlend };

// glTF 2.0 metallic-roughness with the extensions of design.md. Colours linear. Every texture multiplies its factor.
struct Material {
  std::string name;
  glm::vec4 base_color{1};
  TextureRef base_color_texture;  // sRGB + alpha
  float metallic = 1, roughness = 1;
  TextureRef metallic_roughness_texture;  // B metallic, G roughness
  TextureRef normal_texture;
  float normal_scale = 1;
  glm::vec3 emissive{0};        // radiance: factor times emissive_strength
  TextureRef emissive_texture;  // sRGB
  AlphaMode alpha_mode = AlphaMode::kOpaque;
  float alpha_cutoff = 0.5f;
  bool double_sided = false;
  bool unlit = false;           // radiance is base colour, seen directly; black to light transport otherwise
  float ior = 1.5f;             // 0 means infinite (glTF: specular workflow)
  float specular = 1;           // KHR_materials_specular
  TextureRef specular_texture;  // A
  glm::vec3 specular_color{1};
  TextureRef specular_color_texture;  // sRGB
  float transmission = 0;
  TextureRef transmission_texture;  // R
  float thickness = 0;              // 0: thin-walled
  TextureRef thickness_texture;     // G
  glm::vec3 attenuation_color{1};
  float attenuation_distance = 0;  // metres; 0 means infinite
  float clearcoat = 0;
  TextureRef clearcoat_texture;  // R
  float clearcoat_roughness = 0;
  TextureRef clearcoat_roughness_texture;  // G
  TextureRef clearcoat_normal_texture;
  float clearcoat_normal_scale = 1;
};

// Triangles of one object in its node's space. Arrays are per vertex; absent attributes are empty but for normals, which
// are always there (flat where the file has none).
struct Geometry {
  std::vector<glm::vec3> positions, normals;
  std::vector<glm::vec4> tangents;  // w: handedness; filled wherever a normal texture needs it
  std::array<std::vector<glm::vec2>, 2> texcoords;
  std::vector<glm::vec4> colors;
  std::vector<uint32_t> indices;        // 3 per triangle
  std::vector<int> triangle_materials;  // index into Scene::materials, one per triangle
};

struct Deformation;  // deformation.h

// One segment of the picture: a glTF node with a mesh (all its primitives together).
struct Object {
  std::string name;                                // unique; node name, or mesh name, or "object-N"
  int node = 0;                                    // rig node
  Geometry geometry;                               // with skin and morph targets in their rest state
  std::shared_ptr<const Deformation> deformation;  // of an object that an axis deforms; null: it is rigid
  std::string representation = "texture";
  float resolution_scale = 1;
  float weight = 1;  // of its errors where storage is shared out
  bool follows_camera = false;  // the backdrop: a dome that carries the environment, made by the loader
  // Material variants: for each value of the axis below, a replacement of triangle_materials; empty where it has none.
  std::vector<std::vector<int>> variant_materials;
  // Emission is multiplied by this: 0 or 1 per value of `emission_axis` (-1: always 1).
  int emission_axis = -1;
  std::vector<float> emission_of_value;
};

enum class LightKind : uint8_t { kDirectional, kPoint, kSpot };

// KHR_lights_punctual. Intensity: candela (point, spot) or lux (directional), taken as radiometric units at 1:1; shines
// along the node's -Z.
struct Light {
  std::string name;
  int node = 0;
  LightKind kind = LightKind::kPoint;
  glm::vec3 intensity{1};
  float range = 0;  // metres; 0 is infinite
  float inner_cone = 0, outer_cone = 0.785398f;
  int emission_axis = -1;
  std::vector<float> emission_of_value;
};

struct Environment {
  // Lat-long radiance, row 0 up, in OpenEXR's convention (centre column +Z, +X to its left, +Y up). A constant is 1 x 1.
  int width = 0, height = 0;  // 0: no environment, black
  std::vector<glm::vec3> radiance;
  float rotation = 0;  // radians about +Y
  // Radiance from direction d (unit, from the scene outwards), bilinear.
  glm::vec3 lookup(const glm::vec3& direction) const;
};

struct Axis {
  std::string name;
  AxisShape shape;
  float max_speed = 0.25f;               // grid samples per frame
  std::vector<std::string> value_names;  // discrete axes: names of the values, for reports
};

// Weights of an object's morph targets that an axis drives. Host-only, and therefore no track of the rig.
struct WeightTrack {
  int object = 0, axis = 0;
  Interpolation interpolation = Interpolation::kLinear;
  std::vector<float> positions;  // as RigTrack::positions
  std::vector<float> values;     // as RigTrack::values, with one float per morph target
};

struct Settings {
  int width = 640, height = 480;
  int samples_per_pixel = 64;
  float noise_db = 45;       // what compiled frames are traced to (TraceOptions::noise_db)
  bool interpolate = false;  // [target] interpolate: blend neighbouring samples
  bool between = false;      // [target] between: textures are also solved for what they show half-way to the next sample
  float worst_object = 4;    // [target] worst_object: bound of an object's coding error, over that of all (host/encode/encode.h)
  float smoothing = 0.01f;   // [target] smoothing: of neighbouring samples' textures (host/infer/axis_smoothing.h)
  float exposure = 1;
  std::string profile = "kiosk-60";
  std::string storage = "100:1";  // "150 KB/block", "384:1" or "12 MB"
  NodeCoder codec = NodeCoder::kDct;  // [target] codec: of the textures
  float max_radiance = 0;         // firefly clamp of one path's indirect contribution; 0: none
  bool caustics = false;          // light is refracted on its way to what it lights, instead of going straight through glass
};

struct Scene {
  std::string name;            // folder or file name without extension, for reports
  std::filesystem::path file;  // scene.toml (or the .toml given)
  std::vector<RigNode> nodes;
  std::vector<RigTrack> tracks;  // spans into track_data
  std::vector<std::vector<float>> track_data;
  std::vector<WeightTrack> weight_tracks;  // one per object at most
  std::vector<Image> images;
  std::vector<Material> materials;
  std::vector<Object> objects;
  std::vector<Light> lights;
  Environment environment;
  Camera camera;
  std::vector<Axis> axes;
  int variant_axis = -1;  // the axis that chooses material variants, or -1
  // The backdrop: index of the object with follows_camera (always the last one), or -1 where nothing is behind the scene.
  // Its radiance in direction d is environment.lookup(d) or, where background_is_environment is false, background_color;
  // it is seen and reflected by nothing: what lights the scene is the environment alone.
  int background_object = -1;
  bool background_is_environment = true;
  glm::vec3 background_color{0};
  Settings settings;
  std::vector<std::string> warnings;  // one line each: unknown optional extensions, ignored primitives, ...

  ParameterSpace space() const;
  Rig rig() const { return {nodes, tracks}; }
};

// The scene at one position: what moves, where it is; what is switched, how.
struct Pose {
  std::vector<glm::mat4> world_from_node;
  glm::mat4 world_from_camera{1};
  int variant = -1;                               // row of Object::variant_materials, or -1
  std::vector<float> object_emission;             // factor per object
  std::vector<float> light_emission;              // factor per light
  std::vector<std::vector<float>> morph_weights;  // per object; empty: as at rest
};
Pose pose_scene(const Scene& scene, const Position& position);
glm::mat4 world_from_object(const Scene& scene, const Pose& pose, int object);
// Material of a triangle under the pose's variant.
int material_of(const Object& object, const Pose& pose, int triangle);

// Axes that move the camera or any object (they change which texels a pixel sees), and those that move the camera or the
// object's own node relative to it (an object's matrix depends on all axes of geometry_axes, because of occlusion).
AxisMask geometry_axes(const Scene& scene);
AxisMask camera_axes(const Scene& scene);

// Reads SCENE (a folder with scene.toml, or a .toml). Throws InputError.
std::unique_ptr<Scene> load_scene(const std::filesystem::path& scene);

}  // namespace vitrine
