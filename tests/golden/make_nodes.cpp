// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Writes the corpus of coded nodes anew, from images and from edge cases: what the decoder makes of them now becomes what it must
// make of them. Only after a change of the bitstream or of units:
//   cmake --build build/release --target vitrine_make_nodes && build/release/bin/vitrine_make_nodes tests/golden/nodes.bin
//   IMAGE.vit...
#include <algorithm>
#include <random>

#include "formats/image.h"
#include "hal/storage.h"
#include "host/encode/field_coder.h"
#include "host/encode/node_encoder.h"
#include "target/field_state.h"
#include "tests/encode/synthetic.h"
#include "tests/golden/node_corpus.h"

namespace vitrine::golden {
namespace {

constexpr size_t kLargest = 3000;  // bytes of a node

void finish(CorpusNode node, std::vector<CorpusNode>& corpus) {
  const Decoded decoded = decode(node, ~uint64_t{0});
  if (node.desc.units == 0) node.desc.units = decoded.units;
  node.outcome = decoded.outcome;
  node.checksum = decoded.checksum;
  corpus.push_back(std::move(node));
}

CorpusNode node_of(const FieldState& field, uint32_t number, uint64_t offset, uint32_t size) {
  CorpusNode node;
  node.desc = field.desc_of(number);
  node.contexts.assign(node.desc.contexts.begin(), node.desc.contexts.end());
  if (node.contexts.empty()) node.contexts.assign(default_context_bytes().begin(), default_context_bytes().end());
  const auto bytes = field.coded.subspan(offset, size);
  for (const std::byte byte : bytes) node.bytes.push_back(static_cast<uint8_t>(byte));
  return node;
}

// Of each level of a field the node with most bytes, but no more than kLargest.
void add_field(const FieldState& field, std::vector<CorpusNode>& corpus) {
  std::vector<CorpusNode> best(static_cast<size_t>(field.shape.pyramid.level_count));
  uint64_t offset = 0;
  for (uint32_t n = 0; n < field.field->node_bytes()->size(); ++n) {
    const uint32_t size = field.field->node_bytes()->Get(n);
    CorpusNode& level = best[static_cast<size_t>(field.shape.level_of(static_cast<int>(n)))];
    if (size <= kLargest && size > level.bytes.size()) level = node_of(field, n, offset, size);
    offset += size;
  }
  for (CorpusNode& node : best)
    if (!node.bytes.empty()) finish(std::move(node), corpus);
}

bool add_image(const char* path, std::vector<CorpusNode>& corpus) {
  const auto file = hal::MappedFile::open(path);
  if (!file.ok()) return false;
  const auto image = ImageView::open(file.value().bytes());
  if (!image.ok()) return false;
  for (const fb::Object* object : *image.value().directory().objects())
    for (const fb::Field* field : *object->fields()) add_field(describe_field(image.value(), *field, {}), corpus);
  return true;
}

CorpusNode encoded(int width, int height, const CodedPlanes& planes, double step) {
  NodeTask task;
  task.width = width;
  task.height = height;
  task.planes = planes;
  CorpusNode node;
  node.desc.width = width;
  node.desc.height = height;
  for (size_t p = 0; p < kNodePlanes; ++p) {
    const double own = kStepUnitsPerCode * step / std::sqrt(static_cast<double>(kPlaneWeights[p]));
    task.steps[p] = node.desc.steps[p] = static_cast<uint16_t>(std::max(1.0, std::round(own)));
    task.weights[p] = kPlaneWeights[p] / static_cast<float>(kPricePerStep2 * step * step);
  }
  const NodeCode code = NodeEncoder().encode(task);
  node.bytes = code.bytes;
  node.desc.units = code.units;
  node.contexts.assign(default_context_bytes().begin(), default_context_bytes().end());
  return node;
}

void add_edge_cases(std::vector<CorpusNode>& corpus) {
  for (const auto& [width, height, step] : {std::tuple{1, 1, 1.0},
                                            {33, 1, 20.0},
                                            {1, 33, 20.0},
                                            {8191, 1, 200.0},
                                            {1, 8192, 200.0},
                                            {31, 65, 9.0},
                                            {40, 40, 4.0},
                                            {129, 95, 700.0}})
    finish(encoded(width, height, synthetic::texture(width, height, {}, {2, 1}), step), corpus);
  std::mt19937 random(1);
  CodedPlanes noise(3 * 40 * 40);
  for (int16_t& value : noise) value = static_cast<int16_t>(random() % 2 ? 4095 : -4095);
  finish(encoded(40, 40, noise, 100), corpus);
  finish(encoded(100, 50, CodedPlanes(3 * 100 * 50), 10), corpus);  // no bytes
}

// Bits turned, bytes cut off, more of them, other units: with units declared nearly all are found out; without, they decode to
// some picture.
void add_damaged(std::vector<CorpusNode>& corpus) {
  std::mt19937 random(2);
  const CorpusNode whole = encoded(70, 45, synthetic::texture(70, 45, {}, {1, 0}), 15);
  for (int i = 0; i < 8; ++i) {
    CorpusNode node = whole;
    if (i % 4 == 0) node.bytes.resize(node.bytes.size() * static_cast<size_t>(i + 1) / 10);
    if (i % 4 == 1) node.bytes[random() % node.bytes.size()] ^= 0x10;
    if (i % 4 == 2) std::generate(node.bytes.begin(), node.bytes.end(), random);
    if (i % 4 == 3) node.bytes.assign(400, 0xff);
    if (i >= 4) node.desc.units = 0;
    finish(std::move(node), corpus);
  }
}

int main_of(int count, char** arguments) {
  if (count < 3) return std::fprintf(stderr, "usage: vitrine_make_nodes OUT IMAGE.vit...\n"), 2;
  std::vector<CorpusNode> corpus;
  for (int i = 2; i < count; ++i)
    if (!add_image(arguments[i], corpus)) return std::fprintf(stderr, "%s: it cannot be opened\n", arguments[i]), 1;
  add_edge_cases(corpus);
  add_damaged(corpus);
  if (!write_corpus(arguments[1], corpus)) return std::fprintf(stderr, "%s: it cannot be written\n", arguments[1]), 1;
  return std::printf("%zu nodes\n", corpus.size()), 0;
}

}  // namespace
}  // namespace vitrine::golden

int main(int count, char** arguments) { return vitrine::golden::main_of(count, arguments); }
