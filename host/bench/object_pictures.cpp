// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/bench/object_pictures.h"

#include <algorithm>
#include <utility>

#include "host/verify/reference.h"

namespace vitrine {
namespace {

constexpr float kCounts = 0.5f;  // coverage from which a pixel counts
constexpr uint8_t kGrey = 128;
constexpr int kCropMargin = 2;  // pixels

}  // namespace

const ObjectFrame* find_object(const Frame& frame, int object) {
  const auto found =
      std::find_if(frame.objects.begin(), frame.objects.end(), [&](const ObjectFrame& o) { return o.object == object; });
  return found == frame.objects.end() ? nullptr : &*found;
}

ObjectPicture traced_object(const Frame& frame, int object, float exposure) {
  const ObjectFrame* o = find_object(frame, object);
  if (!o) return {};
  ObjectPicture codes{o->x, o->y, o->width, o->height, {}, o->coverage};
  for (size_t i = 0; i < o->coverage.size(); ++i)
    for (int c = 0; c < 3; ++c) codes.rgb.push_back(srgb8_from_radiance(exposure * (o->diffuse[i][c] + o->specular[i][c])));
  return codes;
}

ObjectPicture drawn_object(const std::vector<glm::vec4>& picture, int columns, const ObjectPicture& window, float exposure) {
  ObjectPicture codes{window.x, window.y, window.width, window.height, {}, {}};
  for (int y = 0; y < window.height; ++y)
    for (int x = 0; x < window.width; ++x) {
      const glm::vec4& pixel =
          picture[static_cast<size_t>(window.y + y) * static_cast<size_t>(columns) + static_cast<size_t>(window.x + x)];
      codes.coverage.push_back(pixel.w);
      for (int c = 0; c < 3; ++c) codes.rgb.push_back(srgb8_from_radiance(pixel.w > 0 ? exposure * pixel[c] / pixel.w : 0));
    }
  return codes;
}

void CodeError::add(const ObjectPicture& a, const ObjectPicture& b) {
  for (size_t i = 0; i < std::min(a.coverage.size(), b.coverage.size()); ++i) {
    if (a.coverage[i] < kCounts || b.coverage[i] < kCounts) continue;
    for (size_t c = 3 * i; c < 3 * i + 3; ++c) squares += (a.rgb[c] - b.rgb[c]) * (a.rgb[c] - b.rgb[c]);
    values += 3;
  }
}

double CodeError::psnr() const { return psnr_db(squares / static_cast<double>(std::max<int64_t>(1, values))); }

Picture crop_of(const ObjectPicture& codes) {
  Picture picture{codes.width + 2 * kCropMargin, codes.height + 2 * kCropMargin, {}};
  picture.rgb.assign(3 * static_cast<size_t>(picture.width) * static_cast<size_t>(picture.height), kGrey);
  for (int y = 0; y < codes.height; ++y)
    for (int x = 0; x < codes.width; ++x) {
      const size_t from = static_cast<size_t>(y) * static_cast<size_t>(codes.width) + static_cast<size_t>(x);
      const size_t to =
          static_cast<size_t>(y + kCropMargin) * static_cast<size_t>(picture.width) + static_cast<size_t>(x + kCropMargin);
      if (codes.coverage[from] < kCounts) continue;
      for (size_t c = 0; c < 3; ++c) picture.rgb[3 * to + c] = codes.rgb[3 * from + c];
    }
  return picture;
}

ObjectPicture in_window_of(const ObjectPicture& codes, const ObjectPicture& window) {
  ObjectPicture moved{window.x, window.y, window.width, window.height, {}, {}};
  for (int y = window.y; y < window.y + window.height; ++y)
    for (int x = window.x; x < window.x + window.width; ++x) {
      const bool inside = x >= codes.x && y >= codes.y && x < codes.x + codes.width && y < codes.y + codes.height;
      const size_t i =
          inside ? static_cast<size_t>(y - codes.y) * static_cast<size_t>(codes.width) + static_cast<size_t>(x - codes.x) : 0;
      moved.coverage.push_back(inside ? codes.coverage[i] : 0.0f);
      for (size_t c = 0; c < 3; ++c) moved.rgb.push_back(inside ? codes.rgb[3 * i + c] : uint8_t{0});
    }
  return moved;
}

ObjectDrawer::ObjectDrawer(hal::Gpu& gpu, const InferenceOptions& options, std::span<const DrawnObject> objects,
                           GeometryState state)
    : gpu_(gpu), options_(options), renderer_(gpu, options, objects), state_(std::move(state)) {
  const Pyramid pyramid(1, 1);
  const glm::vec4 nothing(0);
  const auto texels = std::as_bytes(std::span(&nothing, 1));
  clear_ = create_pyramid_texture(gpu, renderer_.drawer(), pyramid, hal::TextureFormat::kRgba32f, texels);
}

ObjectDrawer::~ObjectDrawer() { gpu_.destroy(clear_); }

// Black and clear textures leave the others' shapes alone.
std::vector<glm::vec4> ObjectDrawer::draw(size_t object, const std::vector<LaidTexture>& textures) {
  std::vector<std::vector<SurfaceTexture>> surfaces(state_.mirrored.size(), {{clear_, {}}});
  surfaces[object].clear();
  for (const LaidTexture& laid : textures)
    surfaces[object].push_back({upload_texture(gpu_, renderer_.drawer(), laid.texture, hal::TextureFormat::kRgba32f), laid.map});
  std::vector<glm::vec4> samples(static_cast<size_t>(renderer_.width()) * static_cast<size_t>(renderer_.height()));
  renderer_.render_surfaces(state_, surfaces, samples);
  for (const SurfaceTexture& surface : surfaces[object]) gpu_.destroy(surface.texture);
  return resolve_linear(samples, options_.width, options_.height, options_.supersampling);
}

}  // namespace vitrine
