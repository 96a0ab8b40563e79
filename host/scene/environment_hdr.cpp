// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// A reader of our own: stb_image 2.27's ends in an endless loop where a run of length zero stands at the end of the file,
// and it knows neither EXPOSURE nor the older run lengths.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <string>

#include "host/scene/environment.h"

namespace vitrine {
namespace {

struct Rgbe {
  uint8_t r, g, b, e;
};

class HdrReader {
 public:
  explicit HdrReader(std::span<const uint8_t> bytes) : bytes_(bytes) {}

  Environment read() {
    read_header();
    read_size();
    const size_t w = static_cast<size_t>(width_), h = static_cast<size_t>(height_);
    if (bytes_.size() - at_ < h * 4) throw std::runtime_error("the file ends too early");  // the shortest row: a few runs
    Environment environment;
    environment.width = width_;
    environment.height = height_;
    environment.radiance.resize(w * h);
    std::vector<Rgbe> row(w);
    for (size_t y = 0; y < h; ++y) {
      read_row(row);
      for (size_t x = 0; x < w; ++x) environment.radiance[y * w + x] = radiance(row[x]);
    }
    return environment;
  }

 private:
  uint8_t byte() {
    if (at_ >= bytes_.size()) throw std::runtime_error("the file ends too early");
    return bytes_[at_++];
  }

  std::string line() {
    std::string text;
    for (char c = static_cast<char>(byte()); c != '\n'; c = static_cast<char>(byte()))
      if (text.size() < 4096) text += c;
    return text;
  }

  void read_header() {
    line();
    for (std::string text = line(); !text.empty(); text = line()) {
      if (text.rfind("FORMAT=", 0) == 0 && text != "FORMAT=32-bit_rle_rgbe")
        throw std::runtime_error("its pixel format is not RGBE");
      if (text.rfind("EXPOSURE=", 0) == 0) exposure_ *= std::strtof(text.c_str() + 9, nullptr);
    }
    if (!(exposure_ > 1e-12f && exposure_ < 1e12f)) throw std::runtime_error("its exposure makes no sense");
  }

  void read_size() {
    const std::string text = line();
    int used = 0;
    if (text.size() > 40 || std::sscanf(text.c_str(), "-Y %6d +X %6d%n", &height_, &width_, &used) != 2 ||
        static_cast<size_t>(used) != text.size())
      throw std::runtime_error("its rows are not stored from top to bottom, left to right");
    const bool good = width_ >= 1 && height_ >= 1 && width_ <= kLargestEnvironmentWidth && height_ <= kLargestEnvironmentHeight &&
                      int64_t{width_} * height_ <= kLargestEnvironment;
    if (!good) throw std::runtime_error("a size of " + std::to_string(width_) + " x " + std::to_string(height_) + " is not read");
  }

  void read_row(std::vector<Rgbe>& row) {
    const Rgbe first{byte(), byte(), byte(), byte()};
    const bool runs = row.size() >= 8 && row.size() < 32768 && first.r == 2 && first.g == 2 && first.b < 128;
    if (!runs) return read_old_row(row, first);
    if (static_cast<size_t>(first.b << 8 | first.e) != row.size()) throw std::runtime_error("a row has the wrong length");
    for (uint8_t Rgbe::*component : {&Rgbe::r, &Rgbe::g, &Rgbe::b, &Rgbe::e}) read_component(row, component);
  }

  void read_component(std::vector<Rgbe>& row, uint8_t Rgbe::*component) {
    for (size_t x = 0; x < row.size();) {
      const uint8_t code = byte();
      const bool same = code > 128;
      const size_t count = same ? code - 128u : code;
      if (count == 0 || count > row.size() - x) throw std::runtime_error("a run has the wrong length");
      const uint8_t value = same ? byte() : uint8_t{0};
      for (size_t i = 0; i < count; ++i) row[x++].*component = same ? value : byte();
    }
  }

  // Pixels as they are; (1, 1, 1, n) repeats the one before, successive ones count higher bytes.
  void read_old_row(std::vector<Rgbe>& row, Rgbe pixel) {
    int shift = 0;
    for (size_t x = 0; x < row.size();) {
      if (pixel.r == 1 && pixel.g == 1 && pixel.b == 1) {
        const size_t count = static_cast<size_t>(pixel.e) << shift;
        if (x == 0 || shift > 16 || count > row.size() - x) throw std::runtime_error("a run has the wrong length");
        std::fill_n(row.begin() + static_cast<std::ptrdiff_t>(x), count, row[x - 1]);
        x += count;
        shift += 8;
      } else {
        row[x++] = pixel;
        shift = 0;
      }
      if (x < row.size()) pixel = {byte(), byte(), byte(), byte()};
    }
  }

  glm::vec3 radiance(const Rgbe& p) const {
    if (p.e == 0) return glm::vec3(0);
    return glm::vec3(p.r, p.g, p.b) * (std::ldexp(1.0f, static_cast<int>(p.e) - 136) / exposure_);
  }

  std::span<const uint8_t> bytes_;
  size_t at_ = 0;
  int width_ = 0, height_ = 0;
  float exposure_ = 1;
};

}  // namespace

Environment decode_radiance_hdr(std::span<const uint8_t> bytes) { return HdrReader(bytes).read(); }

}  // namespace vitrine
