// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// A ball on a board, made by hand: four views on an orbit and two lamps (samples of the second axis). Ground truth is drawn
// from known textures with the device itself, so that inference has an exact answer to find.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

#include "hal/backends.h"
#include "host/frames/store.h"
#include "host/infer/inference.h"
#include "host/infer/test_renderer.h"
#include "host/infer/verification.h"
#include "host/scene/scene.h"

namespace vitrine::testing {

std::unique_ptr<hal::Gpu> make_gpu();

struct SceneShape {
  int views = 4, lamps = 2;
};
std::unique_ptr<Scene> make_ball_on_board(const SceneShape& shape = {});

// Objects by themselves, with the textures that they are drawn with.
struct ShownObjects {
  std::vector<DrawnObject> objects;
  std::vector<TextureSize> sizes;
  std::vector<TextureMap> maps;
};
// A board that runs away from the eye (many levels meet) and, before it, a small upright card.
ShownObjects board_and_card(int board_width, int board_height, int card_width, int card_height);
GeometryState looking_down(const ShownObjects& shown, float aspect, float height);

// Radiance of an object's surface at (u, v) of its whole texture domain. `view`: in grid samples.
struct Truth {
  std::function<glm::vec3(int object, glm::vec2 uv, int lamp)> diffuse;
  std::function<glm::vec3(int object, glm::vec2 uv, float view, int lamp)> specular;
};
Truth smooth_truth();

// A store in a fresh folder that goes when this goes.
class ScratchStore {
 public:
  ScratchStore();
  ~ScratchStore();
  Store& store() { return *store_; }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  std::unique_ptr<Store> store_;
};

// Draws frames into the store; returns their keys.
std::vector<StoreKey> draw_frames_at(const Scene& scene, const Truth& truth, const std::vector<Position>& positions,
                                     const InferenceOptions& options, hal::Gpu& gpu, const Store& store);
// Those of all grid samples.
std::vector<StoreKey> draw_frames(const Scene& scene, const Truth& truth, const InferenceOptions& options, hal::Gpu& gpu,
                                  const Store& store);

// 10 log10 (peak^2 / mean squared error) over pixels where `counts` is true, peak = 1.
double psnr(const std::vector<glm::vec3>& a, const std::vector<glm::vec3>& b);

}  // namespace vitrine::testing
