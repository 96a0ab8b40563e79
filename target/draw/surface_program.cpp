// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "target/draw/surface_program.h"

#include <cstring>
#include <string>

#include "target/draw/surface_filter.h"

namespace vitrine {
namespace {

// params[0..3]: clip_from_object, by columns; params[4]: what a probe is given; then for each patch of each texture two rows:
// the linear part of its map, its offset, its cut.
constexpr int kFirstMap = 5, kRows = 2 * kMaxPatches;
int uniform_count(int textures) { return kFirstMap + kRows * textures; }

std::string suffix(int texture) { return texture == 0 ? "" : std::to_string(texture); }

std::string declare_uniforms(int textures) {
  return "uniform vec4 params[" + std::to_string(uniform_count(textures)) + "];\n#define parameter params[4]\n";
}

std::string vertex_source(int textures) {
  std::string outputs, places;
  for (int t = 0; t < textures; ++t) {
    const std::string row = std::to_string(kFirstMap + kRows * t) + " + 2 * number";
    outputs += "out vec2 surface" + suffix(t) + ";\n";
    places += "  surface" + suffix(t) + " = place(coordinate, params[" + row + "], params[" + row + " + 1]);\n";
  }
  return declare_uniforms(textures) + R"(
layout(location = 0) in vec3 position;
layout(location = 1) in vec2 mesh_coordinate;
const float patch_step = )" +
         std::to_string(kPatchStep) + ", last_patch = float(" + std::to_string(kMaxPatches - 1) + ");\n" + outputs +
         R"(
vec2 place(vec2 coordinate, vec4 u, vec4 v) {
  vec2 unwrapped = coordinate + vec2(lessThan(coordinate, vec2(u.w, v.w)));
  return vec2(dot(u.xy, unwrapped) + u.z, dot(v.xy, unwrapped) + v.z);
}
void main() {
  int number = int(clamp(mesh_coordinate.x / patch_step, 0.0, last_patch));
  vec2 coordinate = mesh_coordinate - vec2(patch_step * float(number), 0.0);
)" + places +
         R"(
  gl_Position = mat4(params[0], params[1], params[2], params[3]) * vec4(position, 1.0);
})";
}

std::string fragment_source(int textures) {
  std::string inputs, reads;
  for (int t = 0; t < textures; ++t) {
    const std::string n = suffix(t);
    inputs += "uniform sampler2D radiance" + n + ";\nin vec2 surface" + n + ";\n";
    reads +=
        "  sum " + std::string(t == 0 ? "= " : "+= vec4(1.0, 1.0, 1.0, 0.0) * ") + "read(radiance" + n + ", surface" + n + ");\n";
  }
  return inputs + R"(
layout(location = 0) out vec4 color;
vec4 read(sampler2D texels, vec2 uv) {
  vec2 at;
  vec4 sum = vec4(0.0);
  for (int tap = 0; tap < surface_taps; ++tap) sum += surface_tap(texels, uv, tap, at);
  return sum / float(surface_taps);
}
void main() {
  vec4 sum = vec4(0.0, 0.0, 0.0, 1.0);
)" + reads +
         R"(
  color = sum;
})";
}

Result<hal::Program> create(hal::Gpu& gpu, SurfaceFilter filter, int textures, const char* fragment) {
  static constexpr const char* kSamplers[kMaxSurfaceTextures] = {"radiance",  "radiance1", "radiance2", "radiance3",
                                                                 "radiance4", "radiance5", "radiance6", "radiance7"};
  const std::string vertex = vertex_source(textures), library = declare_uniforms(textures) + surface_tap_source(filter);
  return gpu.create_program({.vertex = vertex.c_str(),
                             .fragment = fragment,
                             .fragment_library = library.c_str(),
                             .samplers = std::span(kSamplers).first(static_cast<size_t>(textures)),
                             .uniform_count = uniform_count(textures)});
}

}  // namespace

Result<hal::Program> create_surface_program(hal::Gpu& gpu, SurfaceFilter filter, int count) {
  return create(gpu, filter, count, fragment_source(count).c_str());
}

Result<hal::Program> create_surface_probe(hal::Gpu& gpu, SurfaceFilter filter, const char* fragment) {
  return create(gpu, filter, 1, fragment);
}

SurfaceUniforms::SurfaceUniforms(const glm::mat4& clip_from_object, const glm::vec4& parameter,
                                 std::span<const SurfaceTexture> textures)
    : count_(4 * static_cast<size_t>(uniform_count(static_cast<int>(textures.size())))) {
  float* out = values_.data();
  std::memcpy(out, &clip_from_object, sizeof clip_from_object);
  std::memcpy(out + 16, &parameter, sizeof parameter);
  out += 4 * kFirstMap;
  for (const SurfaceTexture& texture : textures) {
    for (const PatchMap& map : texture.map.patches)
      for (int row = 0; row < 2; ++row)
        for (const float value : {map.linear[0][row], map.linear[1][row], map.offset[row], map.cut[row]}) *out++ = value;
  }
}

}  // namespace vitrine
