// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Light whose value a formula gives.
#include <gtest/gtest.h>

#include "host/trace/fresnel.h"
#include "tests/trace/measure.h"
#include "tests/trace/scenes.h"

namespace vitrine::test {
namespace {

constexpr double kPi = 3.14159265358979;

// A Lambert floor of the given albedo in y = 0, seen obliquely at the origin.
Scene floor_scene(float albedo) {
  Scene scene = scene_with_camera({0, 2, 3}, {0, 0, 0}, 0.5f);
  add_object(scene, make_quad({-10, 0, 10}, {20, 0, 0}, {0, 0, -20}), add_material(scene, lambert(glm::vec3(albedo))), "floor");
  return scene;
}
Laboratory::Radiance look_at_origin(const Scene& scene, const trace::PathSettings& settings = {}) {
  return Laboratory(scene, settings).look({0, 2, 3}, {0, -2, -3}, 32, 256);
}

// Irradiance at the origin (normal +Y) from the part x in [0, a], z in [0, b] of a parallel rectangle at height h, radiance 1.
double corner_irradiance(double a, double b, double h) {
  const double x = a / h, z = b / h;
  const double p = x / std::sqrt(1 + x * x), q = z / std::sqrt(1 + z * z);
  return 0.5 * (p * std::atan(z / std::sqrt(1 + x * x)) + q * std::atan(x / std::sqrt(1 + z * z)));
}

TEST(ClosedForm, RectangleLampLightsAFloor) {
  Scene scene = floor_scene(0.5f);
  add_object(scene, make_quad({-0.7f, 1.5f, -0.4f}, {1.4f, 0, 0}, {0, 0, 0.8f}), add_material(scene, lamp(glm::vec3(3))), "lamp");
  const double expected = 0.5 / kPi * 3 * 4 * corner_irradiance(0.7, 0.4, 1.5);
  for (const auto strategy :
       {trace::LightStrategy::kBoth, trace::LightStrategy::kLightsOnly, trace::LightStrategy::kScatteringOnly}) {
    trace::PathSettings settings;
    settings.strategy = strategy;
    EXPECT_ESTIMATE(look_at_origin(scene, settings).diffuse, expected, 1e-4);
  }
}

// As a ceiling's lamp lights the wall beside it: at a grazing angle, where sampled directions towards a lamp easily miss it.
TEST(ClosedForm, RectangleLampLightsAWallBesideIt) {
  // Irradiance as above, but from the part y in [0, a], z in [0, b] of a rectangle in the plane x = -h.
  const auto upright = [](double a, double b, double h) {
    const double d = std::sqrt(h * h + a * a);
    return 0.5 * (std::atan(b / h) - h / d * std::atan(b / d));
  };
  for (const float h : {0.06f, 0.2f, 0.4f}) {
    Scene scene = floor_scene(0.5f);
    add_object(scene, make_quad({-h, 0.5f, 0.5f}, {0, 0, -1}, {0, 1, 0}), add_material(scene, lamp(glm::vec3(3))), "lamp");
    const double expected = 0.5 / kPi * 3 * 2 * (upright(1.5, 0.5, h) - upright(0.5, 0.5, h));
    for (const auto strategy :
         {trace::LightStrategy::kBoth, trace::LightStrategy::kLightsOnly, trace::LightStrategy::kScatteringOnly}) {
      trace::PathSettings settings;
      settings.strategy = strategy;
      EXPECT_ESTIMATE(look_at_origin(scene, settings).diffuse, expected, 1e-3 * expected);
    }
  }
}

// However fine its mesh: many triangles make a tree of lights, which leaves out those that a point cannot see.
TEST(ClosedForm, LampInsideOfGlassIsCountedOnce) {
  const auto seen = [](int rows, bool straight) {
    Scene scene = floor_scene(0.5f);
    add_object(scene, make_sphere({0.3f, 1.5f, 0.2f}, 0.2f, rows), add_material(scene, lamp(glm::vec3(20))), "lamp");
    add_object(scene, make_sphere({0.3f, 1.5f, 0.2f}, 0.4f, 48), add_material(scene, clear_glass(1.5f, 0, 1)), "glass");
    trace::PathSettings settings;
    settings.straight_shadows = straight;
    return look_at_origin(scene, settings).diffuse;
  };
  const Estimate refracted = seen(48, false);
  for (const int rows : {12, 48}) {
    const Estimate straight = seen(rows, true);
    EXPECT_NEAR(straight.mean, refracted.mean, 0.08 * refracted.mean + 3 * std::hypot(straight.error, refracted.error)) << rows;
  }
}

TEST(ClosedForm, NoLightLeaksThroughACoverCloseToItsLamp) {
  for (const auto& [height, gap] : {std::pair(10.0f, 5e-4f), std::pair(100.0f, 5e-3f), std::pair(2.0f, 1e-4f)}) {
    Scene scene = floor_scene(0.5f);
    add_object(scene, make_quad({-1, height, -1}, {2, 0, 0}, {0, 0, 2}), add_material(scene, lamp(glm::vec3(100))), "lamp");
    Material black = lambert(glm::vec3(0));
    black.double_sided = true;
    add_object(scene, make_quad({-2, height - gap, -2}, {4, 0, 0}, {0, 0, 4}), add_material(scene, black), "cover");
    EXPECT_EQ(look_at_origin(scene).diffuse.mean, 0) << height << " m, " << gap << " m";
  }
}

TEST(ClosedForm, LampThatFacesAwayGivesNothingUnlessDoubleSided) {
  for (const bool double_sided : {false, true}) {
    Scene scene = floor_scene(0.5f);
    Material m = lamp(glm::vec3(3));
    m.double_sided = double_sided;
    add_object(scene, make_quad({-0.7f, 1.5f, 0.4f}, {1.4f, 0, 0}, {0, 0, -0.8f}), add_material(scene, m), "lamp");
    EXPECT_ESTIMATE(look_at_origin(scene).diffuse, double_sided ? 0.5 / kPi * 3 * 4 * corner_irradiance(0.7, 0.4, 1.5) : 0.0,
                    1e-4);
  }
}

TEST(ClosedForm, BallLampLightsAFloorAsAPointOfItsIntensity) {
  Scene scene = floor_scene(0.8f);
  add_object(scene, make_sphere({1, 2, 0}, 0.25f, 64), add_material(scene, lamp(glm::vec3(10))), "lamp");
  // Exact for a sphere wholly above the horizon: E = L pi r^2 cos / d^2. The mesh is inside its sphere: projected area
  // smaller by less than (pi / 64)^2.
  const double expected = 0.8 / kPi * 10 * kPi * 0.0625 * (2 / std::sqrt(5.0)) / 5;
  EXPECT_ESTIMATE(look_at_origin(scene).diffuse, expected, expected * 0.0025);
}

TEST(ClosedForm, PointLightFallsWithTheSquareOfTheDistance) {
  for (const float height : {1.0f, 2.0f, 4.0f}) {
    Scene scene = floor_scene(0.6f);
    Light light;
    light.intensity = glm::vec3(5);
    add_light(scene, light, {0, height, 0}, {0, -1, 0});
    EXPECT_ESTIMATE(look_at_origin(scene).diffuse, 0.6 / kPi * 5 / (height * height), 1e-5);
  }
}

TEST(ClosedForm, SunLightsByItsIlluminance) {
  Scene scene = floor_scene(0.6f);
  Light light;
  light.kind = LightKind::kDirectional;
  light.intensity = glm::vec3(2);
  add_light(scene, light, {0, 9, 0}, {0.6f, -0.8f, 0});
  EXPECT_ESTIMATE(look_at_origin(scene).diffuse, 0.6 / kPi * 2 * 0.8, 1e-5);
}

TEST(ClosedForm, SpotIsFullInsideItsInnerConeAndDarkOutsideItsOuter) {
  for (const bool at : {true, false}) {
    Scene scene = floor_scene(0.6f);
    Light light;
    light.kind = LightKind::kSpot;
    light.intensity = glm::vec3(5);
    light.inner_cone = 0.2f;
    light.outer_cone = 0.3f;
    add_light(scene, light, {0, 2, 0}, at ? glm::vec3(0, -1, 0) : glm::vec3(1, -1, 0));
    EXPECT_ESTIMATE(look_at_origin(scene).diffuse, at ? 0.6 / kPi * 5 / 4 : 0.0, 1e-5);
  }
}

TEST(ClosedForm, MirrorShowsExactlyItsTintOfWhatItReflects) {
  Scene scene = scene_with_camera({0, 0, 3}, {0, 0, 0}, 0.5f);
  Material sign = lambert(glm::vec3(0));
  sign.emissive = glm::vec3(2);
  add_object(scene, make_quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}), add_material(scene, metal(glm::vec3(0.5f), 0)), "mirror");
  add_object(scene, make_quad({9, -9, 9}, {-18, 0, 0}, {0, 18, 0}), add_material(scene, sign), "sign");
  const auto seen = Laboratory(scene).look({0.2f, 0.1f, 3}, {0, 0, -1}, 4, 16);
  EXPECT_FLOAT_EQ(static_cast<float>(seen.specular.mean), 1.0f);  // Schlick at normal incidence is the colour itself
  EXPECT_EQ(seen.specular.error, 0);
  EXPECT_EQ(seen.diffuse.mean, 0);
}

