// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Light probes: which way they face, what they hold, and what happens to broken ones.
#include "host/scene/environment.h"

#include <ImfArray.h>
#include <ImfEnvmap.h>
#include <ImfRgbaFile.h>
#include <ImfStandardAttributes.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <glm/geometric.hpp>
#include <numbers>

#include "host/scene/studio.h"
#include "tests/scene/scene_files.h"

namespace vitrine {
namespace {

using test::Folder;

constexpr float kPi = std::numbers::pi_v<float>;

std::string read_error(const Folder& folder, const std::string& name, const std::string& bytes) {
  folder.write(name, bytes);
  std::vector<std::string> warnings;
  return test::error_of([&] { read_environment(folder.path() / name, &warnings); });
}

void write_exr(const std::filesystem::path& file, int width, int height, Imf::Envmap kind,
               const std::function<glm::vec3(int, int)>& color) {
  Imf::Array2D<Imf::Rgba> pixels(height, width);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) pixels[y][x] = Imf::Rgba(color(x, y).x, color(x, y).y, color(x, y).z);
  Imf::Header header(width, height);
  Imf::addEnvmap(header, kind);
  Imf::RgbaOutputFile out(file.c_str(), header, Imf::WRITE_RGB);
  out.setFrameBuffer(&pixels[0][0], 1, static_cast<size_t>(width));
  out.writePixels(height);
}

// ImfEnvmap.h: latitude 0, longitude 0 is +Z; longitude pi/2 is +X; the first column has longitude +pi.
TEST(Environment, DirectionsStandWhereOpenExrPutsThem) {
  const auto expect_uv = [](const glm::vec3& d, const glm::vec2& uv) {
    EXPECT_LT(glm::distance(latlong_from_direction(d), uv), 1e-6f) << d.x << d.y << d.z;
  };
  expect_uv({0, 0, 1}, {0.5f, 0.5f});
  expect_uv({1, 0, 0}, {0.25f, 0.5f});
  expect_uv({-1, 0, 0}, {0.75f, 0.5f});
  expect_uv({0, 1, 0}, {0.5f, 0});
  expect_uv({0, -1, 0}, {0.5f, 1});
  for (int i = 0; i < 1000; ++i) {
    const glm::vec3 d = glm::normalize(glm::vec3(std::sin(i * 1.1f), std::cos(i * 2.3f), std::sin(i * 0.7f + 1)));
    EXPECT_LT(glm::distance(direction_from_latlong(latlong_from_direction(d)), d), 1e-5f);
  }
}

TEST(Environment, LookupAgreesWithOpenExrsOwnMapping) {
  Environment e;
  e.width = 64;
  e.height = 32;
  const Imath::Box2i window(Imath::V2i(0, 0), Imath::V2i(63, 31));
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 64; ++x) {
      const Imath::V3f d = Imf::LatLongMap::direction(window, Imath::V2f(static_cast<float>(x), static_cast<float>(y)));
      e.radiance.emplace_back(d.x, d.y, d.z);
    }
  for (int y = 1; y < 31; ++y)
    for (int x = 1; x < 63; ++x) {
      const glm::vec3& d = e.radiance[static_cast<size_t>(y * 64 + x)];
      EXPECT_LT(glm::distance(e.lookup(d), d), 2e-4f) << x << ' ' << y;
    }
}

TEST(Environment, RotationTurnsTheProbeCounterClockwiseSeenFromAbove) {
  Environment e;
  e.width = 64;
  e.height = 32;
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 64; ++x) e.radiance.push_back(direction_from_latlong({x / 63.0f, y / 31.0f}));
  e.rotation = kPi / 2;  // about +Y: what stood on +Z stands on +X now
  EXPECT_LT(glm::distance(e.lookup({1, 0, 0}), glm::vec3(0, 0, 1)), 0.05f);
  EXPECT_LT(glm::distance(e.lookup({0, 0, 1}), glm::vec3(-1, 0, 0)), 0.05f);
  EXPECT_LT(glm::distance(e.lookup({0, 1, 0}), glm::vec3(0, 1, 0)), 0.05f);
}

TEST(Environment, ConstantIsTheSameFromEverywhereAndNoneIsBlack) {
  EXPECT_EQ(constant_environment({1, 2, 3}).lookup({0, -1, 0}), glm::vec3(1, 2, 3));
  EXPECT_EQ(Environment().lookup({0, 1, 0}), glm::vec3(0));
}

