// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/scene/picture.h"

#include <webp/decode.h>

#include <cstdlib>
#include <cstring>
#include <memory>
#include <string>

// A picture of a few bytes may inflate to gigabytes: stb_image gets its memory in pieces of bounded size.
namespace {
constexpr size_t kLargestPiece = size_t{640} << 20;  // 16-bit RGBA of the largest picture, and its filter bytes
void* bounded_malloc(size_t size) { return size <= kLargestPiece ? std::malloc(size) : nullptr; }
void* bounded_realloc(void* old, size_t size) { return size <= kLargestPiece ? std::realloc(old, size) : nullptr; }
}  // namespace
#define STBI_MALLOC(size) bounded_malloc(size)
#define STBI_REALLOC(old, size) bounded_realloc(old, size)
#define STBI_FREE(old) std::free(old)
#define STBI_ONLY_PNG
#define STBI_ONLY_JPEG
#define STBI_NO_STDIO
#define STBI_NO_LINEAR
#define STBI_MAX_DIMENSIONS 16384
#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wsign-compare"
#include <stb/stb_image.h>
#pragma GCC diagnostic pop

namespace vitrine {
namespace {

bool starts_with(std::span<const uint8_t> bytes, const char* magic, size_t size) {
  return bytes.size() >= size && std::memcmp(bytes.data(), magic, size) == 0;
}

void check_size(int width, int height) {
  if (width < 1 || height < 1) throw std::runtime_error("is an empty picture");
  if (width > kLargestPictureSide || height > kLargestPictureSide || int64_t{width} * height > kLargestPicture)
    throw std::runtime_error("is a picture of " + std::to_string(width) + " x " + std::to_string(height) +
                             " pixels, more than is read");
}

Image adopt(const uint8_t* rgba, int width, int height) {
  Image image;
  image.width = width;
  image.height = height;
  image.rgba.assign(rgba, rgba + size_t{4} * static_cast<size_t>(width) * static_cast<size_t>(height));
  return image;
}

Image decode_webp(std::span<const uint8_t> bytes) {
  int width = 0, height = 0;
  if (!WebPGetInfo(bytes.data(), bytes.size(), &width, &height)) throw std::runtime_error("is a damaged WebP picture");
  check_size(width, height);
  const std::unique_ptr<uint8_t, decltype(&WebPFree)> rgba(WebPDecodeRGBA(bytes.data(), bytes.size(), &width, &height), WebPFree);
  if (!rgba) throw std::runtime_error("is a damaged WebP picture");
  return adopt(rgba.get(), width, height);
}

Image decode_with_stb(std::span<const uint8_t> bytes, const char* kind) {
  const std::string damaged = std::string("is a damaged ") + kind + " picture";
  if (bytes.size() > INT32_MAX) throw std::runtime_error("is too large");
  int width = 0, height = 0, channels = 0;
  const int size = static_cast<int>(bytes.size());
  if (!stbi_info_from_memory(bytes.data(), size, &width, &height, &channels)) throw std::runtime_error(damaged);
  check_size(width, height);
  const std::unique_ptr<stbi_uc, decltype(&std::free)> rgba(
      stbi_load_from_memory(bytes.data(), size, &width, &height, &channels, 4), std::free);
  if (!rgba) throw std::runtime_error(damaged);
  return adopt(rgba.get(), width, height);
}

}  // namespace

Image decode_picture(std::span<const uint8_t> bytes) {
  if (starts_with(bytes, "\x89PNG\r\n\x1a\n", 8)) return decode_with_stb(bytes, "PNG");
  if (starts_with(bytes, "\xff\xd8\xff", 3)) return decode_with_stb(bytes, "JPEG");
  if (bytes.size() >= 12 && starts_with(bytes, "RIFF", 4) && std::memcmp(bytes.data() + 8, "WEBP", 4) == 0)
    return decode_webp(bytes);
  throw std::runtime_error("is not a PNG, JPEG or WebP picture");
}

}  // namespace vitrine