Material coated_lamp(float coat, float roughness) {
  Material m = lamp(glm::vec3(1));
  m.clearcoat = coat;
  m.clearcoat_roughness = roughness;
  m.double_sided = true;
  return m;
}

// KHR_materials_clearcoat: a coat dims what shines through it, the more the flatter it is looked at. Its layer `diffuse` stays
// the same from everywhere: textures hold it.
TEST(ClosedForm, ACoatDimsTheLampBelowIt) {
  for (const float degrees : {0.0f, 60.0f, 85.0f}) {
    Scene scene = scene_with_camera({0, 0, 5}, {0, 0, 0}, 0.5f);
    add_object(scene, make_quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}), add_material(scene, coated_lamp(0.7f, 0)), "lamp");
    const float a = glm::radians(degrees);
    const glm::vec3 from(std::sin(a), 0, std::cos(a));
    const double seen = 1 - 0.7 * (0.04 + 0.96 * trace::schlick_weight(from.z));
    const double mean = 1 - 0.7 * (0.04 + 0.96 / 21);
    const Laboratory laboratory(scene);
    EXPECT_ESTIMATE(laboratory.look(from, -from, 4, 16).sum, seen, 1e-5);
    const trace::Ray ray{from, -from};
    trace::Hit hit;
    ASSERT_TRUE(laboratory.world->intersect(ray, hit));
    const trace::LayeredEmission layers = laboratory.world->layered_emission_of(laboratory.world->surface_at(ray, hit));
    EXPECT_NEAR(layers.diffuse.r, mean, 1e-5);
    EXPECT_NEAR(layers.diffuse.r + layers.view.r, seen, 1e-5);
  }
}

