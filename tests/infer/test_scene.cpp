// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "tests/infer/test_scene.h"

#include <cmath>
#include <cstdlib>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>
#include <numbers>

#include "host/infer/fields.h"
#include "host/infer/geometry_states.h"
#include "host/infer/parameterization.h"
#include "host/infer/pyramid.h"
#include "host/scene/shapes.h"
#include "target/draw/resolve.h"

namespace vitrine::testing {
namespace {

constexpr int kTruthSize = 256;

Geometry make_board() {
  Geometry g;
  const int n = 4;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) {
      const glm::vec2 t(static_cast<float>(i) / n, static_cast<float>(j) / n);
      g.positions.emplace_back(4 * t.x - 2, -1, 4 * t.y - 2);
      g.normals.emplace_back(0, 1, 0);
      g.texcoords[0].push_back(t);
    }
  for (uint32_t j = 0; j < n; ++j)
    for (uint32_t i = 0; i < n; ++i) {
      const uint32_t a = j * (n + 1) + i, b = a + 1, c = a + n + 1, d = c + 1;
      g.indices.insert(g.indices.end(), {a, c, d, a, d, b});
    }
  return g;
}

void add_object(Scene& scene, const char* name, Geometry geometry, int node) {
  Object object;
  object.name = name;
  object.node = node;
  object.geometry = std::move(geometry);
  object.geometry.triangle_materials.assign(object.geometry.indices.size() / 3, 0);
  scene.objects.push_back(std::move(object));
}

// Axis 0 turns node 1, which carries the camera (node 2), by up to 40 degrees.
void add_orbit(Scene& scene) {
  const glm::quat end = glm::angleAxis(std::numbers::pi_v<float> * 40 / 180, glm::vec3(0, 1, 0));
  scene.track_data.push_back({0, 1});
  scene.track_data.push_back({0, 0, 0, 1, end.x, end.y, end.z, end.w});
  scene.tracks.push_back({1, 0, TrackPath::kRotation, Interpolation::kLinear, scene.track_data[0], scene.track_data[1]});
}

hal::Texture upload_truth(hal::Gpu& gpu, SceneDrawer& drawer, int object, const std::function<glm::vec3(glm::vec2)>& color) {
  const Pyramid pyramid(kTruthSize, kTruthSize);
  std::vector<glm::vec4> texels;
  for (const Pyramid::Level& level : pyramid.levels())
    for (int y = 0; y < level.height; ++y)
      for (int x = 0; x < level.width; ++x)
        texels.emplace_back(color((glm::vec2(x, y) + 0.5f) / glm::vec2(level.width, level.height)),
                            static_cast<float>(object + 1));
  return create_pyramid_texture(gpu, drawer, pyramid, hal::TextureFormat::kRgba32f, std::as_bytes(std::span(texels)));
}

// One layer of all objects from a supersampled picture whose alpha names the object.
void resolve_layer(const std::vector<glm::vec4>& samples, const InferenceOptions& o, Layer layer, Frame& frame) {
  const ResolveTaps taps = resolve_taps(o.supersampling);
  const int columns = o.width * o.supersampling, rows = o.height * o.supersampling;
  for (int y = 0; y < o.height; ++y)
    for (int x = 0; x < o.width; ++x) {
      const size_t p = static_cast<size_t>(y * o.width + x);
      std::vector<glm::vec4> sums(frame.objects.size());
      float weights = 0;
      for (int j = 0; j < taps.count; ++j)
        for (int i = 0; i < taps.count; ++i) {
          const int sx = x * o.supersampling + taps.first + i, sy = y * o.supersampling + taps.first + j;
          if (sx < 0 || sy < 0 || sx >= columns || sy >= rows) continue;
          const glm::vec4& s = samples[static_cast<size_t>((rows - 1 - sy) * columns + sx)];
          const float w = taps.weight[static_cast<size_t>(i)] * taps.weight[static_cast<size_t>(j)];
          weights += w;
          if (s.w > 0.5f) sums[static_cast<size_t>(s.w + 0.5f) - 1] += w * glm::vec4(glm::vec3(s), 1);
        }
      for (size_t k = 0; k < sums.size(); ++k) {
        frame.objects[k].coverage[p] = sums[k].w / weights;
        const glm::vec3 value = sums[k].w > 0 ? glm::vec3(sums[k]) / sums[k].w : glm::vec3(0);
        (layer == Layer::kDiffuse ? frame.objects[k].diffuse : frame.objects[k].specular)[p] = value;
        frame.combined[p] += glm::vec3(sums[k]) / weights;
      }
    }
}

}  // namespace

std::unique_ptr<hal::Gpu> make_gpu() {
  auto gpu = hal::create_osmesa_gpu(16, 16);
  return gpu.ok() ? std::move(gpu.value()) : nullptr;
}

std::unique_ptr<Scene> make_ball_on_board(const SceneShape& shape) {
  auto scene = std::make_unique<Scene>();
  scene->nodes.resize(4);
  scene->nodes[2].parent = 1;
  scene->nodes[2].translation = {0, 0.9f, 5};
  scene->nodes[2].rotation = glm::angleAxis(-0.2f, glm::vec3(1, 0, 0));
  scene->camera.node = 2;
  scene->camera.near_distance = 0.5f;
  scene->camera.far_distance = 50;
  scene->materials.resize(1);
  add_object(*scene, "ball", make_sphere(1, 32, 16), 0);
  add_object(*scene, "board", make_board(), 3);
  scene->axes.push_back({"view", {AxisKind::kLinear, shape.views}, 0.25f, {}});
  scene->axes.push_back({"lamp", {AxisKind::kDiscrete, shape.lamps}, 0.25f, {}});
  add_orbit(*scene);
  return scene;
}

