// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// A corpus of coded nodes (tests/golden/nodes.bin) and what every machine must make of them. Needs nothing but the decoder, so
// that it can be built for any machine.
//
// The file: a count, then for each node its width, height, three steps and kind of outcome (16 bits each), units and number of
// bytes (32), the checksum of its decoded planes (64), its initial context states, its bytes; all little-endian.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

#include "target/decode/node_decoder.h"

namespace vitrine::golden {

enum class Outcome : uint16_t { kDecodes, kMalformed };

struct CorpusNode {
  NodeDesc desc;  // its contexts are set by decode()
  Outcome outcome = Outcome::kDecodes;
  uint64_t checksum = 0;
  std::vector<uint8_t> contexts, bytes;
};

// FNV-1a over the planes as little-endian 16-bit numbers.
inline uint64_t checksum_of_planes(const std::vector<int16_t>& planes) {
  uint64_t hash = 0xcbf29ce484222325u;
  for (const int16_t value : planes)
    for (const int shift : {0, 8}) hash = (hash ^ ((static_cast<uint16_t>(value) >> shift) & 0xff)) * 0x100000001b3u;
  return hash;
}

struct Decoded {
  Outcome outcome;
  uint64_t checksum, units;
};

// In steps of about `units`.
inline Decoded decode(const CorpusNode& node, uint64_t units) {
  NodeDesc desc = node.desc;
  desc.contexts = node.contexts;
  std::vector<int16_t> planes(3 * static_cast<size_t>(desc.width) * static_cast<size_t>(desc.height), 77);
  NodeDecoder decoder;
  Decoded result{Outcome::kDecodes, 0, 0};
  Status status = decoder.start(desc, std::as_bytes(std::span(node.bytes)), planes);
  while (status.ok() && !decoder.done()) {
    const Result<uint64_t> step = decoder.step(units);
    status = step.status();
    if (status.ok()) result.units += step.value();
  }
  if (!status.ok()) result.outcome = Outcome::kMalformed;
  result.checksum = checksum_of_planes(planes);
  return result;
}

inline uint64_t read_number(std::FILE* file, int bytes) {
  uint64_t value = 0;
  for (int i = 0; i < bytes; ++i) value |= static_cast<uint64_t>(std::fgetc(file) & 0xff) << (8 * i);
  return value;
}
inline void write_number(std::FILE* file, uint64_t value, int bytes) {
  for (int i = 0; i < bytes; ++i) std::fputc(static_cast<int>(value >> (8 * i) & 0xff), file);
}

// Empty where the file cannot be read.
inline std::vector<CorpusNode> read_corpus(const std::string& path) {
  std::vector<CorpusNode> nodes;
  std::FILE* file = std::fopen(path.c_str(), "rb");
  if (!file) return nodes;
  nodes.resize(read_number(file, 4));
  for (CorpusNode& node : nodes) {
    node.desc.width = static_cast<int>(read_number(file, 2));
    node.desc.height = static_cast<int>(read_number(file, 2));
    for (uint16_t& step : node.desc.steps) step = static_cast<uint16_t>(read_number(file, 2));
    node.outcome = static_cast<Outcome>(read_number(file, 2));
    node.desc.units = read_number(file, 4);
    node.bytes.resize(read_number(file, 4));
    node.checksum = read_number(file, 8);
    node.contexts.resize(kContextBytesPerLevel);
    for (uint8_t& byte : node.contexts) byte = static_cast<uint8_t>(read_number(file, 1));
    for (uint8_t& byte : node.bytes) byte = static_cast<uint8_t>(read_number(file, 1));
  }
  std::fclose(file);
  return nodes;
}

inline bool write_corpus(const std::string& path, const std::vector<CorpusNode>& nodes) {
  std::FILE* file = std::fopen(path.c_str(), "wb");
  if (!file) return false;
  write_number(file, nodes.size(), 4);
  for (const CorpusNode& node : nodes) {
    write_number(file, static_cast<uint64_t>(node.desc.width), 2);
    write_number(file, static_cast<uint64_t>(node.desc.height), 2);
    for (const uint16_t step : node.desc.steps) write_number(file, step, 2);
    write_number(file, static_cast<uint64_t>(node.outcome), 2);
    write_number(file, node.desc.units, 4);
    write_number(file, node.bytes.size(), 4);
    write_number(file, node.checksum, 8);
    for (const uint8_t byte : node.contexts) write_number(file, byte, 1);
    for (const uint8_t byte : node.bytes) write_number(file, byte, 1);
  }
  return std::fclose(file) == 0;
}

// Decodes all, whole and tile by tile; the numbers of those that come out otherwise than they must.
inline std::vector<size_t> different_nodes(const std::vector<CorpusNode>& nodes) {
  std::vector<size_t> different;
  for (size_t i = 0; i < nodes.size(); ++i)
    for (const uint64_t units : {~uint64_t{0}, uint64_t{1}}) {
      const Decoded result = decode(nodes[i], units);
      if (result.outcome != nodes[i].outcome || result.checksum != nodes[i].checksum) {
        different.push_back(i);
        break;
      }
    }
  return different;
}

}  // namespace vitrine::golden
