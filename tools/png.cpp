// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "tools/png.h"

#include "hal/storage.h"

#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STBI_WRITE_NO_STDIO
#include <stb/stb_image_write.h>

namespace vitrine {

std::vector<uint8_t> rgb_from_read_back(int width, int height, std::span<const uint8_t> rgba) {
  std::vector<uint8_t> rgb;
  rgb.reserve(3 * static_cast<size_t>(width) * static_cast<size_t>(height));
  for (int y = height - 1; y >= 0; --y)
    for (int x = 0; x < width; ++x) {
      const uint8_t* texel = rgba.data() + 4 * (static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x));
      rgb.insert(rgb.end(), texel, texel + 3);
    }
  return rgb;
}

std::vector<std::byte> png_of(int width, int height, std::span<const uint8_t> rgb) {
  std::vector<std::byte> file;
  const auto append = [](void* to, void* data, int size) {
    const auto* bytes = static_cast<const std::byte*>(data);
    static_cast<std::vector<std::byte>*>(to)->insert(static_cast<std::vector<std::byte>*>(to)->end(), bytes, bytes + size);
  };
  if (!stbi_write_png_to_func(append, &file, width, height, 3, rgb.data(), 3 * width)) file.clear();
  return file;
}

Status write_png(const std::string& path, int width, int height, std::span<const uint8_t> rgb) {
  const std::vector<std::byte> file = png_of(width, height, rgb);
  if (file.empty()) return {StatusCode::kOutOfMemory, "the picture cannot be coded as PNG"};
  return hal::write_file_atomically(path.c_str(), file);
}

}  // namespace vitrine
