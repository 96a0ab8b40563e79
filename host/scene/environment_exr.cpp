// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include <ImfChannelList.h>
#include <ImfEnvmap.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfStandardAttributes.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <string>

#include "host/scene/environment.h"
#include "host/scene/exr_header.h"

namespace vitrine {
namespace {

// Floats of one channel, rows top down.
struct Picture {
  Imath::Box2i window;
  int width = 0, height = 0;
  std::vector<glm::vec3> rgb;
  const glm::vec3& at(int x, int y) const {
    return rgb[static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x)];
  }
};

// The file in memory, as the library wants it.
class MemoryStream : public Imf::IStream {
 public:
  explicit MemoryStream(std::span<const uint8_t> bytes) : Imf::IStream("light probe"), bytes_(bytes) {}
  bool read(char* to, int n) override {
    if (n < 0 || static_cast<size_t>(n) > bytes_.size() - at_) throw std::runtime_error("the file ends too early");
    std::memcpy(to, bytes_.data() + at_, static_cast<size_t>(n));
    at_ += static_cast<size_t>(n);
    return at_ < bytes_.size();
  }
  uint64_t tellg() override { return at_; }
  void seekg(uint64_t at) override {
    if (at > bytes_.size()) throw std::runtime_error("the file ends too early");
    at_ = static_cast<size_t>(at);
  }

 private:
  std::span<const uint8_t> bytes_;
  size_t at_ = 0;
};

// R, G, B, or Y alone as grey.
Imf::FrameBuffer frame_buffer_for(const Imf::Header& header, Picture& picture) {
  const Imf::ChannelList& channels = header.channels();
  const bool colour = channels.findChannel("R") && channels.findChannel("G") && channels.findChannel("B");
  const bool grey = channels.findChannel("Y") && !channels.findChannel("RY");
  if (!colour && !grey) throw std::runtime_error("it has no channels R, G, B");
  const char* names[] = {colour ? "R" : "Y", "G", "B"};
  Imf::FrameBuffer buffer;
  const size_t stride = sizeof(glm::vec3), row = stride * static_cast<size_t>(picture.width);
  for (int c = 0; c < (colour ? 3 : 1); ++c) {
    const Imf::Channel* channel = channels.findChannel(names[c]);
    if (channel->xSampling != 1 || channel->ySampling != 1) throw std::runtime_error("its channels are subsampled");
    buffer.insert(names[c], Imf::Slice::Make(Imf::FLOAT, &picture.rgb[0][c], picture.window, stride, row));
  }
  return buffer;
}

Picture read_picture(Imf::InputFile& file) {
  Picture picture;
  picture.window = file.header().dataWindow();
  picture.width = picture.window.max.x - picture.window.min.x + 1;
  picture.height = picture.window.max.y - picture.window.min.y + 1;
  picture.rgb.assign(static_cast<size_t>(picture.width) * static_cast<size_t>(picture.height), glm::vec3(0));
  const Imf::FrameBuffer buffer = frame_buffer_for(file.header(), picture);
  file.setFrameBuffer(buffer);
  file.readPixels(picture.window.min.y, picture.window.max.y);
  if (!buffer.findSlice("G"))
    for (glm::vec3& texel : picture.rgb) texel = glm::vec3(texel.x);
  return picture;
}

// Bilinear within one face.
glm::vec3 lookup_cube(const Picture& picture, const glm::vec3& d) {
  const int size = picture.width;
  const Imath::Box2i window(Imath::V2i(0, 0), Imath::V2i(size - 1, 6 * size - 1));
  Imf::CubeMapFace face = Imf::CUBEFACE_POS_X;
  Imath::V2f inside;
  Imf::CubeMap::faceAndPixelPosition(Imath::V3f(d.x, d.y, d.z), window, face, inside);
  const auto texel = [&](int x, int y) {
    const Imath::V2f p = Imf::CubeMap::pixelPosition(face, window, Imath::V2f(static_cast<float>(x), static_cast<float>(y)));
    return picture.at(std::clamp(static_cast<int>(p.x + 0.5f), 0, size - 1),
                      std::clamp(static_cast<int>(p.y + 0.5f), 0, 6 * size - 1));
  };
  const int x0 = std::clamp(static_cast<int>(inside.x), 0, size - 1), y0 = std::clamp(static_cast<int>(inside.y), 0, size - 1);
  const int x1 = std::min(x0 + 1, size - 1), y1 = std::min(y0 + 1, size - 1);
  const float fx = std::clamp(inside.x - static_cast<float>(x0), 0.0f, 1.0f),
              fy = std::clamp(inside.y - static_cast<float>(y0), 0.0f, 1.0f);
  return (texel(x0, y0) * (1 - fx) + texel(x1, y0) * fx) * (1 - fy) + (texel(x0, y1) * (1 - fx) + texel(x1, y1) * fx) * fy;
}

// A quarter turn of the lat-long map gets as many columns as a face has.
Environment latlong_from_cube(const Picture& picture) {
  if (picture.height != 6 * picture.width) throw std::runtime_error("a cube map must be six times as high as wide");
  Environment environment;
  environment.width = std::clamp(4 * picture.width, 8, 4096);
  environment.height = environment.width / 2;
  for (int y = 0; y < environment.height; ++y)
    for (int x = 0; x < environment.width; ++x) {
      const glm::vec2 uv(static_cast<float>(x) / static_cast<float>(environment.width - 1),
                         static_cast<float>(y) / static_cast<float>(environment.height - 1));
      environment.radiance.push_back(lookup_cube(picture, direction_from_latlong(uv)));
    }
  return environment;
}

bool is_cube(const Imf::Header& header, const Picture& picture) {
  if (Imf::hasEnvmap(header)) return Imf::envmap(header) == Imf::ENVMAP_CUBE;
  return picture.height == 6 * picture.width;
}

}  // namespace

Environment decode_exr(std::span<const uint8_t> bytes) {
  check_exr_header(bytes);
  MemoryStream stream(bytes);
  Imf::InputFile file(stream, 0);
  Picture picture = read_picture(file);
  if (is_cube(file.header(), picture)) return latlong_from_cube(picture);
  Environment environment;
  environment.width = picture.width;
  environment.height = picture.height;
  environment.radiance = std::move(picture.rgb);
  return environment;
}

}  // namespace vitrine
