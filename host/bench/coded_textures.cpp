// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/bench/coded_textures.h"

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <optional>

#include "formats/image.h"
#include "hal/backends.h"
#include "host/base/error.h"
#include "host/bench/frozen_scene.h"
#include "host/bench/processor_time.h"
#include "host/verify/still_player.h"

namespace vitrine {
namespace {

constexpr double kCoarsest = 1000;  // quantizer of textures that only take their place
constexpr int kTimedAccesses = 8;

// What is compared. A further way of coding is a further line.
const TextureCoder kTextureCoders[] = {
    {.name = "lifting or pyramid, DCT"},
    {.name = "the same, no object 4 times worse", .options = {.worst_object = 4}},
    {.name = "lifting or pyramid, SPIHT", .options = {.coder = NodeCoder::kSpiht}},
    {.name = "the same, layers combined", .layers = Layers::kCombined},
    {.name = "pyramid, DCT", .options = {.pyramid = PyramidKind::kResiduals}},
    {.name = "pyramid, DCT, not adaptive", .options = {.pyramid = PyramidKind::kIsotropic}},
};

// An image where a file would be mapped.
class MappedImage {
 public:
  explicit MappedImage(const std::vector<std::byte>& bytes)
      : bytes_(static_cast<std::byte*>(std::aligned_alloc(64, (bytes.size() + 63) / 64 * 64))) {
    std::copy(bytes.begin(), bytes.end(), bytes_.get());
    auto view = ImageView::open({bytes_.get(), bytes.size()});
    if (!view.ok()) throw InputError("image", view.status().detail(), "compile the scene to see where it fails");
    view_.emplace(std::move(view.value()));
  }
  const ImageView& view() const { return *view_; }

 private:
  struct Free {
    void operator()(std::byte* block) const { std::free(block); }
  };
  std::unique_ptr<std::byte, Free> bytes_;
  std::optional<ImageView> view_;
};

std::vector<Position> positions_of(const ParameterSpace& space) {
  std::vector<Position> positions;
  for (int64_t i = 0; i < space.sample_count(); ++i) positions.push_back(space.position_of(space.index_from_flat(i)));
  return positions;
}

// Nodes that one texture takes, at most over the fields.
int decodes_of(const std::vector<EncodedField>& fields) {
  int most = 0;
  for (const EncodedField& field : fields) most = std::max(most, field.shape.pyramid.level_count);
  return most;
}

// Processor milliseconds for the nodes of all textures of one picture, composed: what an engine that has just started takes more
// than one that has them.
double decode_ms(const ImageView& image, const std::vector<Position>& positions) {
  double sum = 0;
  for (int i = 0; i < kTimedAccesses; ++i) {
    const Position& position = positions[positions.size() * static_cast<size_t>(i) / kTimedAccesses];
    const auto gpu =
        hal::create_null_gpu(static_cast<int>(image.directory().width()), static_cast<int>(image.directory().height()));
    StillPlayer player(image, *gpu);
    const double start = processor_seconds();
    player.draw(position);
    const double decoded = processor_seconds();
    player.draw(position);
    sum += decoded - start - (processor_seconds() - decoded);
  }
  return 1000 * sum / kTimedAccesses;
}

}  // namespace

std::span<const TextureCoder> texture_coders() { return kTextureCoders; }

std::vector<StoreKey> combine_layers(const Scene& scene, const std::vector<StoreKey>& frames, const Store& store,
                                     Progress& progress) {
  std::vector<StoreKey> keys;
  for (const StoreKey& key : frames) {
    progress.advance(0);
    KeyBuilder combined;
    combined.text("layers combined");
    combined.text(key.hex());
    keys.push_back(combined.finish());
    if (store.has_frame(keys.back())) continue;
    auto frame = store.load_frame(key, scene);
    if (!frame) throw InputError("work folder", "a frame is gone", "run the same command again");
    for (ObjectFrame& object : frame->objects)
      for (size_t i = 0; i < object.diffuse.size(); ++i) {
        object.specular[i] += object.diffuse[i];
        object.diffuse[i] = glm::vec3(0);
      }
    store.save_frame(keys.back(), scene, *frame);
  }
  return keys;
}

double geometry_bytes(const Scene& scene, const Inference& inference, const Store& store, const Profile& profile,
                      Progress& progress) {
  const std::vector<FieldSource> sources = field_sources(scene, inference, store);
  const BuiltImage image = build_image(scene, inference, encode_fields(sources, {.quantizer = kCoarsest}, progress), profile);
  return static_cast<double>(image.bytes.size() - image.field_bytes);
}

CompressionSeries measure_coded_textures(const Scene& scene, const Inference& inference, const TextureCoder& coder,
                                         const Store& store, const Profile& profile, const std::vector<Picture>& truth,
                                         std::span<const double> bytes, Progress& progress) {
  const std::vector<FieldSource> sources = field_sources(scene, inference, store);
  const std::vector<Position> positions = positions_of(scene.space());
  auto gpu = hal::create_osmesa_gpu(scene.settings.width, scene.settings.height);
  if (!gpu.ok()) throw InputError("OSMesa", gpu.status().detail(), "install the packages of tools/packages.txt");
  CompressionSeries series{coder.name, CoderKind::kVitrine, {}, {}};
  for (const double target : bytes) {
    EncodeOptions options = coder.options;
    options.target_bytes = static_cast<uint64_t>(target);
    PartOfStep part(progress);
    const std::vector<EncodedField> encoded = encode_fields(sources, options, part);
    const BuiltImage image = build_image(scene, inference, encoded, profile);
    const MappedImage mapped(image.bytes);
    StillPlayer player(mapped.view(), *gpu.value());
    CompressionRow row;
    double error = 0;
    for (size_t i = 0; i < positions.size(); ++i) {
      progress.advance(0);
      const Picture played = player.play(positions[i]);
      error += mean_squared_error(played, truth[i]) / static_cast<double>(positions.size());
      if (static_cast<int64_t>(i) == middle_sample(scene)) row.shown = played;
    }
    row.bytes = static_cast<double>(image.field_bytes);
    row.psnr_db = psnr_db(error);
    row.decodes_per_access = decodes_of(encoded);
    row.decode_ms = decode_ms(mapped.view(), positions);
    series.points.push_back({row.bytes, row.psnr_db});
    series.rows.push_back(std::move(row));
  }
  return series;
}

}  // namespace vitrine
