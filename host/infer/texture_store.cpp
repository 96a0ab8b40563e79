// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/infer/texture_store.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>

#include "formats/companding.h"
#include "host/base/error.h"
#include "host/infer/fields.h"

namespace vitrine {
namespace {

constexpr float kLargestHalf = 65504;
constexpr int kSmoothingVersion = 4;  // changes whenever the same input would give other textures
constexpr size_t kTexelsAtOnce = 512;
constexpr size_t kPlanes = 4;
const std::array<const char*, kPlanes> kNames = {"B", "G", "R", "precision"};  // in the order of OpenEXR

float& value_of(SolvedTexture& texture, size_t plane, size_t texel) {
  return plane == 3 ? texture.precision[texel] : texture.texels[texel][static_cast<int>(2 - plane)];
}

LayeredImage load_planes_or_throw(const Store& store, const StoreKey& key) {
  auto image = store.load_planes(key);
  if (!image || image->planes.size() != kPlanes)
    throw InputError("texture " + key.hex(), "it is not in the store, or damaged",
                     "run the same command again, which infers what is missing");
  return std::move(*image);
}

// The textures of a block as the store holds them: half floats, for all of them are needed at once.
class Block {
 public:
  Block(const Store& store, std::span<const StoreKey> keys) {
    for (const StoreKey& key : keys) {
      const LayeredImage image = load_planes_or_throw(store, key);
      size_ = {image.width, image.height};
      auto& planes = textures_.emplace_back();
      for (size_t p = 0; p < kPlanes; ++p) {
        planes[p].reserve(image.planes[p].values.size());
        for (const float value : image.planes[p].values) planes[p].push_back(half_from_float(value));
      }
      const auto& precision = image.planes[3].values;
      seen_.push_back(std::any_of(precision.begin(), precision.end(), [](float value) { return value > 0; }));
    }
  }

  void smooth(const ParameterSpace& space, const FieldShape::Box& box, float strength) {
    const size_t texels = textures_[0][0].size();
    tbb::parallel_for(size_t{0}, (texels + kTexelsAtOnce - 1) / kTexelsAtOnce, [&](size_t part) {
      const size_t first = part * kTexelsAtOnce, last = std::min(texels, first + kTexelsAtOnce);
      std::vector<SolvedTexture> parts(textures_.size());
      for (size_t t = 0; t < parts.size(); ++t) {
        parts[t].texels.resize(last - first);
        parts[t].precision.resize(last - first);
        parts[t].hold = seen_[t] ? SolvedTexture::kHold : SolvedTexture::kHoldUnseen;
        for (size_t p = 0; p < kPlanes; ++p)
          for (size_t i = first; i < last; ++i) value_of(parts[t], p, i - first) = float_from_half(textures_[t][p][i]);
      }
      smooth_over_axes(space, box, strength, parts);
      for (size_t t = 0; t < parts.size(); ++t)
        for (size_t p = 0; p + 1 < kPlanes; ++p)
          for (size_t i = first; i < last; ++i) textures_[t][p][i] = half_from_float(value_of(parts[t], p, i - first));
    });
  }

  void save(const Store& store, size_t texture, const StoreKey& key) const {
    LayeredImage image{size_.width, size_.height, {}};
    for (size_t p = 0; p < kPlanes; ++p) {
      image.planes.push_back({kNames[p], {}});
      for (const uint16_t half : textures_[texture][p]) image.planes.back().values.push_back(float_from_half(half));
    }
    store.save_planes(key, image);
  }

