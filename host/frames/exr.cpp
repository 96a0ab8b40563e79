// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/frames/exr.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <OpenEXR/ImfOutputPart.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStringVectorAttribute.h>
#include <half.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <set>

namespace vitrine {
namespace {

constexpr int kMaxSize = 1 << 15;  // of a side
constexpr size_t kMaxChannels = 4096;

class MemoryOutput : public Imf::OStream {
 public:
  MemoryOutput() : OStream("memory") {}
  void write(const char data[], int count) override {
    const auto n = static_cast<size_t>(count);
    if (position_ + n > bytes.size()) bytes.resize(position_ + n);
    std::memcpy(bytes.data() + position_, data, n);
    position_ += n;
  }
  uint64_t tellp() override { return position_; }
  void seekp(uint64_t position) override { position_ = position; }
  std::string bytes;

 private:
  size_t position_ = 0;
};

class MemoryInput : public Imf::IStream {
 public:
  explicit MemoryInput(const std::string& bytes) : IStream("memory"), bytes_(bytes) {}
  bool read(char data[], int count) override {
    const auto n = static_cast<size_t>(std::max(count, 0));
    if (position_ > bytes_.size() || n > bytes_.size() - position_) throw std::runtime_error("cut short");
    std::memcpy(data, bytes_.data() + position_, n);
    position_ += n;
    return position_ < bytes_.size();
  }
  uint64_t tellg() override { return position_; }
  void seekg(uint64_t position) override { position_ = position; }

 private:
  const std::string& bytes_;
  size_t position_ = 0;
};

half half_from(float value) {
  if (std::isnan(value)) return half(0.0f);
  return half(std::clamp(value, -static_cast<float>(HALF_MAX), static_cast<float>(HALF_MAX)));
}

Imath::Box2i window_of(const ExrPart& part) { return {{part.x, part.y}, {part.x + part.width - 1, part.y + part.height - 1}}; }

Imf::Header header_of(const ExrFile& file, const ExrPart& part) {
  const Imath::Box2i display({0, 0}, {file.width - 1, file.height - 1});
  Imf::Header header(display, window_of(part));
  header.compression() = Imf::ZIP_COMPRESSION;
  header.setName(part.name);
  header.setType(Imf::SCANLINEIMAGE);
  header.insert("vitrineObject", Imf::IntAttribute(part.tag));
  Imf::StringVector order;
  for (const ExrChannel& c : part.channels) {
    header.channels().insert(c.name, Imf::Channel(Imf::HALF));
    order.push_back(c.name);
  }
  header.insert("vitrineChannels", Imf::StringVectorAttribute(order));
  return header;
}

// Half planes of all channels of a part, one after the other, and the frame buffer over them.
struct Planes {
  std::vector<half> values;
  Imf::FrameBuffer buffer;

