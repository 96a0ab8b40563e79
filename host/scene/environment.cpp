// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/scene/environment.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <numbers>

#include "host/base/error.h"
#include "host/scene/files.h"
#include "host/scene/text.h"

namespace vitrine {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;
constexpr uint64_t kLargestFile = 1ull << 30;

bool is_exr(const Bytes& bytes) { return bytes.size() >= 4 && std::memcmp(bytes.data(), "\x76\x2f\x31\x01", 4) == 0; }
bool is_hdr(const Bytes& bytes) { return bytes.size() >= 2 && bytes[0] == '#' && bytes[1] == '?'; }

// Light is finite and not negative.
size_t repair(Environment& environment) {
  size_t repaired = 0;
  for (glm::vec3& texel : environment.radiance) {
    const glm::vec3 before = texel;
    bool bad = false;
    for (int c = 0; c < 3; ++c) {
      texel[c] = before[c] >= 0 ? std::min(before[c], kBrightestTexel) : 0.0f;  // NaN fails the comparison
      bad |= !(texel[c] == before[c]);
    }
    repaired += bad;
  }
  return repaired;
}

Environment decode(const std::filesystem::path& file, const Bytes& bytes) {
  try {
    if (is_exr(bytes)) return decode_exr(bytes);
    if (is_hdr(bytes)) return decode_radiance_hdr(bytes);
  } catch (const std::bad_alloc&) {
    throw InputError(shown(file), "it needs more memory than there is", "reduce it");
  } catch (const std::exception& e) {
    throw InputError(shown(file), "the light probe cannot be read (" + printable(e.what(), 160) + ")", "save it anew");
  }
  throw InputError(shown(file), "this is neither an OpenEXR nor a Radiance HDR picture", "convert it to one of them");
}

}  // namespace

glm::vec2 latlong_from_direction(const glm::vec3& d) {
  const float longitude = std::atan2(d.x, d.z), latitude = std::atan2(d.y, std::hypot(d.x, d.z));
  return {0.5f - longitude / (2 * kPi), 0.5f - latitude / kPi};
}

glm::vec3 direction_from_latlong(const glm::vec2& uv) {
  const float longitude = (0.5f - uv.x) * 2 * kPi, latitude = (0.5f - uv.y) * kPi;
  return {std::sin(longitude) * std::cos(latitude), std::sin(latitude), std::cos(longitude) * std::cos(latitude)};
}

// The first and last column, and all of the first and last row, are the same directions (ImfEnvmap.h): no wrap is needed.
glm::vec3 Environment::lookup(const glm::vec3& direction) const {
  if (width < 1) return glm::vec3(0);
  if (width == 1 && height == 1) return radiance[0];
  const float c = std::cos(rotation), s = std::sin(rotation);
  const glm::vec3 d(c * direction.x - s * direction.z, direction.y, s * direction.x + c * direction.z);
  const glm::vec2 uv = latlong_from_direction(d);
  const float x = std::clamp(uv.x, 0.0f, 1.0f) * static_cast<float>(width - 1);
  const float y = std::clamp(uv.y, 0.0f, 1.0f) * static_cast<float>(height - 1);
  const int x0 = std::min(static_cast<int>(x), width - 1), y0 = std::min(static_cast<int>(y), height - 1);
  const int x1 = std::min(x0 + 1, width - 1), y1 = std::min(y0 + 1, height - 1);
  const float fx = x - static_cast<float>(x0), fy = y - static_cast<float>(y0);
  const auto at = [&](int i, int j) {
    return radiance[static_cast<size_t>(j) * static_cast<size_t>(width) + static_cast<size_t>(i)];
  };
  return (at(x0, y0) * (1 - fx) + at(x1, y0) * fx) * (1 - fy) + (at(x0, y1) * (1 - fx) + at(x1, y1) * fx) * fy;
}

Environment constant_environment(const glm::vec3& radiance) {
  Environment environment;
  environment.width = environment.height = 1;
  environment.radiance = {radiance};
  return environment;
}

Environment read_environment(const std::filesystem::path& file, std::vector<std::string>* warnings) {
  Environment environment = decode(file, read_file(file, kLargestFile));
  const size_t repaired = repair(environment);
  if (repaired > 0) warnings->push_back(fmt::format("{}: {} texels were negative, infinite or no number", shown(file), repaired));
  if (environment.width > 1 && environment.width != 2 * environment.height)
    warnings->push_back(fmt::format("{}: a lat-long map is twice as wide as high, this has {} x {}", shown(file),
                                    environment.width, environment.height));
  return environment;
}

}  // namespace vitrine
