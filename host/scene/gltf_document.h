// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// A glTF 2.0 asset as a file: container (.gltf or .glb), JSON, buffers.
//
// Why a reader of our own and not tinygltf: a scene is untrusted. tinygltf builds its whole model before anybody can look
// at it, reads external files that the JSON names (anywhere on the disk) while parsing, accepts node cycles, indices and
// ranges that nothing checks, and reports in paragraphs. Here every value is checked at the moment it is read, against the
// file's own sizes and against bounds on memory, and the first offence ends with one line that names the place.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "host/scene/files.h"
#include "host/scene/json_view.h"

namespace vitrine {

class GltfDocument {
 public:
  // Reads container and JSON, checks the asset's version and its required extensions; buffers are read on first use.
  // Companion files must lie below `top` (or below the model's own folder where that is not within `top`).
  // `bytes`: the file, where it is in memory. One-line remarks go to `warnings`. Throws InputError.
  GltfDocument(const std::filesystem::path& model, const std::filesystem::path& top, const Bytes* bytes,
               std::vector<std::string>* warnings);

  JsonView root() const { return JsonView(json_, file_, ""); }
  // Element `index` of a root array ("meshes"), which must exist; and the number of elements (0 where it is absent).
  JsonView element(const char* collection, int index) const;
  size_t count(const char* collection) const;

  std::span<const uint8_t> buffer_view(int index);
  // 0 where the view has none.
  size_t buffer_view_stride(int index) const;
  // Bytes of a file or data: URI that `place` holds.
  Bytes load_uri(const JsonView& place);

  // Memory made from a few bytes of input (sparse accessors, instances of meshes) is charged here; fails at the bound.
  void charge(uint64_t bytes, const JsonView& place);
  void warn(const std::string& line);
  const std::string& file() const { return file_; }

  // Sparse accessors, decoded (gltf_accessors.cpp).
  std::map<int, std::shared_ptr<const Bytes>> sparse_cache;

 private:
  void read_container();
  void read_chunks(std::span<const uint8_t> bytes);
  void check_asset() const;
  void check_extensions();
  std::span<const uint8_t> buffer(int index);

  std::filesystem::path folder_, root_;
  std::string file_;
  std::vector<std::string>* warnings_;
  nlohmann::json json_;
  Bytes container_;  // the file, kept where buffers lie in it: pictures may make it as large as all that is read from it
  bool has_binary_chunk_ = false;
  std::span<const uint8_t> binary_chunk_;  // of container_
  std::map<int, Bytes> buffers_;
  uint64_t loaded_ = 0, charged_ = 0;
};

// Extensions that are read; a model may require these and no others.
const std::vector<std::string>& known_gltf_extensions();

}  // namespace vitrine
