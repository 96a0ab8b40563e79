// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Against matrices written out by hand: neither quaternions nor the library of the code under test decide.
#include "formats/rig.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace vitrine {
namespace {

constexpr float kPi = 3.14159265358979f;

void expect_point(const glm::mat4& m, const glm::vec3& p, const glm::vec3& expected, float tolerance = 1e-5f) {
  for (int row = 0; row < 3; ++row)
    EXPECT_NEAR(m[0][row] * p.x + m[1][row] * p.y + m[2][row] * p.z + m[3][row], expected[row], tolerance) << row;
}

std::vector<glm::mat4> evaluate(const std::vector<RigNode>& nodes, const std::vector<RigTrack>& tracks,
                                const Position& position) {
  std::vector<glm::mat4> matrices(nodes.size());
  evaluate_rig({nodes, tracks}, position, matrices);
  return matrices;
}

// About +Y by `angle`, as glTF stores it.
std::vector<float> turn_y(float angle) { return {0, std::sin(angle / 2), 0, std::cos(angle / 2)}; }
glm::vec3 turned_y(float angle, const glm::vec3& p) {
  return {std::cos(angle) * p.x + std::sin(angle) * p.z, p.y, -std::sin(angle) * p.x + std::cos(angle) * p.z};
}

struct Track {
  std::vector<float> positions, values;
  RigTrack track;
  Track(TrackPath path, Interpolation interpolation, std::vector<float> p, std::vector<float> v)
      : positions(std::move(p)), values(std::move(v)) {
    track.path = path;
    track.interpolation = interpolation;
    track.positions = positions;
    track.values = values;
  }
};

TEST(Rig, ScaleThenRotationThenTranslationAndParentsLast) {
  RigNode parent, child;
  parent.translation = {10, 0, 0};
  parent.scale = {2, 2, 2};
  child.parent = 0;
  child.translation = {0, 1, 0};
  child.rotation = glm::quat(std::cos(kPi / 4), 0, std::sin(kPi / 4), 0);  // a quarter turn about Y
  child.scale = {1, 3, 1};
  const auto m = evaluate({parent, child}, {}, {});
  // (1, 1, 0) -> scale (1, 3, 0) -> turn (0, 3, -1) -> move (0, 4, -1) -> parent (10, 8, -2)
  expect_point(m[1], {1, 1, 0}, {10, 8, -2});
}

TEST(Rig, AMatrixNodeIsTakenAsItIs) {
  RigNode node;
  node.matrix = glm::mat4(0, 2, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1);
  expect_point(evaluate({node}, {}, {})[0], {1, 2, 3}, {2 + 5, 2 + 6, 3 + 7});
}

TEST(Rig, ATrackReplacesOnlyItsOwnPart) {
  RigNode node;
  node.translation = {1, 2, 3};
  node.scale = {2, 2, 2};
  const Track t(TrackPath::kTranslation, Interpolation::kLinear, {0, 1}, {0, 0, 0, 4, 0, 0});
  expect_point(evaluate({node}, {t.track}, {0.25f})[0], {1, 0, 0}, {1 + 2, 0, 0});
}

TEST(Rig, StepsHoldTheKeyBefore) {
  const Track t(TrackPath::kTranslation, Interpolation::kStep, {0.2f, 0.5f, 0.8f}, {1, 0, 0, 2, 0, 0, 3, 0, 0});
  const float expected[][2] = {{0, 1}, {0.2f, 1}, {0.49f, 1}, {0.5f, 2}, {0.79f, 2}, {0.8f, 3}, {1, 3}};
  for (const auto& [position, x] : expected) EXPECT_EQ(evaluate({RigNode{}}, {t.track}, {position})[0][3][0], x) << position;
}

TEST(Rig, BeforeTheFirstAndAfterTheLastKeyTheValueIsHeld) {
  const Track t(TrackPath::kScale, Interpolation::kLinear, {0.25f, 0.75f}, {1, 1, 1, 3, 3, 3});
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float expected[][2] = {{0, 1}, {0.25f, 1}, {0.5f, 2}, {0.75f, 3}, {1, 3}, {9, 3}, {-9, 1}, {nan, 1}};
  for (const auto& [position, s] : expected)
    EXPECT_NEAR(evaluate({RigNode{}}, {t.track}, {position})[0][0][0], s, 1e-6f) << position;
}

TEST(Rig, RotationsTurnEvenlyAlongTheShorterArc) {
  std::vector<float> values = turn_y(0.2f), to = turn_y(2.2f);
  for (float& v : to) v = -v;  // the same rotation, the other sign
  values.insert(values.end(), to.begin(), to.end());
  const Track t(TrackPath::kRotation, Interpolation::kLinear, {0, 1}, values);
  for (int i = 0; i <= 16; ++i) {
    const float p = static_cast<float>(i) / 16;
    expect_point(evaluate({RigNode{}}, {t.track}, {p})[0], {1, 0.5f, 2}, turned_y(0.2f + 2 * p, {1, 0.5f, 2}));
  }
}

TEST(Rig, RotationsThatAreAllButEqualDoNotBreak) {
  std::vector<float> values = turn_y(1), to = turn_y(1 + 1e-6f);
  values.insert(values.end(), to.begin(), to.end());
  const Track t(TrackPath::kRotation, Interpolation::kLinear, {0, 1}, values);
  expect_point(evaluate({RigNode{}}, {t.track}, {0.5f})[0], {1, 0, 0}, turned_y(1, {1, 0, 0}));
}

TEST(Rig, RotationsAreMadeUnit) {
  RigNode node;
  node.rotation = glm::quat(1.2f * std::cos(0.4f), 0, 1.2f * std::sin(0.4f), 0);
  expect_point(evaluate({node}, {}, {})[0], {1, 0, 0}, turned_y(0.8f, {1, 0, 0}));
}

// Tangents of a cubic polynomial: the spline must be that polynomial, whatever the distance of the keys.
TEST(Rig, SplinesReproduceCubics) {
  const auto f = [](float x) { return 1 + 2 * x - 3 * x * x + 4 * x * x * x; };
  const auto slope = [](float x) { return 2 - 6 * x + 12 * x * x; };
  std::vector<float> keys = {0.1f, 0.4f, 0.9f}, values;
  for (const float k : keys)
    for (const float v : {slope(k), f(k), slope(k)}) values.insert(values.end(), {v, -v, 0});
  const Track t(TrackPath::kTranslation, Interpolation::kCubicSpline, keys, values);
  for (int i = 2; i <= 18; ++i) {
    const float p = static_cast<float>(i) / 20;
    const glm::mat4 m = evaluate({RigNode{}}, {t.track}, {p})[0];
    EXPECT_NEAR(m[3][0], f(p), 1e-5f) << p;
    EXPECT_NEAR(m[3][1], -f(p), 1e-5f) << p;
  }
  EXPECT_NEAR(evaluate({RigNode{}}, {t.track}, {0})[0][3][0], f(0.1f), 1e-6f);
  EXPECT_NEAR(evaluate({RigNode{}}, {t.track}, {1})[0][3][0], f(0.9f), 1e-6f);
}

TEST(Rig, SplinedRotationsAreRotations) {
  std::vector<float> values;
  for (const float angle : {0.0f, 1.5f}) {
    values.insert(values.end(), {0, 0, 0, 0});
    for (const float v : turn_y(angle)) values.push_back(v);
    values.insert(values.end(), {0, 0, 0, 0});
  }
  const Track t(TrackPath::kRotation, Interpolation::kCubicSpline, {0, 1}, values);
  for (int i = 0; i <= 8; ++i) {
    const glm::mat4 m = evaluate({RigNode{}}, {t.track}, {static_cast<float>(i) / 8})[0];
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(glm::dot(m[c], m[c]), 1, 1e-5f);
  }
  expect_point(evaluate({RigNode{}}, {t.track}, {0.5f})[0], {1, 0, 0}, turned_y(0.75f, {1, 0, 0}));
}

TEST(Rig, TracksFollowTheirOwnAxis) {
  Track a(TrackPath::kTranslation, Interpolation::kLinear, {0, 1}, {0, 0, 0, 1, 0, 0});
  Track b(TrackPath::kTranslation, Interpolation::kLinear, {0, 1}, {0, 0, 0, 0, 1, 0});
  b.track.axis = 2;
  b.track.node = 1;
  const auto m = evaluate({RigNode{}, RigNode{}}, {a.track, b.track}, {0.25f, 0, 0.75f});
  expect_point(m[0], {0, 0, 0}, {0.25f, 0, 0});
  expect_point(m[1], {0, 0, 0}, {0, 0.75f, 0});
}

// ---- camera ----

glm::vec3 project(const glm::mat4& m, const glm::vec4& p) {
  glm::vec4 c(0);
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row) c[row] += m[column][row] * p[column];
  return {c.x / c.w, c.y / c.w, c.z / c.w};
}

