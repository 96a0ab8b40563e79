// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/infer/fields.h"

#include <gtest/gtest.h>

#include "host/base/field_blocks.h"
#include "host/infer/geometry_states.h"
#include "host/infer/parameterization.h"
#include "tests/infer/test_scene.h"

namespace vitrine::testing {
namespace {

constexpr AxisMask kView = 1, kLamp = 2;

// Axis 1 lifts the node of object `object` by `height`.
void lift_with_lamp(Scene& scene, size_t object, float height) {
  scene.nodes.push_back({});
  scene.objects[object].node = static_cast<int>(scene.nodes.size()) - 1;
  scene.track_data.push_back({0, 1});
  scene.track_data.push_back({0, 10, 0, 0, 10 + height, 0});
  const auto n = scene.track_data.size();
  scene.tracks.clear();  // spans of the orbit's track moved with the data
  scene.tracks.push_back({1, 0, TrackPath::kRotation, Interpolation::kLinear, scene.track_data[0], scene.track_data[1]});
  scene.tracks.push_back({static_cast<uint32_t>(scene.objects[object].node), 1, TrackPath::kTranslation, Interpolation::kLinear,
                          scene.track_data[n - 2], scene.track_data[n - 1]});
}

TEST(Fields, DiffuseDoesNotDependOnTheView) {
  const auto scene = make_ball_on_board();
  EXPECT_EQ(field_axes(*scene, scene->objects[0], Layer::kDiffuse), kLamp);
  EXPECT_EQ(field_axes(*scene, scene->objects[0], Layer::kSpecular), kView | kLamp);
}

TEST(Fields, AnAxisWithOneSampleDoesNotCount) {
  const auto scene = make_ball_on_board({.views = 4, .lamps = 1});
  EXPECT_EQ(field_axes(*scene, scene->objects[0], Layer::kSpecular), kView);
}

TEST(Fields, UnlitObjectsAndTheBackdropDependOnNoLamp) {
  const auto scene = make_ball_on_board();
  scene->objects[1].follows_camera = true;
  EXPECT_EQ(field_axes(*scene, scene->objects[1], Layer::kDiffuse), 0u);
  scene->materials[0].unlit = true;
  EXPECT_EQ(field_axes(*scene, scene->objects[0], Layer::kDiffuse), 0u);
  scene->objects[0].emission_axis = 1;
  EXPECT_EQ(field_axes(*scene, scene->objects[0], Layer::kDiffuse), kLamp);
}

TEST(Fields, AnAxisThatMovesTheCameraAndAnObjectCountsForLight) {
  const auto scene = make_ball_on_board();
  scene->objects[0].node = 1;  // the ball turns with the camera
  EXPECT_EQ(field_axes(*scene, scene->objects[1], Layer::kDiffuse), kView | kLamp);
}

Field field_over(const Scene& scene, AxisMask axes) {
  Field field;
  field.axes = axes;
  field.space = scene.space().restricted(axes);
  field.block_size = block_size_of(field.space);
  field.maps.resize(1);
  return field;
}

TEST(Fields, GroupsHoldEveryTextureOnceAndShareTheirStates) {
  const auto scene = make_ball_on_board({.views = 4, .lamps = 6});
  const StateTable states = make_states(scene->space(), kView);
  ASSERT_EQ(states.samples_of_state.size(), 4u);
  const auto diffuse = make_groups(scene->space(), field_over(*scene, kLamp), 0, states, 4);
  ASSERT_EQ(diffuse.size(), 2u);
  EXPECT_EQ(diffuse[0].textures.size() + diffuse[1].textures.size(), 6u);
  EXPECT_EQ(diffuse[0].uses.size(), 4u);
  const auto specular = make_groups(scene->space(), field_over(*scene, kView | kLamp), 0, states, 4);
  EXPECT_EQ(specular.size(), 8u);
  for (const SolveGroup& group : specular) EXPECT_EQ(group.uses.size(), 1u);
}

TEST(BetweenSamples, LieHalfWayAlongAxesThatMoveTheCameraAlone) {
  const auto scene = make_ball_on_board({.views = 4, .lamps = 2});
  auto between = between_samples(*scene);
  ASSERT_EQ(between.size(), 6u);  // none beyond the ends, none from lamp to lamp
  EXPECT_EQ(between[1].axis, 0);
  EXPECT_NEAR(between[1].position[0], 1.0 / 6, 1e-6);
  EXPECT_EQ(between[1].position[1], 1);
  EXPECT_EQ(between[1].beside, (std::array<int64_t, 2>{1, 3}));
  scene->axes[0].shape.kind = AxisKind::kPeriodic;
  between = between_samples(*scene);
  ASSERT_EQ(between.size(), 8u);
  EXPECT_NEAR(between[7].position[0], 7.0 / 8, 1e-6);
  EXPECT_EQ(between[7].beside, (std::array<int64_t, 2>{7, 1}));
  scene->objects[0].node = 1;  // the ball turns with the camera
  EXPECT_TRUE(between_samples(*scene).empty());
}

TEST(BetweenSamples, ServeTheTexturesBesideThemThatDependOnTheirAxis) {
  const auto scene = make_ball_on_board({.views = 4, .lamps = 2});
  const Pose pose = pose_scene(*scene, {});
  const std::vector<DrawnObject> objects{make_drawn_object(*scene, 0, world_from_object(*scene, pose, 0))};
  const GeometryStates geometry = make_geometry_states(*scene, geometry_axes(*scene), objects, 4.0f / 3, between_samples(*scene));
  EXPECT_EQ(geometry.table.grid_states, 4);
  ASSERT_EQ(geometry.states.size(), 7u);
  EXPECT_EQ(geometry.table.samples_of_state[4], (std::vector<int64_t>{8, 9}));
  for (const SolveGroup& group : make_groups(scene->space(), field_over(*scene, kLamp), 0, geometry.table, 4))
    EXPECT_EQ(group.uses.size(), 4u);
  const auto specular = make_groups(scene->space(), field_over(*scene, kView | kLamp), 0, geometry.table, 4);
  ASSERT_EQ(specular.size(), 4u);  // two lamps each
  for (const SolveGroup& group : specular) {
    const int64_t view = group.textures[0] / 2;
    ASSERT_EQ(group.uses.size(), view == 0 || view == 3 ? 2u : 3u);
    EXPECT_EQ(group.uses[0].state, view);
    for (size_t u = 1; u < group.uses.size(); ++u) EXPECT_NEAR(group.uses[u].state - 4, static_cast<double>(view) - 0.5, 0.5);
  }
}

TEST(Fields, TexturesThatLieDifferentlyAreNotSolvedTogether) {
  const auto scene = make_ball_on_board({.views = 4, .lamps = 6});
  const StateTable states = make_states(scene->space(), kView);
  Field field = field_over(*scene, kLamp);
  field.block_size = {1, 2};
  field.maps.resize(3);
  field.block_maps = {2, 0, 1};
  const auto groups = make_groups(scene->space(), field, 0, states, 4);
  ASSERT_EQ(groups.size(), 3u);
  for (const SolveGroup& group : groups)
    for (const int64_t texture : group.textures) EXPECT_EQ(group.map, field.block_maps[static_cast<size_t>(texture / 2)]);
}

TEST(GeometryStates, WhatMovesOutsideThePictureMakesNoStates) {
  const auto scene = make_ball_on_board();
  lift_with_lamp(*scene, 0, 1);
  const Pose pose = pose_scene(*scene, {});
  std::vector<DrawnObject> objects;
  for (int i = 0; i < 2; ++i) objects.push_back(make_drawn_object(*scene, i, world_from_object(*scene, pose, i)));
  const GeometryStates all = make_geometry_states(*scene, geometry_axes(*scene), objects, 4.0f / 3);
  EXPECT_EQ(all.states.size(), 8u);
  EXPECT_FALSE(may_be_seen(objects[0], 0, all.states));  // ten metres up
  EXPECT_TRUE(may_be_seen(objects[1], 1, all.states));
  objects.erase(objects.begin());
  const GeometryStates seen = make_geometry_states(*scene, geometry_axes(*scene), objects, 4.0f / 3);
  ASSERT_EQ(seen.states.size(), 4u);
  for (const auto& samples : seen.table.samples_of_state) EXPECT_EQ(samples.size(), 2u);
}

}  // namespace
}  // namespace vitrine::testing
