// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Materials at a point: textures where files go to extremes, and what rays in a straight line meet.
#include <gtest/gtest.h>

#include <cmath>

#include "host/trace/fresnel.h"
#include "host/trace/shading_material.h"
#include "host/trace/texture.h"
#include "tests/trace/measure.h"
#include "tests/trace/scenes.h"

namespace vitrine::test {
namespace {

// One row of texels, black but for the first, the middle and the last.
Scene scene_with_row(int width) {
  Scene scene;
  Image row;
  row.width = width;
  row.height = 1;
  row.rgba.assign(4 * static_cast<size_t>(width), 0);
  row.rgba[0] = 51;
  row.rgba[4 * static_cast<size_t>(width / 2)] = 102;
  row.rgba[4 * static_cast<size_t>(width - 1)] = 255;
  scene.images.push_back(row);
  return scene;
}

float red_at(const Scene& scene, Wrap wrap, float u) {
  TextureRef ref;
  ref.image = 0;
  ref.nearest = true;
  ref.wrap_s = ref.wrap_t = wrap;
  return trace::Textures(scene).linear(ref, {{glm::vec2(u, 0), glm::vec2(0)}, {}}).r;
}

TEST(Texture, FarCoordinatesShowWhatTheWrapModeSays) {
  const Scene scene = scene_with_row(16384);
  for (const float far : {5e5f, 3e6f, 1e30f}) {
    EXPECT_FLOAT_EQ(red_at(scene, Wrap::kClamp, far), 1.0f) << far;
    EXPECT_FLOAT_EQ(red_at(scene, Wrap::kClamp, -far), 0.2f) << far;
    EXPECT_FLOAT_EQ(red_at(scene, Wrap::kRepeat, far), 0.2f) << far;
  }
  EXPECT_FLOAT_EQ(red_at(scene, Wrap::kRepeat, 500000.5f), 0.4f);
  EXPECT_FLOAT_EQ(red_at(scene, Wrap::kMirror, 500001.0f), 1.0f);
}

// Alternating columns of black and white sRGB.
Scene scene_with_stripes(int size) {
  Scene scene;
  Image stripes{"stripes", size, size, {}};
  for (int i = 0; i < size * size; ++i) {
    const uint8_t c = i % 2 ? 255 : 0;
    stripes.rgba.insert(stripes.rgba.end(), {c, c, c, 255});
  }
  scene.images.push_back(stripes);
  Material m;
  m.base_color_texture.image = 0;
  scene.materials.push_back(m);
  return scene;
}

TEST(Texture, MinifiedStripesAreTheMeanOfTheirLightAndNotOfTheirCodes) {
  const Scene scene = scene_with_stripes(64);
  const trace::Textures textures(scene);
  const TextureRef& ref = scene.materials[0].base_color_texture;
  for (const float texels : {2.0f, 5.0f, 64.0f, 1e4f}) {
    const float side = texels / 64;
    EXPECT_NEAR(textures.srgb(ref, {{glm::vec2(0.3f, 0.6f), glm::vec2(0)}, {glm::vec2(side * side), glm::vec2(0)}}).r, 0.5f,
                0.005f)
        << texels;
  }
  EXPECT_FLOAT_EQ(textures.srgb(ref, {{glm::vec2(0.5f / 64, 0.6f), glm::vec2(0)}, {}}).r, 0.0f);
}

// Planks, hair, brushed metal: what is repeated often along its grain must not be blurred across it, however it is turned.
TEST(Texture, RepeatedManyTimesOneWayItStaysSharpTheOtherWay) {
  Scene scene = scene_with_camera({0, 0, 5}, {0, 0, 0}, 0.5f);
  Image stripes{"stripes", 256, 256, {}};  // of 8 rows
  for (int i = 0; i < 256 * 256; ++i) {
    const uint8_t c = i / 256 / 8 % 2 ? 255 : 0;
    stripes.rgba.insert(stripes.rgba.end(), {c, c, c, 255});
  }
  scene.images.push_back(stripes);
  const int material = add_material(scene, lambert(glm::vec3(1)));
  add_object(scene, make_quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}), material, "board");
  TextureRef& ref = scene.materials[0].base_color_texture;
  ref.image = 0;
  for (const float turned : {0.0f, 0.7f})
    for (const float repeats : {1.0f, 16.0f, 256.0f}) {
      ref.transform = glm::mat3(1);
      ref.transform[0] = {repeats * std::cos(turned), repeats * std::sin(turned), 0};
      ref.transform[1] = {-std::sin(turned), std::cos(turned), 0};
      const Laboratory laboratory(scene);
      int looked = 0;
      for (int i = 0; i < 40; ++i) {
        trace::Ray ray{{0.03f * static_cast<float>(i) - 0.6f, 0.041f * static_cast<float>(i) - 0.8f, 5}, {0, 0, -1}};
        ray.width = 2.0f / 256;
        trace::Hit hit;
        ASSERT_TRUE(laboratory.world->intersect(ray, hit));
        const trace::Surface s = laboratory.world->surface_at(ray, hit);
        const float v = (ref.transform * glm::vec3(s.point.uv[0], 1)).y;
        const int stripe = static_cast<int>(std::floor(v * 32));
        if (std::fabs(v * 32 - static_cast<float>(stripe) - 0.5f) > 0.3f) continue;  // near an edge
        ++looked;
        EXPECT_NEAR(trace::base_color_at(laboratory.world->textures(), *s.material, s.point).r, stripe % 2 ? 1 : 0, 0.01f)
            << repeats << " times, turned by " << turned;
      }
      EXPECT_GT(looked, 5);
    }
}