TEST(Camera, PerspectiveFillsThePictureAtItsFieldOfView) {
  Camera camera;
  camera.yfov = 1.0f;
  camera.near_distance = 0.5f;
  camera.far_distance = 20;
  const glm::mat4 m = clip_from_camera(camera, 1.5f);
  const float depth = 7, half = depth * std::tan(0.5f);
  const glm::vec3 corner = project(m, {1.5f * half, half, -depth, 1});
  EXPECT_NEAR(corner.x, 1, 1e-5f);
  EXPECT_NEAR(corner.y, 1, 1e-5f);
  EXPECT_NEAR(project(m, {0, 0, -0.5f, 1}).z, -1, 1e-5f);
  EXPECT_NEAR(project(m, {0, 0, -20, 1}).z, 1, 1e-4f);
}

TEST(Camera, OrthographicFillsThePictureAtItsMagnification) {
  Camera camera;
  camera.perspective = false;
  camera.ymag = 3;
  camera.near_distance = 1;
  camera.far_distance = 5;
  const glm::mat4 m = clip_from_camera(camera, 2);
  const glm::vec3 corner = project(m, {-6, 3, -5, 1});
  EXPECT_NEAR(corner.x, -1, 1e-5f);
  EXPECT_NEAR(corner.y, 1, 1e-5f);
  EXPECT_NEAR(corner.z, 1, 1e-5f);
  EXPECT_NEAR(project(m, {0, 0, -1, 1}).z, -1, 1e-5f);
}

}  // namespace
}  // namespace vitrine
