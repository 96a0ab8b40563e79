// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/bench/traced_textures.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "host/bench/filling.h"
#include "host/bench/lanczos.h"
#include "host/bench/surface_points.h"
#include "host/trace/camera_rays.h"
#include "host/trace/integrator.h"

namespace vitrine {
namespace {

constexpr int kPoints = 3;  // a texel, along one dimension
constexpr int kPointHalfWidth = 6, kPointLobes = kPointHalfWidth / kPoints,
              kPointTaps = 2 * kPointHalfWidth - 1;  // of the decimation, in points

trace::PathSettings path_settings(const Scene& scene) {
  trace::PathSettings settings;
  settings.max_radiance = scene.settings.max_radiance;
  settings.straight_shadows = !scene.settings.caustics;
  return settings;
}

bool is_finite(const glm::vec3& light) { return std::isfinite(light.x + light.y + light.z); }

std::array<float, kPointTaps> decimation_weights() {
  std::array<float, kPointTaps> weights;
  double sum = 0;
  for (int k = 0; k < kPointTaps; ++k) sum += lanczos(static_cast<double>(k - kPointHalfWidth + 1) / kPoints, kPointLobes);
  for (int k = 0; k < kPointTaps; ++k)
    weights[static_cast<size_t>(k)] =
        static_cast<float>(lanczos(static_cast<double>(k - kPointHalfWidth + 1) / kPoints, kPointLobes) / sum);
  return weights;
}

// `lines` lines of `size` texels each from kPoints * size points each, clamped at both ends. `stride`: from a line's point to
// its next, `pitch`: from a line to the next, in points and likewise in texels of what is made.
struct Walk {
  size_t stride, pitch;
};
std::vector<glm::vec3> decimate_lines(const std::vector<glm::vec3>& points, int size, int lines, const Walk& from,
                                      const Walk& to) {
  const std::array<float, kPointTaps> weights = decimation_weights();
  std::vector<glm::vec3> texels(static_cast<size_t>(size) * static_cast<size_t>(lines));
  for (int line = 0; line < lines; ++line)
    for (int x = 0; x < size; ++x) {
      glm::vec3 sum(0);
      for (int k = 0; k < kPointTaps; ++k) {
        const int point = std::clamp(kPoints * x + kPoints / 2 + k - kPointHalfWidth + 1, 0, kPoints * size - 1);
        sum += weights[static_cast<size_t>(k)] *
               points[static_cast<size_t>(line) * from.pitch + static_cast<size_t>(point) * from.stride];
      }
      texels[static_cast<size_t>(line) * to.pitch + static_cast<size_t>(x) * to.stride] = sum;
    }
  return texels;
}

LinearTexture decimate_points(const std::vector<glm::vec3>& points, int width, int height) {
  const auto columns = static_cast<size_t>(width);
  const std::vector<glm::vec3> narrow = decimate_lines(points, width, kPoints * height, {1, kPoints * columns}, {1, columns});
  LinearTexture texture{width, height, decimate_lines(narrow, height, width, {columns, 1}, {columns, 1})};
  for (glm::vec3& texel : texture.texels) texel = glm::max(texel, glm::vec3(0));
  return texture;
}

}  // namespace

struct TextureTracer::Impl {
  explicit Impl(const Scene& scene) : world(scene) { world.pose(scene.space().position_of({})); }
  trace::World world;
};

namespace {

// Everything that the points of one object share.
struct ObjectTrace {
  const trace::World& world;
  const trace::Integrator& integrator;
  const trace::CameraRays& camera;
  const DrawnObject& object;
  const TextureTraceOptions& options;
  glm::mat4 world_from_object, clip_from_object;

  // The ray meets the point's own triangle, wherever else it would have stopped.
  std::optional<trace::FirstHit> meet(const SurfacePoint& point) const {
    const auto place = pixel_of(clip_from_object, point.position, {options.width, options.height});
    if (!place) return std::nullopt;
    trace::FirstHit first;
    first.ray = camera.ray(place->x, place->y);
    first.object = object.object;
    first.solid = !world.scene().objects[static_cast<size_t>(object.object)].follows_camera;
    if (!first.solid) return first;
    const glm::vec3 position = world_from_object * glm::vec4(point.position, 1);
    first.hit = {object.object, static_cast<int>(object.triangles[static_cast<size_t>(point.triangle)]), point.weights.y,
                 point.weights.z, glm::length(position - first.ray.origin)};
    first.surface = world.surface_at(first.ray, first.hit);
    return first;
  }

  // Of one point: the sum of its layers. `x`, `y`: its place among all points.
  glm::vec3 radiance(const trace::FirstHit& first, int x, int y) const {
    const int samples = (options.samples_per_texel + kPoints * kPoints - 1) / (kPoints * kPoints);
    const glm::vec3 white(1 / world.scene().settings.exposure);
    glm::dvec3 diffuse(0), specular(0);
    for (int i = 0; i < samples; ++i) {
      trace::Sampler sampler(static_cast<uint32_t>(x), static_cast<uint32_t>(y), static_cast<uint32_t>(i), options.seed);
      const trace::CameraSample sample = integrator.shade(first, {}, sampler);
      if (is_finite(sample.diffuse)) diffuse += sample.diffuse;
      if (is_finite(sample.specular + sample.view)) specular += sample.specular + sample.view;
    }
    const double share = 1.0 / samples;
    return glm::min(glm::vec3(share * diffuse), white) + glm::min(glm::vec3(share * specular), white);
  }
};

PartialPicture trace_points(const ObjectTrace& points_of, const Placement& placement, Progress& progress) {
  const int width = kPoints * placement.size.width, height = kPoints * placement.size.height;
  const std::vector<SurfacePoint> points = surface_points(points_of.object, {{width, height}, placement.map});
  PartialPicture picture{width, height, std::vector<glm::vec3>(points.size(), glm::vec3(0)), std::vector<uint8_t>(points.size())};
  tbb::parallel_for(0, height, [&](int y) {
    progress.advance(0);
    for (int x = 0; x < width; ++x) {
      const size_t i = static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x);
      if (points[i].triangle < 0) continue;
      const auto first = points_of.meet(points[i]);
      if (!first) continue;
      picture.values[i] = points_of.radiance(*first, x, y);
      picture.defined[i] = 1;
    }
  });
  return picture;
}

}  // namespace

TextureTracer::TextureTracer(const Scene& scene) : impl_(std::make_unique<Impl>(scene)) {}
TextureTracer::~TextureTracer() = default;

LinearTexture TextureTracer::trace(const DrawnObject& object, const Placement& placement, const TextureTraceOptions& options,
                                   Progress& progress) const {
  const trace::World& world = impl_->world;
  const Scene& scene = world.scene();
  const Pose& pose = world.current_pose();
  const trace::Lights lights(world);
  const trace::Integrator integrator(world, lights, path_settings(scene));
  const trace::CameraRays camera(scene.camera, pose.world_from_camera, options.width, options.height);
  const float aspect = static_cast<float>(options.width) / static_cast<float>(options.height);
  const glm::mat4 placed = world_from_object(scene, pose, object.object);
  const ObjectTrace own{world,
                        integrator,
                        camera,
                        object,
                        options,
                        placed,
                        clip_from_camera(scene.camera, aspect) * glm::inverse(pose.world_from_camera) * placed};
  const PartialPicture points = trace_points(own, placement, progress);
  return decimate_points(fill_from_neighbors(points), placement.size.width, placement.size.height);
}

}  // namespace vitrine
