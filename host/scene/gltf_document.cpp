// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/scene/gltf_document.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>

#include "host/base/error.h"
#include "host/scene/text.h"

namespace vitrine {
namespace {

constexpr uint64_t kLargestFile = 2ull << 30;    // of one file, and of all that one model names
constexpr uint64_t kLargestCharge = 4ull << 30;  // of what a model makes from less
constexpr size_t kMostWarnings = 100;
constexpr uint32_t kGlbMagic = 0x46546C67, kJsonChunk = 0x4E4F534A, kBinaryChunk = 0x004E4942;  // glTF 2.0, section 4.4

uint32_t little_endian(std::span<const uint8_t> bytes, size_t at) {
  return bytes[at] | bytes[at + 1] << 8 | bytes[at + 2] << 16 | static_cast<uint32_t>(bytes[at + 3]) << 24;
}

std::span<const uint8_t> without_padding(std::span<const uint8_t> text) {
  while (!text.empty() && (text.back() == 0 || text.back() == ' ')) text = text.first(text.size() - 1);
  return text;
}

// "2.1" to {2, 1}; {0, 0} where it is no version.
std::pair<int, int> parse_version(const std::string& text) {
  int major = 0, minor = 0, used = 0;
  if (text.size() > 10 || std::sscanf(text.c_str(), "%3d.%3d%n", &major, &minor, &used) != 2) return {0, 0};
  return static_cast<size_t>(used) == text.size() ? std::pair{major, minor} : std::pair{0, 0};
}

bool is_known(const std::string& extension) {
  const std::vector<std::string>& known = known_gltf_extensions();
  return std::find(known.begin(), known.end(), extension) != known.end();
}

}  // namespace

const std::vector<std::string>& known_gltf_extensions() {
  static const std::vector<std::string> known = {
      "KHR_materials_transmission", "KHR_materials_ior",       "KHR_materials_volume",
      "KHR_materials_specular",     "KHR_materials_clearcoat", "KHR_materials_emissive_strength",
      "KHR_materials_variants",     "KHR_materials_unlit",     "KHR_lights_punctual",
      "KHR_texture_transform",      "KHR_mesh_quantization",   "EXT_texture_webp"};
  return known;
}

GltfDocument::GltfDocument(const std::filesystem::path& model, const std::filesystem::path& top, const Bytes* bytes,
                           std::vector<std::string>* warnings)
    : folder_(model.has_parent_path() ? model.parent_path() : "."), root_(top), file_(shown(model)), warnings_(warnings) {
  const auto normal = [](const std::filesystem::path& p) { return std::filesystem::absolute(p / "").lexically_normal(); };
  const std::filesystem::path inside = top.empty() ? ".." : normal(folder_).lexically_relative(normal(root_));
  if (inside.empty() || *inside.begin() == "..") root_ = folder_;
  container_ = bytes ? *bytes : read_file(model, kLargestFile);
  read_container();
  if (!has_binary_chunk_) container_ = Bytes();
  if (!json_.is_object()) root().fail("must be a JSON object");
  check_asset();
  check_extensions();
}

void GltfDocument::read_container() {
  loaded_ = container_.size();
  if (container_.empty()) root().fail("the file is empty");
  if (container_.size() >= 4 && little_endian(container_, 0) == kGlbMagic) return read_chunks(container_);
  json_ = parse_json(container_, file_);
}

void GltfDocument::read_chunks(std::span<const uint8_t> bytes) {
  if (bytes.size() < 12) root().fail("the GLB header is cut short");
  if (little_endian(bytes, 4) != 2)
    root().fail(fmt::format("is GLB version {}", little_endian(bytes, 4)), "export it as glTF 2.0");
  const size_t length = little_endian(bytes, 8);
  if (length > bytes.size()) root().fail(fmt::format("the GLB header promises {} bytes, the file has {}", length, bytes.size()));
  if (length < 20) root().fail("the GLB has no JSON chunk");
  size_t at = 12;
  for (int chunk = 0; at + 8 <= length; ++chunk) {
    const size_t size = little_endian(bytes, at);
    const uint32_t type = little_endian(bytes, at + 4);
    at += 8;
    if (size > length - at) root().fail(fmt::format("chunk {} promises {} bytes, {} are left", chunk, size, length - at));
    const std::span<const uint8_t> data = bytes.subspan(at, size);
    at += size;
    if (chunk == 0 && type != kJsonChunk) root().fail("the first GLB chunk is not JSON");
    if (chunk == 0) json_ = parse_json(without_padding(data), file_);
    if (chunk > 0 && type == kJsonChunk) root().fail("the GLB has two JSON chunks");
    if (chunk > 1 && type == kBinaryChunk) root().fail("the GLB's binary chunk is not its second");
    if (chunk != 1 || type != kBinaryChunk) continue;
    has_binary_chunk_ = true;
    binary_chunk_ = data;
  }
  if (at != length) root().fail("the last GLB chunk is cut short");
}

void GltfDocument::check_asset() const {
  const JsonView asset = root().at("asset");
  const std::string version = asset.at("version").text();
  if (parse_version(version).first != 2) asset.at("version").fail("is " + in_quotes(version), "export it as glTF 2.0");
  const std::string least = asset.text_or("minVersion", "2.0");
  const auto [major, minor] = parse_version(least);
  if (major != 2 || minor > 0) asset.at("minVersion").fail("is " + in_quotes(least), "export it as glTF 2.0");
}

void GltfDocument::check_extensions() {
  std::vector<std::string> required;
  if (const auto list = root().find("extensionsRequired"))
    for (size_t i = 0; i < list->size(); ++i) required.push_back((*list)[i].text());
  for (const std::string& name : required)
    if (!is_known(name))
      root()
          .at("extensionsRequired")
          .fail("the model requires " + in_quotes(name) + ", which Vitrine does not read", "export it without this extension");
  if (const auto list = root().find("extensionsUsed"))
    for (size_t i = 0; i < list->size(); ++i)
      if (!is_known((*list)[i].text()))
        warn("the extension " + in_quotes((*list)[i].text()) + " is not read; the model is shown without it");
}

JsonView GltfDocument::element(const char* collection, int index) const {
  return root().at(collection)[static_cast<size_t>(index)];
}

size_t GltfDocument::count(const char* collection) const {
  const std::optional<JsonView> list = root().find(collection);
  return list ? list->size() : 0;
}

Bytes GltfDocument::load_uri(const JsonView& place) {
  const std::string& uri = place.text();
  Bytes bytes;
  try {
    if (is_data_uri(uri))
      bytes = decode_data_uri(uri);
    else
      bytes = read_file(file_of_uri(uri, folder_, root_), kLargestFile);
  } catch (const InputError& e) {
    throw;
  } catch (const std::runtime_error& e) {
    place.fail(in_quotes(uri) + ' ' + e.what(), "keep companion files beside the model and name them relative to it");
  }
  loaded_ += bytes.size();
  if (loaded_ > kLargestFile) place.fail("the model and its companions are larger than 2 GiB", "reduce it");
  return bytes;
}

std::span<const uint8_t> GltfDocument::buffer(int index) {
  const JsonView place = element("buffers", index);
  const size_t length = static_cast<size_t>(place.at("byteLength").integer(1, INT64_C(1) << 40));
  const std::optional<JsonView> uri = place.find("uri");
  if (!uri && !(index == 0 && has_binary_chunk_)) place.fail("has no \"uri\", and there is no binary chunk for it");
  std::span<const uint8_t> bytes = binary_chunk_;
  if (uri) {
    auto it = buffers_.find(index);
    if (it == buffers_.end()) it = buffers_.emplace(index, load_uri(*uri)).first;
    bytes = it->second;
  }
  if (bytes.size() < length) place.fail(fmt::format("promises {} bytes, but there are {}", length, bytes.size()));
  return bytes.first(length);
}

std::span<const uint8_t> GltfDocument::buffer_view(int index) {
  const JsonView place = element("bufferViews", index);
  const int buffer_index = place.index_or_none("buffer", "buffers", count("buffers"));
  if (buffer_index < 0) place.fail("names no buffer");
  const std::span<const uint8_t> bytes = buffer(buffer_index);
  const size_t offset = static_cast<size_t>(place.integer_or("byteOffset", 0, 0, INT64_C(1) << 40));
  const size_t length = static_cast<size_t>(place.at("byteLength").integer(1, INT64_C(1) << 40));
  if (offset > bytes.size() || length > bytes.size() - offset)
    place.fail(fmt::format("bytes {} to {} lie outside its buffer of {}", offset, offset + length, bytes.size()));
  return bytes.subspan(offset, length);
}

size_t GltfDocument::buffer_view_stride(int index) const {
  return static_cast<size_t>(element("bufferViews", index).integer_or("byteStride", 0, 4, 252));
}

void GltfDocument::charge(uint64_t bytes, const JsonView& place) {
  charged_ += bytes;
  if (charged_ > kLargestCharge) place.fail("the model needs more than 4 GiB of memory", "reduce it");
}

void GltfDocument::warn(const std::string& line) {
  const std::string whole = file_ + ": " + printable(line, 300);
  const bool known = std::find(warnings_->begin(), warnings_->end(), whole) != warnings_->end();
  if (!known && warnings_->size() < kMostWarnings) warnings_->push_back(whole);
}

}  // namespace vitrine
