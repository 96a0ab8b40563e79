// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/scene/studio.h"

#include <ImfArray.h>
#include <ImfRgbaFile.h>
#include <ImfStandardAttributes.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "host/base/error.h"
#include "host/scene/environment.h"
#include "host/scene/files.h"

namespace vitrine {
namespace {

constexpr int kWidth = 256, kHeight = 128;

// A rectangular light with soft edges. Angles in degrees: azimuth from +Z towards +X, elevation above the horizon.
struct SoftBox {
  float azimuth, elevation, width, height, radiance;
  glm::vec3 tint;
};
const SoftBox kBoxes[] = {
    {42, 42, 52, 34, 3.3f, {1.0f, 0.97f, 0.92f}},   // key
    {-72, 18, 30, 64, 1.6f, {0.93f, 0.97f, 1.0f}},  // fill
    {168, 46, 76, 16, 3.6f, {1.0f, 1.0f, 1.0f}},    // rim, from behind
    {0, 88, 60, 60, 1.6f, {1.0f, 0.99f, 0.97f}},    // ceiling
};

float radians(float degrees) { return degrees * std::numbers::pi_v<float> / 180; }

float smooth(float low, float high, float x) {
  const float t = std::fmin(1.0f, std::fmax(0.0f, (x - low) / (high - low)));
  return t * t * (3 - 2 * t);
}

// 1 within, 0 without, soft over half of the half width.
float soft_edge(float x, float half) { return 1 - smooth(0.6f * half, 1.1f * half, std::fabs(x)); }

float coverage(const SoftBox& box, const glm::vec3& d) {
  const float a = radians(box.azimuth), e = radians(box.elevation);
  const glm::vec3 middle(std::cos(e) * std::sin(a), std::sin(e), std::cos(e) * std::cos(a));
  const glm::vec3 right(std::cos(a), 0, -std::sin(a)), up = glm::cross(middle, right);
  const float depth = glm::dot(d, middle);
  if (depth <= 0.05f) return 0;
  return soft_edge(glm::dot(d, right) / depth, std::tan(radians(box.width / 2))) *
         soft_edge(glm::dot(d, up) / depth, std::tan(radians(box.height / 2)));
}

}  // namespace

glm::vec3 studio_radiance(const glm::vec3& d) {
  // The cyclorama: a grey floor that rolls up into a brighter wall, which darkens towards the ceiling.
  const float floor_to_wall = smooth(-0.55f, 0.10f, d.y), wall_to_ceiling = smooth(0.15f, 0.95f, d.y);
  glm::vec3 light = glm::vec3(0.30f + 0.22f * floor_to_wall - 0.34f * wall_to_ceiling);
  for (const SoftBox& box : kBoxes) light += box.tint * (box.radiance * coverage(box, d));
  return light;
}

void write_studio(const std::filesystem::path& file) {
  Imf::Array2D<Imf::Rgba> pixels(kHeight, kWidth);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const glm::vec2 uv(static_cast<float>(x) / (kWidth - 1), static_cast<float>(y) / (kHeight - 1));
      const glm::vec3 light = studio_radiance(direction_from_latlong(uv));
      pixels[y][x] = Imf::Rgba(light.x, light.y, light.z, 1);
    }
  try {
    Imf::Header header(kWidth, kHeight);
    header.compression() = Imf::ZIP_COMPRESSION;
    Imf::addEnvmap(header, Imf::ENVMAP_LATLONG);
    Imf::RgbaOutputFile out(file.c_str(), header, Imf::WRITE_RGB, 0);
    out.setFrameBuffer(&pixels[0][0], 1, kWidth);
    out.writePixels(kHeight);
  } catch (const std::exception&) {
    throw InputError(shown(file), "it cannot be written", "check the folder's permissions and the free space");
  }
}

}  // namespace vitrine
