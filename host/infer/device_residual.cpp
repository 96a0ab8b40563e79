// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/infer/device_residual.h"

#include <algorithm>
#include <cmath>

#include "host/infer/verification.h"

namespace vitrine {
namespace {

// A x / c.
Texels modelled(const Pyramid& pyramid, const Observation& observation, const Texels& texture) {
  std::vector<Lanes<1>> all(pyramid.size()), pixels(observation.matrix->pixel_count());
  for (size_t i = 0; i < texture.size(); ++i)
    for (int k = 0; k < 3; ++k) all[i].set(static_cast<size_t>(k), texture[i][k]);
  pyramid.decimate(all.data());
  observation.matrix->apply(all.data(), pixels.data());
  Texels result(pixels.size(), glm::vec3(0));
  for (size_t p = 0; p < pixels.size(); ++p)
    if (observation.weight[p] > 0)
      result[p] = glm::vec3(pixels[p][0], pixels[p][1], pixels[p][2]) / observation.matrix->filtered()[p];
  return result;
}

std::vector<Texels> solve_once(const Pyramid& pyramid, const Observation& observation, std::span<const Texels> layers,
                               const SolverOptions& options) {
  TextureSolver solver(pyramid, layers.size(), options);
  solver.add(observation, layers);
  ObservedTerm data(pyramid.size());
  data.add(observation);
  return solver.solve(data);
}

LinearTexture in_bytes(const Pyramid& pyramid, const Texels& texels, float white) {
  LinearTexture held{pyramid.width(), pyramid.height(), texels};
  for (glm::vec3& texel : held.texels)
    for (int k = 0; k < 3; ++k) texel[k] = std::round(std::clamp(texel[k] / white, 0.0f, 1.0f) * 255) / 255 * white;
  return held;
}

}  // namespace

DeviceForward::DeviceForward(TestRenderer& renderer, const GeometryState& state, const Pyramid& pyramid, size_t object_count,
                             size_t object, const PixelWindow& window, HeldTexel held, float white)
    : renderer_(renderer), state_(state), pyramid_(pyramid), object_(object), window_(window), held_(held), white_(white) {
  const glm::vec4 nothing(0);
  textures_.assign(object_count, create_pyramid_texture(renderer.gpu(), renderer.drawer(), Pyramid(1, 1),
                                                        hal::TextureFormat::kRgba32f, std::as_bytes(std::span(&nothing, 1))));
}

DeviceForward::~DeviceForward() {
  if (!textures_.empty()) renderer_.gpu().destroy(textures_[0]);
}

hal::Texture DeviceForward::upload(const Texels& texels) const {
  // Levels of bytes are made from bytes, and read as exactly as floats hold them.
  if (held_ == HeldTexel::kByte)
    return upload_texture(renderer_.gpu(), renderer_.drawer(), in_bytes(pyramid_, texels, white_), hal::TextureFormat::kRgba32f);
  return upload_texture(renderer_.gpu(), renderer_.drawer(), {pyramid_.width(), pyramid_.height(), texels},
                        hal::TextureFormat::kRgba16f);
}

Texels DeviceForward::show(const Texels& texels) {
  const hal::Texture own = upload(texels);
  std::vector<hal::Texture> all = textures_;
  all[object_] = own;
  std::vector<glm::vec4> samples(static_cast<size_t>(renderer_.width()) * static_cast<size_t>(renderer_.height()));
  renderer_.render(state_, all, samples);
  renderer_.gpu().destroy(own);
  const int supersampling = renderer_.supersampling(), width = renderer_.width() / supersampling;
  const std::vector<glm::vec4> picture = resolve_linear(samples, width, renderer_.height() / supersampling, supersampling);
  Texels shown;
  for (int y = window_.y; y < window_.y + window_.height; ++y)
    for (int x = window_.x; x < window_.x + window_.width; ++x) {
      const glm::vec4& pixel = picture[static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x)];
      shown.push_back(pixel.w > 0 ? glm::vec3(pixel) / pixel.w : glm::vec3(0));
    }
  return shown;
}

std::vector<Texels> DeviceForward::operator()(std::span<const Texels> textures) {
  std::vector<Texels> shown;
  for (const Texels& texture : textures) shown.push_back(show(texture));
  return shown;
}

double weighted_error(const Observation& observation, const Texels& shown, const Texels& layer) {
  double sum = 0;
  for (size_t p = 0; p < layer.size(); ++p) {
    if (observation.weight[p] <= 0) continue;
    const glm::vec3 difference = observation.weight[p] * (shown[p] - layer[p]);
    sum += static_cast<double>(glm::dot(difference, difference));
  }
  return sum;
}

std::vector<Texels> solve_on_device(const Pyramid& pyramid, const Observation& observation, std::span<const Texels> layers,
                                    const SolverOptions& options, const ForwardOperator& forward, int rounds) {
  std::vector<Texels> last = solve_once(pyramid, observation, layers, options), best = last;
  std::vector<Texels> shown = forward(last);
  std::vector<double> errors;
  for (size_t t = 0; t < layers.size(); ++t) errors.push_back(weighted_error(observation, shown[t], layers[t]));
  bool better = true;
  for (int round = 0; round < rounds && better; ++round) {
    std::vector<Texels> corrected(layers.begin(), layers.end());
    for (size_t t = 0; t < layers.size(); ++t) {
      const Texels model = modelled(pyramid, observation, last[t]);
      for (size_t p = 0; p < model.size(); ++p) corrected[t][p] += model[p] - shown[t][p];
    }
    last = solve_once(pyramid, observation, corrected, options);
    shown = forward(last);
    better = false;
    for (size_t t = 0; t < layers.size(); ++t) {
      const double error = weighted_error(observation, shown[t], layers[t]);
      if (!(error < errors[t])) continue;
      errors[t] = error;
      best[t] = last[t];
      better = true;
    }
  }
  return best;
}

}  // namespace vitrine
