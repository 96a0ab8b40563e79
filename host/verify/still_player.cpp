// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/verify/still_player.h"

#include <cstdlib>
#include <utility>
#include <vector>

#include "host/base/error.h"

namespace vitrine {
namespace {

void require(const Status& status, const char* who) {
  if (!status.ok()) throw InputError(who, status.detail(), "check the image with vitrine inspect");
}

// The context's own framebuffer, top row first.
Picture read_screen(hal::Gpu& gpu) {
  Picture picture{gpu.width(), gpu.height(), {}};
  std::vector<std::byte> rgba(static_cast<size_t>(picture.width) * picture.height * 4);
  require(gpu.read_pixels({}, hal::TextureFormat::kRgba8, rgba), "OSMesa");
  for (int y = picture.height - 1; y >= 0; --y)
    for (int x = 0; x < picture.width; ++x)
      for (int c = 0; c < 3; ++c)
        picture.rgb.push_back(static_cast<uint8_t>(rgba[(static_cast<size_t>(y) * picture.width + x) * 4 + c]));
  return picture;
}

}  // namespace

void StillPlayer::Free::operator()(std::byte* block) const { std::free(block); }

StillPlayer::StillPlayer(const ImageView& image, hal::Gpu& gpu) : gpu_(gpu) {
  const size_t bytes = Engine::required_bytes(image);
  block_.reset(static_cast<std::byte*>(std::aligned_alloc(64, (bytes + 63) / 64 * 64)));
  auto engine = Engine::load(image, gpu, {block_.get(), bytes}, {.unlimited = true});
  require(engine.status(), "image");
  engine_ = std::move(engine.value());
}

void StillPlayer::draw(const Position& position) { require(engine_->frame(position, {}), "image"); }

Picture StillPlayer::play(const Position& position) {
  draw(position);
  return read_screen(gpu_);
}

}  // namespace vitrine