// The chart has black strokes from the middle of each side towards +Y, and towards +X or +Z, and none the other way.
TEST(Environment, OrientationChartFacesTheRightWay) {
  const std::filesystem::path file = std::filesystem::path(VITRINE_EXTRA_ASSETS) / "assets/env/OrientationLatLong.exr";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no " << file << ": the orientation is not compared with OpenEXR's chart";
  std::vector<std::string> warnings;
  const Environment e = read_environment(file, &warnings);
  // Share of the way from 5 to 20 degrees away from `from` towards `to` on which something black lies within 2 degrees.
  const auto blackness = [&](const glm::vec3& from, const glm::vec3& to) {
    const glm::vec3 aside = glm::cross(from, to);
    int black = 0;
    for (int k = 0; k < 60; ++k) {
      const float angle = (5 + 15 * k / 59.0f) * kPi / 180;
      float darkest = 1;
      for (int w = -10; w <= 10; ++w)
        darkest = std::min(
            darkest,
            e.lookup(glm::normalize(std::cos(angle) * from + std::sin(angle) * to + 0.0035f * static_cast<float>(w) * aside)).y);
      black += darkest < 0.35f;
    }
    return black / 60.0f;
  };
  const glm::vec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  for (const auto& [from, to] : {std::pair{z, x}, {x, z}, {-x, z}, {z, y}, {x, y}, {-x, y}}) {
    EXPECT_GT(blackness(from, to), 0.85f);
    EXPECT_LT(blackness(from, -to), 0.5f);
  }
}

TEST(Environment, CubeMapsAreResampledFaceByFace) {
  const Folder folder;
  const std::filesystem::path file = folder.path() / "cube.exr";
  const int size = 32;
  const Imath::Box2i window(Imath::V2i(0, 0), Imath::V2i(size - 1, 6 * size - 1));
  write_exr(file, size, 6 * size, Imf::ENVMAP_CUBE, [&](int x, int y) {
    const auto face = static_cast<Imf::CubeMapFace>(y / size);
    // Find the place in the face by inverting pixelPosition, which only mirrors.
    for (int j = 0; j < size; ++j)
      for (int i = 0; i < size; ++i) {
        const Imath::V2f p = Imf::CubeMap::pixelPosition(face, window, Imath::V2f(static_cast<float>(i), static_cast<float>(j)));
        if (static_cast<int>(p.x + 0.5f) != x || static_cast<int>(p.y + 0.5f) != y) continue;
        const Imath::V3f d =
            Imf::CubeMap::direction(face, window, Imath::V2f(static_cast<float>(i), static_cast<float>(j))).normalized();
        return glm::vec3(d.x, d.y, d.z) + 2.0f;
      }
    return glm::vec3(0);
  });
  std::vector<std::string> warnings;
  const Environment e = read_environment(file, &warnings);
  EXPECT_EQ(e.width, 4 * size);
  for (int i = 0; i < 500; ++i) {
    const glm::vec3 d = glm::normalize(glm::vec3(std::sin(i * 1.1f), std::cos(i * 2.3f), std::sin(i * 0.7f + 1)));
    EXPECT_LT(glm::distance(e.lookup(d), d + 2.0f), 0.05f);
  }
}

TEST(Environment, RadianceRunsAndFlatRowsHoldTheSamePixels) {
  const std::string head = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 8\n";
  std::string flat, runs(std::string("\2\2\0\10", 4));
  for (int x = 0; x < 8; ++x) flat += std::string{char(x), char(10), char(20), char(129)};
  runs += std::string("\10\0\1\2\3\4\5\6\7", 9) + "\x88\x0a" + "\x88\x14" + "\x88\x81";
  const auto decode = [](const std::string& s) {
    return decode_radiance_hdr({reinterpret_cast<const uint8_t*>(s.data()), s.size()});
  };
  const Environment a = decode(head + flat), b = decode(head + runs);
  EXPECT_EQ(a.radiance, b.radiance);
  EXPECT_EQ(a.radiance[4], glm::vec3(4, 10, 20) * std::ldexp(1.0f, 129 - 136));
  const Environment exposed = decode("#?RADIANCE\nEXPOSURE=2\nEXPOSURE= 2\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 8\n" + flat);
  EXPECT_EQ(exposed.radiance[4], a.radiance[4] / 4.0f) << "EXPOSURE was multiplied into the pixels; it is taken out again";
}

TEST(Environment, BrokenRadianceFilesGetOneLine) {
  const std::string head = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n";
  const struct {
    std::string bytes;
    const char* error;
  } cases[] = {
      {"#?RADIANCE\n", "the file ends too early"},
      {head + "-Y 2 +X 8\n" + std::string("\2\2\0\10\0\0\0\0\0\0\0\0", 12),
       "a run has the wrong length"},  // stb_image hangs here
      {head + "-Y 1 +X 8\n" + std::string("\2\2\0\11", 4), "a row has the wrong length"},
      {head + "-Y 1 +X 8\n" + std::string("\2\2\0\10\x89\1", 6), "a run has the wrong length"},
      {head + "-Y 1 +X 8\n" + std::string("\1\1\1\5", 4), "a run has the wrong length"},
      {head + "-Y 999999 +X 999999\n", "a size of 999999 x 999999 is not read"},
      {head + "-Y 0 +X 8\n", "a size of 8 x 0 is not read"},
      {head + "+Y 1 +X 8\n", "not stored from top to bottom"},
      {"#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\nabcd", "its pixel format is not RGBE"},
      {"#?RADIANCE\nEXPOSURE=0\n\n-Y 1 +X 1\nabcd", "its exposure makes no sense"},
      {head + "-Y 8000 +X 4000\nabcd", "the file ends too early"},
  };
  const Folder folder;
  for (const auto& c : cases) {
    const test::CpuTimer timer;
    const std::string error = read_error(folder, "probe.hdr", c.bytes);
    EXPECT_NE(error.find(c.error), std::string::npos) << error;
    EXPECT_EQ(error.find('\n'), std::string::npos);
    EXPECT_LT(timer.seconds(), test::kHangSeconds);
  }
}

