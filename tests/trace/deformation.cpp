// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Pictures of meshes that an axis deforms: those of the same meshes with the pose baked in.
#include "host/scene/deformation.h"

#include <gtest/gtest.h>

#include "host/scene/geometry.h"
#include "host/trace/tracer.h"
#include "tests/trace/measure.h"
#include "tests/trace/scenes.h"

namespace vitrine::test {
namespace {

// A floor with a metal ball under a lamp.
Scene ball_under_lamp() {
  Scene scene = scene_with_camera({0, 1.2f, 4}, {0, 0.5f, 0}, 0.6f);
  scene.axes.push_back({"shape", {AxisKind::kLinear, 3}, 1, {}});
  add_object(scene, make_quad({-3, 0, 3}, {6, 0, 0}, {0, 0, -6}), add_material(scene, lambert(glm::vec3(0.6f))), "floor");
  add_object(scene, make_sphere({0, 0.5f, 0}, 0.5f, 12), add_material(scene, metal({0.9f, 0.7f, 0.4f}, 0.3f)), "ball");
  add_object(scene, make_quad({-0.5f, 2, -0.5f}, {1, 0, 0}, {0, 0, 1}), add_material(scene, lamp(glm::vec3(6))), "lamp");
  for (Object& object : scene.objects) repair_normals(object.geometry);  // as the loader does
  return scene;
}

constexpr size_t kBall = 1, kLamp = 2;

glm::vec3 stretch(const glm::vec3& p) { return {p.x, 0.5f * p.y, 0}; }
glm::vec3 shift(const glm::vec3&) { return {1, 0, 0.5f}; }

// The axis moves every vertex of an object by displacement(vertex).
void morph_by_axis(Scene& scene, size_t object, const std::function<glm::vec3(const glm::vec3&)>& displacement) {
  Object& o = scene.objects[object];
  MeshPrimitive primitive;
  primitive.vertices = o.geometry;
  primitive.materials = {o.geometry.triangle_materials[0]};
  MorphTarget target;
  for (const glm::vec3& p : o.geometry.positions) target.positions.push_back(displacement(p));
  primitive.targets = {target};
  o.deformation = std::make_shared<Deformation>(Deformation{{primitive}, {0}, {}});
  scene.weight_tracks.push_back({static_cast<int>(object), 0, Interpolation::kLinear, {0, 1}, {0, 1}});
}

void bake(Scene& scene, size_t object, float weight, const std::function<glm::vec3(const glm::vec3&)>& displacement) {
  for (glm::vec3& p : scene.objects[object].geometry.positions) p += weight * displacement(p);
}

TraceOptions small() {
  TraceOptions options;
  options.width = 40;
  options.height = 30;
  options.samples_per_pixel = 16;
  return options;
}

void expect_same(const Frame& a, const Frame& b) {
  EXPECT_EQ(a.combined, b.combined);
  ASSERT_EQ(a.objects.size(), b.objects.size());
  for (size_t i = 0; i < a.objects.size(); ++i) {
    EXPECT_EQ(a.objects[i].coverage, b.objects[i].coverage);
    EXPECT_EQ(a.objects[i].diffuse, b.objects[i].diffuse);
    EXPECT_EQ(a.objects[i].specular, b.objects[i].specular);
  }
}

TEST(DeformedPicture, IsThatOfAFileWithThePoseBakedIn) {
  Scene deformed = ball_under_lamp(), baked = ball_under_lamp();
  morph_by_axis(deformed, kBall, stretch);
  morph_by_axis(deformed, kLamp, shift);  // what it lights follows it
  bake(baked, kBall, 0.5f, stretch);
  bake(baked, kLamp, 0.5f, shift);
  const Frame frame = Tracer(deformed).render({0.5f}, small());
  expect_same(frame, Tracer(baked).render({}, small()));
  EXPECT_NE(frame.combined, Tracer(deformed).render({0}, small()).combined);
}

TEST(DeformedPicture, DoesNotDependOnThePosesBeforeIt) {
  Scene scene = ball_under_lamp();
  morph_by_axis(scene, kBall, stretch);
  Tracer tracer(scene);
  const Frame first = tracer.render({0.25f}, small());
  tracer.render({1}, small());
  expect_same(tracer.render({0.25f}, small()), first);
  expect_same(Tracer(scene).render({0.25f}, small()), first);
}

TEST(DeformedPicture, SkinnedMeshesStandWhereTheirJointsDo) {
  Scene scene = ball_under_lamp(), baked = ball_under_lamp();
  Object& ball = scene.objects[kBall];
  MeshPrimitive primitive;
  primitive.vertices = ball.geometry;
  primitive.materials = {ball.geometry.triangle_materials[0]};
  primitive.influences.assign(ball.geometry.positions.size(), {0, 1});
  primitive.influences_per_vertex = 1;
  const int joint = static_cast<int>(scene.nodes.size());
  scene.nodes.emplace_back();
  ball.deformation = std::make_shared<Deformation>(Deformation{{primitive}, {}, {{joint, glm::mat4(1)}}});
  const std::vector<float> positions{0, 1}, values{0, 0, 0, -1, 0.5f, 0};
  scene.tracks.push_back({static_cast<uint32_t>(joint), 0, TrackPath::kTranslation, Interpolation::kLinear, positions, values});
  bake(baked, kBall, 0.5f, [](const glm::vec3&) { return glm::vec3(-1, 0.5f, 0); });
  expect_same(Tracer(scene).render({0.5f}, small()), Tracer(baked).render({}, small()));
}

TEST(DeformedPicture, AMeshMayVanishAndComeBack) {
  Scene scene = ball_under_lamp();
  morph_by_axis(scene, kBall, [](const glm::vec3& p) { return -p; });  // to a point
  Scene without = ball_under_lamp();
  without.objects[kBall].geometry = {};
  Tracer tracer(scene);
  const Frame there = tracer.render({0.5f}, small());
  const Frame gone = tracer.render({1}, small());
  EXPECT_EQ(gone.combined, Tracer(without).render({}, small()).combined);
  expect_same(tracer.render({0.5f}, small()), there);
}

TEST(DeformedPicture, RigidObjectsKeepTheirArrays) {
  Scene scene = ball_under_lamp();
  morph_by_axis(scene, kBall, stretch);
  trace::World world(scene);
  world.pose({0.5f});
  EXPECT_EQ(world.objects()[kLamp].geometry, &scene.objects[kLamp].geometry);
  EXPECT_NE(world.objects()[kBall].geometry, &scene.objects[kBall].geometry);
}

}  // namespace
}  // namespace vitrine::test