// The light that leaves the coat is found by scattered rays and by sampling lights alike: else a room would be lit by more than
// its lamps show.
TEST(ClosedForm, ACoatedLampLightsAFloorHoweverItIsFound) {
  for (const float roughness : {0.0f, 0.4f}) {
    Scene scene = scene_with_camera({0, 2, 3}, {0, 0, 0}, 0.5f);
    add_object(scene, make_quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}), add_material(scene, lambert(glm::vec3(0.5f))), "floor");
    const int material = add_material(scene, coated_lamp(1, roughness));
    scene.images.push_back({"half", 1, 1, {128, 128, 128, 255}});
    scene.materials[static_cast<size_t>(material)].clearcoat_texture.image = 0;
    add_object(scene, make_quad({1.5f, 0.3f, -0.5f}, {1, 0, 0}, {0, 0, 1}), material, "lamp that is seen flatly");
    trace::PathSettings settings;
    settings.strategy = trace::LightStrategy::kScatteringOnly;
    const Estimate found = look_at_origin(scene, settings).diffuse;
    settings.strategy = trace::LightStrategy::kLightsOnly;
    const Estimate aimed = look_at_origin(scene, settings).diffuse;
    const Estimate both = look_at_origin(scene).diffuse;
    EXPECT_NEAR(found.mean, aimed.mean, 3 * std::hypot(found.error, aimed.error)) << "roughness " << roughness;
    EXPECT_NEAR(both.mean, aimed.mean, 3 * std::hypot(both.error, aimed.error)) << "roughness " << roughness;
    scene.materials[static_cast<size_t>(material)].clearcoat = 0;
    EXPECT_LT(aimed.mean, 0.9 * look_at_origin(scene).diffuse.mean);
  }
}

