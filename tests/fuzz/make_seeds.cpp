// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Where the fuzzers start: the corpus of nodes and the small image of the format's tests, as their inputs.
//   make_seeds NODES.bin FOLDER     writes FOLDER/node_decoder/* and FOLDER/image_reader/*
#include <cstring>
#include <filesystem>
#include <fstream>

#include "tests/formats/test_image.h"
#include "tests/golden/node_corpus.h"

namespace vitrine {
namespace {

void write(const std::filesystem::path& path, const std::vector<uint8_t>& bytes) {
  std::filesystem::create_directories(path.parent_path());
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

template <typename T>
void append(std::vector<uint8_t>& bytes, T value) {
  for (size_t i = 0; i < sizeof(T); ++i) bytes.push_back(static_cast<uint8_t>(static_cast<uint64_t>(value) >> (8 * i)));
}

// As tests/fuzz/node_decoder.cpp reads it.
std::vector<uint8_t> seed_of(const golden::CorpusNode& node) {
  std::vector<uint8_t> seed;
  append(seed, static_cast<uint8_t>(node.desc.width));
  append(seed, static_cast<uint8_t>(node.desc.height));
  for (const uint16_t step : node.desc.steps) append(seed, step);
  append(seed, static_cast<uint32_t>(node.desc.width < 256 && node.desc.height < 256 ? node.desc.units : 0));
  append(seed, uint16_t{1000});
  append(seed, uint8_t{2});
  append(seed, uint8_t{1});
  seed.insert(seed.end(), node.contexts.begin(), node.contexts.end());
  seed.insert(seed.end(), node.bytes.begin(), node.bytes.end());
  return seed;
}

// As tests/fuzz/image_reader.cpp reads it.
std::vector<uint8_t> seed_of(test::TestImage image) {
  lay_out_sections(image.directory, image.sections);
  const std::vector<std::byte> directory = serialize_directory(image.directory);
  std::vector<std::byte> behind;
  for (const ImageSection& section : image.sections) {
    behind.insert(behind.end(), section.bytes.begin(), section.bytes.end());
    behind.resize(aligned_offset(behind.size()));
  }
  std::vector<uint8_t> seed;
  append(seed, static_cast<uint32_t>(directory.size()));
  for (const std::span<const std::byte> part : {std::span<const std::byte>(directory), std::span<const std::byte>(behind)})
    for (const std::byte byte : part) seed.push_back(static_cast<uint8_t>(byte));
  return seed;
}

}  // namespace
}  // namespace vitrine

int main(int count, char** arguments) {
  using namespace vitrine;
  if (count != 3) return 2;
  const std::filesystem::path folder = arguments[2];
  const auto nodes = golden::read_corpus(arguments[1]);
  for (size_t i = 0; i < nodes.size(); ++i) write(folder / "node_decoder" / std::to_string(i), seed_of(nodes[i]));
  write(folder / "image_reader" / "0", seed_of(test::make_test_image()));
  return nodes.empty();
}
