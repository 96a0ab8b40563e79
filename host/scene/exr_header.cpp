// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/scene/exr_header.h"

#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

#include "host/scene/environment.h"

namespace vitrine {
namespace {

constexpr uint32_t kDeepFlag = 0x800, kMultiPartFlag = 0x1000;
constexpr int kMostChannels = 32;
constexpr uint32_t kLargestTile = 4096;

class HeaderReader {
 public:
  explicit HeaderReader(std::span<const uint8_t> file) : file_(file) {}

  void check() {
    if (u32() != 0x01312F76) throw std::runtime_error("it is no OpenEXR file");
    const uint32_t version = u32();
    if ((version & 0xFF) != 2) throw std::runtime_error("its OpenEXR version is not 2");
    if (version & (kDeepFlag | kMultiPartFlag)) throw std::runtime_error("a deep or multi-part file is no light probe");
    for (std::string_view name = text(); !name.empty(); name = text()) read_attribute(name);
    if (!width_) throw std::runtime_error("it has no data window");
    const uint64_t tiles = tile_area_ ? static_cast<uint64_t>(*width_ * height_) / *tile_area_ : 0;
    if (tiles > file_.size() / 8) throw std::runtime_error("it promises more tiles than it has bytes for");
  }

 private:
  std::span<const uint8_t> take(size_t size) {
    if (size > file_.size() - at_) throw std::runtime_error("its header is cut short");
    const std::span<const uint8_t> bytes = file_.subspan(at_, size);
    at_ += size;
    return bytes;
  }

  uint32_t u32() {
    const std::span<const uint8_t> b = take(4);
    return b[0] | b[1] << 8 | b[2] << 16 | static_cast<uint32_t>(b[3]) << 24;
  }

  std::string_view text() {
    const size_t begin = at_;
    while (take(1)[0] != 0) {
    }
    if (at_ - begin > 256) throw std::runtime_error("a name in its header is too long");
    return {reinterpret_cast<const char*>(file_.data()) + begin, at_ - begin - 1};
  }

  void read_attribute(std::string_view name) {
    const std::string_view type = text();
    const uint32_t size = u32();
    const size_t begin = at_;
    take(size);  // must be there
    const size_t end = at_;
    at_ = begin;
    if (name == "dataWindow" && type == "box2i" && size == 16) read_window();
    if (name == "tiles" && type == "tiledesc" && size == 9) read_tiles();
    if (name == "channels" && type == "chlist") read_channels(end);
    at_ = end;
  }

  void read_window() {
    const int64_t x0 = static_cast<int32_t>(u32()), y0 = static_cast<int32_t>(u32()), x1 = static_cast<int32_t>(u32()),
                  y1 = static_cast<int32_t>(u32());
    const int64_t width = x1 - x0 + 1, height = y1 - y0 + 1;
    const bool good = width >= 1 && height >= 1 && width <= kLargestEnvironmentWidth && height <= 6 * kLargestEnvironmentHeight &&
                      width * height <= kLargestEnvironment;
    if (!good) throw std::runtime_error("a size of " + std::to_string(width) + " x " + std::to_string(height) + " is not read");
    width_ = width;
    height_ = height;
  }

  // Attributes are sorted as the writer liked: tiles may stand before or after the window.
  void read_tiles() {
    const uint32_t x = u32(), y = u32();
    if (x < 1 || y < 1 || x > kLargestTile || y > kLargestTile) throw std::runtime_error("its tiles have no size that is read");
    tile_area_ = uint64_t{x} * y;
  }

  void read_channels(size_t end) {
    for (int count = 0; at_ < end && !text().empty(); ++count) {
      if (count >= kMostChannels) throw std::runtime_error("it has more than 32 channels");
      take(16);
    }
  }

  std::span<const uint8_t> file_;
  size_t at_ = 0;
  std::optional<int64_t> width_;
  int64_t height_ = 0;
  std::optional<uint64_t> tile_area_;
};

}  // namespace

void check_exr_header(std::span<const uint8_t> file) { HeaderReader(file).check(); }

}  // namespace vitrine