TEST(Texture, CutOutsKeepTheirEdgesHoweverFarTheyAre) {
  Scene scene = scene_with_stripes(64);
  for (size_t i = 0; i < scene.images[0].rgba.size(); i += 4) scene.images[0].rgba[i + 3] = scene.images[0].rgba[i];
  scene.materials[0].alpha_mode = AlphaMode::kMask;
  const trace::Textures textures(scene);
  const std::vector<trace::ShadingMaterial> prepared = trace::prepare_materials(scene);
  for (const float u : {0.5f / 64, 1.5f / 64}) {
    trace::SurfacePoint point;
    point.uv[0] = {u, 0.6f};
    point.footprint[0] = glm::vec2(1);
    const float alpha = trace::alpha_at(prepared[0], trace::base_color_at(textures, prepared[0], point));
    EXPECT_EQ(alpha, u > 1.0f / 64 ? 1 : 0);
  }
}

// glTF's metallicFactor is 1 by default: that nothing of the glass is metal, its texture may say alone.
TEST(Texture, GlassWhoseTextureSaysThatItIsNoMetalIsAsSolidAsAnyOther) {
  Scene scene = scene_with_camera({0, 0, 5}, {0, 0, 0}, 0.5f);
  set_environment(scene, glm::vec3(1));
  scene.images.push_back({"no metal", 1, 1, {0, 0, 0, 255}});
  Material glass = clear_glass(1.5f, 0, 1);
  glass.metallic = 1;
  glass.metallic_roughness_texture.image = 0;
  glass.attenuation_color = glm::vec3(0.4f);
  glass.attenuation_distance = 0.5f;
  add_object(scene, make_box({-2, -2, -0.5f}, {2, 2, 0}), add_material(scene, glass), "slab");
  const double r = 0.04, t = 0.4;  // as ClosedForm.TintedSlabDarkensByItsThickness
  const double through = (1 - r) * (1 - r) * t / (1 - r * r * t * t);
  const double back = r + (1 - r) * (1 - r) * r * t * t / (1 - r * r * t * t);
  EXPECT_ESTIMATE(Laboratory(scene).look({0.2f, 0.1f, 3}, {0, 0, -1}, 16, 256).sum, through + back, 1e-4);
}

// The light that goes straight through a pane is what its reflection leaves, and a texture may take all of that away.
TEST(StraightLight, ShadowOfAPaneKnowsItsSpecularTextures) {
  for (const bool by_color : {false, true}) {
    Scene scene = scene_with_camera({0, 0.5f, 1}, {0, 0, 0}, 0.5f);
    add_object(scene, make_quad({-5, 0, 5}, {10, 0, 0}, {0, 0, -10}), add_material(scene, lambert(glm::vec3(0.6f))), "floor");
    Light light;
    light.intensity = glm::vec3(5);
    add_light(scene, light, {0, 2, 0}, {0, -1, 0});
    Image none;
    none.width = none.height = 1;
    none.rgba = {0, 0, 0, 0};
    scene.images.push_back(none);
    Material pane = clear_glass(1.5f, 0, 0);
    pane.double_sided = true;
    (by_color ? pane.specular_color_texture : pane.specular_texture).image = 0;
    add_object(scene, make_quad({-0.2f, 1, 0.2f}, {0.4f, 0, 0}, {0, 0, -0.4f}), add_material(scene, pane), "pane");
    EXPECT_ESTIMATE(Laboratory(scene).look({0, 0.5f, 1}, {0, -0.5f, -1}, 32, 256).diffuse, 0.6 / trace::kPi * 5 / 4, 1e-4);
  }
}

// glTF writes infinity as an index of 0: light in such glass must be scaled by no division by it.
TEST(Glass, AnIndexOfZeroIsALargeOneForAllThatAsk) {
  Scene scene;
  for (const float ior : {0.0f, 1.0f, 1.7f}) scene.materials.push_back(clear_glass(ior, 0.3f, 1));
  const std::vector<trace::ShadingMaterial> prepared = trace::prepare_materials(scene);
  EXPECT_GE(prepared[0].ior, 1000);
  EXPECT_TRUE(std::isfinite(prepared[0].ior));
  EXPECT_EQ(prepared[1].ior, 1);
  EXPECT_EQ(prepared[2].ior, 1.7f);
  for (const trace::ShadingMaterial& m : prepared) EXPECT_EQ(m.ior, m.parameters.ior);
}

// A thin pane has no inside: light passes it from either side alike, at grazing angles too.
TEST(StraightLight, ShadowOfAPaneDoesNotDependOnTheWayItFaces) {
  Scene scene;
  scene.materials.push_back(clear_glass(1.5f, 0, 0));
  const std::vector<trace::ShadingMaterial> prepared = trace::prepare_materials(scene);
  const trace::Textures textures(scene);
  for (const float cosine : {1.0f, 0.3f, 0.1f}) {
    const auto passed = [&](bool back) {
      return trace::straight_transmittance(textures, prepared[0], {}, glm::vec3(1), cosine, back).r;
    };
    EXPECT_EQ(passed(true), passed(false)) << cosine;
    EXPECT_NEAR(passed(true), 1 - trace::fresnel_dielectric(cosine, 1.5f), 1e-6f) << cosine;
  }
}

}  // namespace
}  // namespace vitrine::test