// KHR_materials_specular: the colour is that of reflections at normal incidence; towards grazing angles glass reflects all
// colours alike, and what it does not reflect goes through.
TEST(ClosedForm, GlassOfAnySpecularColourIsAMirrorAtGrazingAngles) {
  for (const float specular : {1.0f, 0.5f})
    for (const float color : {0.0f, 0.5f, 1.0f, 40.0f})
      for (const float degrees : {0.0f, 60.0f, 85.0f}) {
        SCOPED_TRACE(testing::Message() << "specular " << specular << ", colour " << color << ", " << degrees << " degrees");
        const float a = glm::radians(degrees), f0 = 0.04f, base = std::min(f0 * color, 1.0f);
        const float edge = (trace::fresnel_dielectric(std::cos(a), 1.5f) - f0) / (1 - f0);
        const double reflected = specular * (base + (1 - base) * edge);
        Material pane = clear_glass(1.5f, 0, 0);
        pane.specular = specular;
        pane.specular_color = glm::vec3(color);
        for (const float side : {1.0f, -1.0f}) {  // the light is before the pane, or behind it
          Scene scene = scene_with_camera({0, 0, 5}, {0, 0, 0}, 0.5f);
          add_object(scene, make_quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}), add_material(scene, pane), "pane");
          const int light = add_material(scene, lamp(glm::vec3(1)));
          add_object(scene, make_quad({side * 999, -999, side * 20}, {side * -1998, 0, 0}, {0, 1998, 0}), light, "light");
          const glm::vec3 from(std::sin(a), 0, std::cos(a));
          EXPECT_ESTIMATE(Laboratory(scene).look(from, -from, 16, 256).sum, side > 0 ? reflected : 1 - reflected, 1e-4);
        }
        Scene scene;
        scene.materials.push_back(pane);
        const glm::vec3 straight = trace::straight_transmittance(trace::Textures(scene), trace::prepare_materials(scene)[0], {},
                                                                 glm::vec3(1), std::cos(a), false);
        EXPECT_NEAR(straight.r, 1 - reflected, 1e-5) << "in shadows";
      }
}

// Beer-Lambert and both Fresnel interfaces with all inner reflections, at normal incidence.
TEST(ClosedForm, TintedSlabDarkensByItsThickness) {
  for (const float thickness : {0.1f, 0.5f, 1.0f}) {
    Scene scene = scene_with_camera({0, 0, 5}, {0, 0, 0}, 0.5f);
    set_environment(scene, glm::vec3(1));
    Material glass = clear_glass(1.5f, 0, 1);
    glass.attenuation_color = glm::vec3(0.4f);
    glass.attenuation_distance = 0.5f;
    // Rays at normal incidence never reach the sides. (A larger box has larger ray offsets, which shorten the way inside.)
    add_object(scene, make_box({-2, -2, -thickness}, {2, 2, 0}), add_material(scene, glass), "slab");
    const double r = 0.04, t = std::pow(0.4, thickness / 0.5);
    const double through = (1 - r) * (1 - r) * t / (1 - r * r * t * t);
    const double back = r + (1 - r) * (1 - r) * r * t * t / (1 - r * r * t * t);
    EXPECT_ESTIMATE(Laboratory(scene).look({0.2f, 0.1f, 3}, {0, 0, -1}, 16, 256).sum, through + back, 1e-4);
  }
}

// Light goes straight through glass in front of a lamp, losing what the interfaces reflect and the medium absorbs.
TEST(ClosedForm, ShadowOfASlabIsItsTransmittance) {
  Scene scene = floor_scene(0.6f);
  Light light;
  light.intensity = glm::vec3(5);
  add_light(scene, light, {0, 2, 0}, {0, -1, 0});
  Material glass = clear_glass(1.5f, 0, 1);
  glass.attenuation_color = glm::vec3(0.4f);
  glass.attenuation_distance = 0.5f;
  glass.base_color = glm::vec4(glm::vec3(0.9f), 1);
  add_object(scene, make_box({-0.2f, 1, -0.2f}, {0.2f, 1.25f, 0.2f}), add_material(scene, glass), "slab");
  const double interfaces = std::pow(0.96 * 0.9, 2), medium = std::pow(0.4, 0.5);
  trace::PathSettings settings;
  const auto seen = Laboratory(scene, settings).look({0, 0.5f, 1}, {0, -0.5f, -1}, 32, 256).diffuse;
  // Beyond the formula: light of the floor that the slab mirrors back, 4 % of a form factor of 0.05.
  const double expected = 0.6 / kPi * 5 / 4 * interfaces * medium;
  EXPECT_ESTIMATE(seen, expected, 0.002 * expected);
}

TEST(ClosedForm, HalfTransparentSheetLetsHalfOfTheLightThrough) {
  Scene scene = floor_scene(0.6f);
  Light light;
  light.intensity = glm::vec3(5);
  add_light(scene, light, {0, 2, 0}, {0, -1, 0});
  Material sheet = lambert(glm::vec3(0));
  sheet.base_color.a = 0.25f;
  sheet.alpha_mode = AlphaMode::kBlend;
  sheet.double_sided = true;
  add_object(scene, make_quad({-0.2f, 1, -0.2f}, {0, 0, 0.4f}, {0.4f, 0, 0}), add_material(scene, sheet), "sheet");
  EXPECT_ESTIMATE(Laboratory(scene).look({0, 0.5f, 1}, {0, -0.5f, -1}, 32, 256).diffuse, 0.75 * 0.6 / kPi * 5 / 4, 1e-4);
}