 private:
  TextureSize size_;
  std::vector<bool> seen_;  // anything of a texture
  std::vector<std::array<std::vector<uint16_t>, kPlanes>> textures_;
};

std::vector<int64_t> samples_in(const ParameterSpace& space, const FieldShape::Box& box) {
  std::vector<int64_t> samples;
  for (int64_t sample = 0; sample < space.sample_count(); ++sample) {
    const GridIndex at = space.index_from_flat(sample);
    bool inside = true;
    for (size_t a = 0; a < static_cast<size_t>(space.axis_count); ++a) inside &= at[a] >= box.first[a] && at[a] <= box.last[a];
    if (inside) samples.push_back(sample);
  }
  return samples;
}

// Which samples are neighbours depends on the block's shape and on the kinds of its axes, which the textures' own keys do not
// tell.
StoreKey smoothed_key(const ParameterSpace& space, const FieldShape::Box& box, std::span<const StoreKey> keys, size_t texture,
                      float strength) {
  KeyBuilder key;
  key.text("smoothed texture");
  key.integer(kSmoothingVersion);
  key.number(static_cast<double>(strength));
  for (size_t a = 0; a < static_cast<size_t>(space.axis_count); ++a) {
    key.integer(static_cast<int64_t>(space.axes[a].kind));
    key.integer(box.last[a] - box.first[a] + 1);
  }
  for (const StoreKey& k : keys) key.text(k.hex());
  key.integer(static_cast<int64_t>(texture));
  return key.finish();
}

struct BlockJob {
  Field* field = nullptr;
  FieldShape::Box box;
  std::vector<int64_t> samples;
  std::vector<StoreKey> from, to;
  bool found = false;  // all of them
};

BlockJob make_job(const Store& store, float strength, const FieldShape::Box& box, Field& field) {
  BlockJob job{&field, box, samples_in(field.space, box), {}, {}};
  for (const int64_t sample : job.samples) job.from.push_back(field.textures[static_cast<size_t>(sample)]);
  for (size_t t = 0; t < job.from.size(); ++t) job.to.push_back(smoothed_key(field.space, box, job.from, t, strength));
  job.found = std::all_of(job.to.begin(), job.to.end(), [&](const StoreKey& key) { return store.has_planes(key); });
  return job;
}

void smooth_block(const Store& store, float strength, const BlockJob& job, Progress& progress) {
  Block block(store, job.from);
  block.smooth(job.field->space, job.box, strength);
  tbb::parallel_for(size_t{0}, job.to.size(), [&](size_t t) {
    block.save(store, t, job.to[t]);
    progress.advance(1);
  });
}

}  // namespace

void save_solved_texture(const Store& store, const StoreKey& key, const TextureSize& size, const SolvedTexture& texture) {
  LayeredImage image{size.width, size.height, {}};
  SolvedTexture values = texture;
  for (size_t p = 0; p < kPlanes; ++p) {
    image.planes.push_back({kNames[p], {}});
    for (size_t i = 0; i < texture.texels.size(); ++i)
      image.planes.back().values.push_back(std::min(value_of(values, p, i), kLargestHalf));
  }
  store.save_planes(key, image);
}

SolvedTexture load_solved_texture(const Store& store, const StoreKey& key) {
  const LayeredImage image = load_planes_or_throw(store, key);
  SolvedTexture texture;
  texture.texels.resize(image.planes[0].values.size());
  texture.precision.resize(texture.texels.size());
  for (size_t p = 0; p < kPlanes; ++p)
    for (size_t i = 0; i < texture.texels.size(); ++i) value_of(texture, p, i) = image.planes[p].values[i];
  return texture;
}

void smooth_fields(const Store& store, float strength, Inference& inference, Progress& progress) {
  std::vector<BlockJob> jobs;
  int64_t total = 0, found = 0;
  for (Field& field : inference.fields) {
    const FieldShape shape = blocks_of(field);
    for (int block = 0; block < shape.block_count(); ++block) {
      jobs.push_back(make_job(store, strength, shape.samples_of(block), field));
      total += static_cast<int64_t>(jobs.back().samples.size());
      if (jobs.back().found) found += static_cast<int64_t>(jobs.back().samples.size());
    }
  }
  progress.begin("smoothing", total, found, "textures");
  for (const BlockJob& job : jobs) {
    if (!job.found) smooth_block(store, strength, job, progress);
    for (size_t t = 0; t < job.to.size(); ++t) job.field->textures[static_cast<size_t>(job.samples[t])] = job.to[t];
  }
  progress.end();
}

}  // namespace vitrine