std::string exr_attribute(const std::string& name, const std::string& type, const std::string& value) {
  return name + '\0' + type + '\0' + test::u32(static_cast<uint32_t>(value.size())) + value;
}

std::string exr_window(int32_t width, int32_t height) {
  return test::bytes_of(std::vector<int32_t>{0, 0, width - 1, height - 1});
}

TEST(Environment, BrokenExrFilesGetOneLineBeforeTheyCostMemory) {
  const std::string start = "\x76\x2f\x31\x01" + test::u32(2);
  const struct {
    std::string bytes;
    const char* error;
  } cases[] = {
      {start, "its header is cut short"},
      {"\x76\x2f\x31\x01" + test::u32(2 | 0x800), "a deep or multi-part file is no light probe"},
      {"\x76\x2f\x31\x01" + test::u32(9), "its OpenEXR version is not 2"},
      {start + exr_attribute("dataWindow", "box2i", exr_window(2000000000, 1)) + '\0', "a size of 2000000000 x 1 is not read"},
      {start + exr_attribute("dataWindow", "box2i", exr_window(-5, 7)) + '\0', "is not read"},
      {start + "x" + '\0' + "string" + '\0' + test::u32(0x7FFFFFFF), "its header is cut short"},
      {start + exr_attribute("dataWindow", "box2i", exr_window(8192, 4096)) +
           exr_attribute("tiles", "tiledesc", test::u32(1) + test::u32(1) + '\0') + '\0',
       "it promises more tiles than it has bytes for"},
      {start + exr_attribute("tiles", "tiledesc", test::u32(0) + test::u32(0) + '\0') + '\0',
       "its tiles have no size that is read"},
      {start + '\0', "it has no data window"},
  };
  const Folder folder;
  for (const auto& c : cases) {
    const std::string error = read_error(folder, "probe.exr", c.bytes);
    EXPECT_NE(error.find(c.error), std::string::npos) << error;
    EXPECT_EQ(error.find('\n'), std::string::npos);
  }
  write_exr(folder.path() / "whole.exr", 64, 32, Imf::ENVMAP_LATLONG, [](int, int) { return glm::vec3(1); });
  std::ifstream stream(folder.path() / "whole.exr", std::ios::binary);
  const std::string whole((std::istreambuf_iterator<char>(stream)), std::istreambuf_iterator<char>());
  for (size_t length = 0; length + 1 < whole.size(); length += 7) {
    const std::string error = read_error(folder, "cut.exr", whole.substr(0, length));
    EXPECT_NE(error, "") << length;
    EXPECT_EQ(error.find('\n'), std::string::npos);
  }
}

TEST(Environment, LightThatIsNoNumberBecomesNone) {
  const Folder folder;
  write_exr(folder.path() / "odd.exr", 4, 2, Imf::ENVMAP_LATLONG,
            [](int x, int) { return x == 0 ? glm::vec3(NAN, -1, INFINITY) : glm::vec3(1); });
  std::vector<std::string> warnings;
  const Environment e = read_environment(folder.path() / "odd.exr", &warnings);
  EXPECT_EQ(e.radiance[0], glm::vec3(0, 0, kBrightestTexel));
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("2 texels were negative, infinite or no number"), std::string::npos);
}

TEST(Environment, StudioLightsAWhiteSurfaceToAboutOne) {
  const Folder folder;
  write_studio(folder.path() / "studio.exr");
  std::vector<std::string> warnings;
  const Environment e = read_environment(folder.path() / "studio.exr", &warnings);
  EXPECT_EQ(e.width, 256);
  EXPECT_TRUE(warnings.empty());
  const float a = 42 * kPi / 180, el = 42 * kPi / 180;
  const glm::vec3 key(std::cos(el) * std::sin(a), std::sin(el), std::cos(el) * std::cos(a));
  glm::vec3 exitance(0);
  float difference = 0;
  for (int y = 0; y < 128; ++y)
    for (int x = 0; x < 256; ++x) {
      const glm::vec2 uv((x + 0.5f) / 256, (y + 0.5f) / 128);
      const glm::vec3 d = direction_from_latlong(uv);
      difference += glm::distance(e.lookup(d), studio_radiance(d)) / (256 * 128);
      exitance += e.lookup(d) * std::max(0.0f, glm::dot(d, key)) * std::sin(kPi * uv.y) * (2 * kPi / 256) * (kPi / 128) / kPi;
    }
  EXPECT_LT(difference, 0.01f) << "256 x 128 texels hold it";
  EXPECT_NEAR(exitance.y, 1.1f, 0.1f) << "radiance of a white diffuse surface that faces the key light";
}

}  // namespace
}  // namespace vitrine