  explicit Planes(const ExrPart& part) : values(part.channels.size() * pixels(part)) {
    for (size_t c = 0; c < part.channels.size(); ++c) {
      half* plane = values.data() + c * pixels(part);
      buffer.insert(part.channels[c].name, Imf::Slice::Make(Imf::HALF, plane, window_of(part), sizeof(half),
                                                            sizeof(half) * static_cast<size_t>(part.width)));
    }
  }
  static size_t pixels(const ExrPart& part) { return static_cast<size_t>(part.width) * static_cast<size_t>(part.height); }
};

void write_part(Imf::MultiPartOutputFile& output, int index, const ExrPart& part) {
  Planes planes(part);
  for (size_t c = 0; c < part.channels.size(); ++c) {
    const auto& values = part.channels[c].values;
    if (values.size() != Planes::pixels(part)) throw std::invalid_argument("a channel's size is not that of its part");
    std::transform(values.begin(), values.end(), planes.values.begin() + static_cast<ptrdiff_t>(c * values.size()), half_from);
  }
  Imf::OutputPart writer(output, index);
  writer.setFrameBuffer(planes.buffer);
  writer.writePixels(part.height);
}

// A part's header as an ExrPart without values; throws where it is not one of ours.
ExrPart part_from_header(const Imf::Header& header, size_t available) {
  const auto refuse = [] { throw std::runtime_error("not a file of the store"); };
  const Imath::Box2i window = header.dataWindow(), display = header.displayWindow();
  if (display.min.x != 0 || display.min.y != 0 || display.max.x >= kMaxSize || display.max.y >= kMaxSize) refuse();
  if (window.min.x < 0 || window.min.y < 0 || window.max.x > display.max.x || window.max.y > display.max.y) refuse();
  if (window.min.x > window.max.x || window.min.y > window.max.y) refuse();
  const auto* tag = header.findTypedAttribute<Imf::IntAttribute>("vitrineObject");
  const auto* order = header.findTypedAttribute<Imf::StringVectorAttribute>("vitrineChannels");
  if (!tag || !order || !header.hasName() || order->value().size() > kMaxChannels) refuse();
  ExrPart part{header.name(),
               tag->value(),
               window.min.x,
               window.min.y,
               window.max.x - window.min.x + 1,
               window.max.y - window.min.y + 1,
               {}};
  // ZIP shrinks by 1032 at most (deflate), so headers that promise more than that are lies.
  if (Planes::pixels(part) * order->value().size() * sizeof(half) / 1100 > available) refuse();
  for (const std::string& name : order->value()) {
    const Imf::Channel* channel = header.channels().findChannel(name);
    if (!channel || channel->type != Imf::HALF || channel->xSampling != 1 || channel->ySampling != 1) refuse();
    part.channels.push_back({name, {}});
  }
  if (std::set<std::string>(order->value().begin(), order->value().end()).size() != order->value().size()) refuse();
  return part;
}

ExrPart read_part(Imf::MultiPartInputFile& input, int index, size_t available) {
  ExrPart part = part_from_header(input.header(index), available);
  Planes planes(part);
  Imf::InputPart reader(input, index);
  reader.setFrameBuffer(planes.buffer);
  reader.readPixels(part.y, part.y + part.height - 1);
  for (size_t c = 0; c < part.channels.size(); ++c) {
    const half* plane = planes.values.data() + c * Planes::pixels(part);
    part.channels[c].values.assign(plane, plane + Planes::pixels(part));
  }
  return part;
}

}  // namespace

std::string encode_exr(const ExrFile& file) {
  std::vector<Imf::Header> headers;
  for (const ExrPart& part : file.parts) headers.push_back(header_of(file, part));
  MemoryOutput stream;
  {
    Imf::MultiPartOutputFile output(stream, headers.data(), static_cast<int>(headers.size()), false, 0);
    for (size_t p = 0; p < file.parts.size(); ++p) write_part(output, static_cast<int>(p), file.parts[p]);
  }
  return std::move(stream.bytes);
}

std::optional<ExrFile> decode_exr(const std::string& bytes) try {
  // Before any header is believed: OpenEXR makes room for a line table as tall as a header claims.
  static const bool bounded = (Imf::Header::setMaxImageSize(kMaxSize, kMaxSize), true);
  static_cast<void>(bounded);
  MemoryInput stream(bytes);
  Imf::MultiPartInputFile input(stream, 0, false);
  ExrFile file;
  for (int p = 0; p < input.parts(); ++p) file.parts.push_back(read_part(input, p, bytes.size()));
  if (file.parts.empty()) return {};
  file.width = input.header(0).displayWindow().max.x + 1;
  file.height = input.header(0).displayWindow().max.y + 1;
  for (int p = 1; p < input.parts(); ++p) {
    if (input.header(p).displayWindow() != input.header(0).displayWindow()) return {};
  }
  return file;
} catch (const std::exception&) {
  return {};  // whatever OpenEXR found wrong: the file counts as absent
}

}  // namespace vitrine