TEST(ClosedForm, WhatIsSeenThroughASheetBelongsToTheSheet) {
  Scene scene = scene_with_camera({0, 0, 3}, {0, 0, 0}, 0.5f);
  set_environment(scene, glm::vec3(2));
  Material sheet = lambert(glm::vec3(0));
  sheet.base_color.a = 0.25f;
  sheet.alpha_mode = AlphaMode::kBlend;
  add_object(scene, make_quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}), add_material(scene, sheet), "sheet");
  const auto seen = Laboratory(scene).look({0.2f, 0.1f, 3}, {0, 0, -1}, 16, 256);
  EXPECT_ESTIMATE(seen.specular, 1.5, 1e-4);
  EXPECT_EQ(seen.diffuse.mean, 0);
}

TEST(ClosedForm, HolesAndPanesShowTheBackgroundAndMirrorsTheEnvironment) {
  Scene scene = scene_with_camera({0, 0, 3}, {0, 0, 0}, 0.5f);
  set_environment(scene, glm::vec3(2));
  scene.background_is_environment = false;
  scene.background_color = glm::vec3(0.5f);
  Material hole = lambert(glm::vec3(1));
  hole.alpha_mode = AlphaMode::kMask;
  hole.base_color.a = 0;
  Material pane = clear_glass(1, 0, 0);  // of no index: nothing is reflected
  const int material = add_material(scene, hole);
  add_object(scene, make_quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}), material, "front");
  Object backdrop;
  backdrop.name = "background";
  backdrop.follows_camera = true;
  scene.objects.push_back(backdrop);
  scene.background_object = 1;
  const auto seen = [&](const Material& m) {
    scene.materials[static_cast<size_t>(material)] = m;
    return Laboratory(scene).look({0.2f, 0.1f, 3}, {0, 0, -1}, 4, 16).sum.mean;
  };
  EXPECT_NEAR(seen(hole), 0.5, 1e-6);
  EXPECT_NEAR(seen(pane), 0.5, 1e-6);
  EXPECT_NEAR(seen(metal(glm::vec3(1), 0)), 2, 1e-6);
}

TEST(ClosedForm, SingleSidedWallIsNotThereFromBehind) {
  for (const bool double_sided : {false, true}) {
    Scene scene = scene_with_camera({0, 0, 3}, {0, 0, 0}, 0.5f);
    set_environment(scene, glm::vec3(2));
    Material wall = lambert(glm::vec3(0));
    wall.double_sided = double_sided;
    add_object(scene, make_quad({-1, -1, 0}, {0, 2, 0}, {2, 0, 0}), add_material(scene, wall), "wall");  // faces -Z
    const Laboratory laboratory(scene);
    trace::Sampler sampler(0, 0, 0, 0);
    const auto sample = laboratory.integrator.trace({{0.2f, 0.1f, 3}, {0, 0, -1}}, sampler);
    EXPECT_EQ(sample.object, double_sided ? 0 : -1);
    EXPECT_EQ(sample.diffuse.x, double_sided ? 0 : 2);
  }
}

// A map with one bright patch: both strategies agree with each other, and with the patch's irradiance.
TEST(ClosedForm, EnvironmentMapLightsAFloorByItsIrradiance) {
  Scene scene = floor_scene(0.5f);
  scene.environment.width = 64;
  scene.environment.height = 32;
  scene.environment.radiance.assign(64 * 32, glm::vec3(0.1f));
  for (int y = 3; y < 8; ++y) {
    for (int x = 20; x < 26; ++x) scene.environment.radiance[static_cast<size_t>(64 * y + x)] = glm::vec3(40);
  }
  double irradiance = 0;
  constexpr int kRings = 400, kSectors = 800;
  for (int i = 0; i < kRings; ++i) {
    const double s2 = (i + 0.5) / kRings, s = std::sqrt(s2), c = std::sqrt(1 - s2);
    for (int j = 0; j < kSectors; ++j) {
      const double phi = 2 * kPi * (j + 0.5) / kSectors;
      irradiance += scene.environment.lookup({s * std::cos(phi), c, s * std::sin(phi)}).x * kPi / (kRings * kSectors);
    }
  }
  for (const auto strategy : {trace::LightStrategy::kBoth, trace::LightStrategy::kScatteringOnly}) {
    trace::PathSettings settings;
    settings.strategy = strategy;
    EXPECT_ESTIMATE(look_at_origin(scene, settings).diffuse, 0.5 / kPi * irradiance, 1e-3 * irradiance);
  }
}

}  // namespace
}  // namespace vitrine::test