ShownObjects board_and_card(int board_width, int board_height, int card_width, int card_height) {
  DrawnObject board, card;
  board.vertices = {{-2, -1, 1, 0, 0}, {2, -1, 1, 1, 0}, {2, -1, -14, 1, 1}, {-2, -1, -14, 0, 1}};
  board.indices = {0, 1, 2, 0, 2, 3};
  card.vertices = {{-0.5f, -0.9f, 0, 0, 0}, {0.6f, -0.8f, 0, 1, 0}, {0.5f, 0.4f, -0.4f, 0.9f, 1}};
  card.indices = {0, 1, 2};
  const PatchMap turned{{0, 0}, glm::mat2(0.9f, 0.2f, -0.25f, 0.8f), {0.1f, -0.02f}};
  const PatchMap beyond{{0, 0}, glm::mat2(1.2f, 0, 0, 1), {-0.1f, 0}};  // the texture ends before the card does
  return {{board, card}, {{board_width, board_height}, {card_width, card_height}}, {turned, beyond}};
}

GeometryState looking_down(const ShownObjects& shown, float aspect, float height) {
  const glm::mat4 clip = glm::perspective(0.9f, aspect, 0.1f, 50.0f) *
                         glm::lookAt(glm::vec3(0.3f, height, 3), glm::vec3(0, -0.5f, 0), glm::vec3(0, 1, 0));
  const size_t count = shown.objects.size();
  return {std::vector<glm::mat4>(count, clip), std::vector<uint8_t>(count, 0), shown.maps};
}

Truth smooth_truth() {
  const auto wave = [](float a) { return 0.5f + 0.4f * std::sin(a); };
  return {[wave](int object, glm::vec2 uv, int lamp) {
            const float a = static_cast<float>(object), l = static_cast<float>(lamp);
            return glm::vec3(wave(9 * uv.x + a + l), wave(11 * uv.y + 2 * a), wave(7 * (uv.x + uv.y) + l)) * 0.7f;
          },
          [wave](int object, glm::vec2 uv, float view, int lamp) {
            if (object == 1) return glm::vec3(0);
            const float l = static_cast<float>(lamp);
            return glm::vec3(0.3f * wave(8 * uv.x + 0.7f * view) * wave(6 * uv.y - l));
          }};
}

ScratchStore::ScratchStore() {
  std::string pattern = (std::filesystem::temp_directory_path() / "vitrine-infer-XXXXXX").string();
  path_ = mkdtemp(pattern.data());
  store_ = std::make_unique<Store>(path_);
}
ScratchStore::~ScratchStore() { std::filesystem::remove_all(path_); }

std::vector<StoreKey> draw_frames(const Scene& scene, const Truth& truth, const InferenceOptions& o, hal::Gpu& gpu,
                                  const Store& store) {
  const ParameterSpace space = scene.space();
  std::vector<Position> positions;
  for (int64_t i = 0; i < space.sample_count(); ++i) positions.push_back(space.position_of(space.index_from_flat(i)));
  return draw_frames_at(scene, truth, positions, o, gpu, store);
}

std::vector<StoreKey> draw_frames_at(const Scene& scene, const Truth& truth, const std::vector<Position>& positions,
                                     const InferenceOptions& o, hal::Gpu& gpu, const Store& store) {
  const ParameterSpace space = scene.space();
  const Pose pose = pose_scene(scene, space.position_of({}));
  std::vector<DrawnObject> objects;
  for (int i = 0; i < static_cast<int>(scene.objects.size()); ++i)
    objects.push_back(make_drawn_object(scene, i, world_from_object(scene, pose, i)));
  TestRenderer renderer(gpu, o, objects);
  std::vector<glm::vec4> samples(static_cast<size_t>(renderer.width() * renderer.height()));
  std::vector<StoreKey> keys;
  for (const Position& position : positions) {
    const float view = space.sample_coordinate(0, position[0]);
    const int lamp = space.nearest_sample(position)[1];
    const size_t pixels = static_cast<size_t>(o.width * o.height);
    Frame frame{o.width, o.height, std::vector<glm::vec3>(pixels, glm::vec3(0)), {}};
    for (int i = 0; i < static_cast<int>(objects.size()); ++i)
      frame.objects.push_back({i, 0, 0, o.width, o.height, std::vector<float>(pixels), std::vector<glm::vec3>(pixels),
                               std::vector<glm::vec3>(pixels)});
    for (const Layer layer : kLayers) {
      std::vector<hal::Texture> textures;
      for (int i = 0; i < static_cast<int>(objects.size()); ++i)
        textures.push_back(upload_truth(gpu, renderer.drawer(), i, [&](glm::vec2 uv) {
          return layer == Layer::kDiffuse ? truth.diffuse(i, uv, lamp) : truth.specular(i, uv, view, lamp);
        }));
      renderer.render(geometry_state_at(scene, position, objects, static_cast<float>(o.width) / static_cast<float>(o.height)),
                      textures, samples);
      resolve_layer(samples, o, layer, frame);
      for (const hal::Texture texture : textures) gpu.destroy(texture);
    }
    KeyBuilder key;
    key.text("drawn frame");
    key.integer(static_cast<int64_t>(keys.size()));
    key.bytes(frame.combined.data(), frame.combined.size() * sizeof(glm::vec3));
    keys.push_back(key.finish());
    store.save_frame(keys.back(), scene, frame);
  }
  return keys;
}

double psnr(const std::vector<glm::vec3>& a, const std::vector<glm::vec3>& b) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += static_cast<double>(glm::dot(a[i] - b[i], a[i] - b[i]));
  return 10 * std::log10(3 * static_cast<double>(a.size()) / std::max(sum, 1e-30));
}

}  // namespace vitrine::testing
