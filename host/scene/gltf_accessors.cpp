// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/scene/gltf_accessors.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "host/scene/text.h"

namespace vitrine {
namespace {

enum : int { kByte = 5120, kUnsignedByte = 5121, kShort = 5122, kUnsignedShort = 5123, kUnsignedInt = 5125, kFloat = 5126 };

size_t component_size(const JsonView& place, int type) {
  switch (type) {
    case kByte:
    case kUnsignedByte:
      return 1;
    case kShort:
    case kUnsignedShort:
      return 2;
    case kUnsignedInt:
    case kFloat:
      return 4;
    default:
      place.fail(fmt::format("{} is not a component type", type));
  }
}

int component_count(const JsonView& place, const std::string& type) {
  if (type == "SCALAR") return 1;
  if (type == "VEC2") return 2;
  if (type == "VEC3") return 3;
  if (type == "VEC4") return 4;
  if (type == "MAT4") return 16;
  place.fail("its type " + in_quotes(type) + " is not one that is read here");
}

template <typename T>
T load(const uint8_t* at) {
  T value;
  std::memcpy(&value, at, sizeof(T));
  return value;
}

double load_component(const uint8_t* at, int type) {
  switch (type) {
    case kByte:
      return load<int8_t>(at);
    case kUnsignedByte:
      return load<uint8_t>(at);
    case kShort:
      return load<int16_t>(at);
    case kUnsignedShort:
      return load<uint16_t>(at);
    case kUnsignedInt:
      return load<uint32_t>(at);
    default:
      return static_cast<double>(load<float>(at));
  }
}

double largest_of(int type) {
  switch (type) {
    case kByte:
      return 127;
    case kUnsignedByte:
      return 255;
    case kShort:
      return 32767;
    case kUnsignedShort:
      return 65535;
    default:
      return 1;
  }
}

constexpr uint8_t kZeros[64] = {};  // one element of any accessor without a buffer view

}  // namespace

class AccessorOpener {
 public:
  AccessorOpener(GltfDocument& document, int index)
      : document_(document), index_(index), place_(document.element("accessors", index)), accessor_(place_) {}

  Accessor open() {
    accessor_.type_ = static_cast<int>(place_.at("componentType").integer(0, 65535));
    component_size_ = component_size(place_, accessor_.type_);
    accessor_.components_ = component_count(place_, place_.at("type").text());
    element_size_ = component_size_ * static_cast<size_t>(accessor_.components_);
    accessor_.count_ = static_cast<size_t>(place_.at("count").integer(1, kMostElements));
    accessor_.normalized_ = place_.boolean_or("normalized", false) && accessor_.type_ != kFloat;
    if (accessor_.normalized_ && accessor_.type_ == kUnsignedInt) place_.fail("32-bit integers cannot be normalized");
    bind_base();
    if (place_.find("sparse")) bind_sparse();
    return accessor_;
  }

 private:
  void bind_base() {
    accessor_.data_ = kZeros;
    accessor_.stride_ = 0;
    const int view = place_.index_or_none("bufferView", "bufferViews", document_.count("bufferViews"));
    if (view < 0) return;
    const size_t stride = document_.buffer_view_stride(view);
    accessor_.stride_ = stride ? stride : element_size_;
    const size_t offset = static_cast<size_t>(place_.integer_or("byteOffset", 0, 0, INT64_C(1) << 40));
    accessor_.data_ = range(place_, view, offset, accessor_.stride_, accessor_.count_, element_size_);
  }

  // The first byte of `count` elements in a buffer view, all of them within it.
  const uint8_t* range(const JsonView& place, int view, size_t offset, size_t stride, size_t count, size_t size) {
    const std::span<const uint8_t> bytes = document_.buffer_view(view);
    if (stride < size) place.fail(fmt::format("its stride of {} bytes is less than its element of {}", stride, size));
    const size_t end = offset + stride * (count - 1) + size;  // below 2^40 + 252 * 6e7: no overflow
    if (end > bytes.size())
      place.fail(fmt::format("its bytes {} to {} lie outside its buffer view of {}", offset, end, bytes.size()));
    return bytes.data() + offset;
  }

  void bind_sparse() {
    std::shared_ptr<const Bytes>& cached = document_.sparse_cache[index_];
    if (!cached) cached = std::make_shared<const Bytes>(decode_sparse(place_.at("sparse")));
    accessor_.owned_ = cached;
    accessor_.data_ = cached->data();
    accessor_.stride_ = element_size_;
  }

  Bytes decode_sparse(const JsonView& sparse) {
    const size_t count = static_cast<size_t>(sparse.at("count").integer(1, static_cast<int64_t>(accessor_.count_)));
    const JsonView indices = sparse.at("indices"), values = sparse.at("values");
    const int type = static_cast<int>(indices.at("componentType").integer(0, 65535));
    if (type != kUnsignedByte && type != kUnsignedShort && type != kUnsignedInt) indices.fail("has no unsigned component type");
    const size_t index_size = component_size(indices, type);
    const uint8_t* index_at = sparse_range(indices, index_size, count);
    const uint8_t* value_at = sparse_range(values, element_size_, count);
    document_.charge(accessor_.count_ * element_size_, place_);
    Bytes bytes(accessor_.count_ * element_size_);
    for (size_t i = 0; i < accessor_.count_; ++i)
      std::memcpy(bytes.data() + i * element_size_, accessor_.data_ + i * accessor_.stride_, element_size_);
    double previous = -1;
    for (size_t i = 0; i < count; ++i) {
      const double target = load_component(index_at + i * index_size, type);
      if (target <= previous || target >= static_cast<double>(accessor_.count_))
        indices.fail("must ascend and stay below the accessor's count");
      std::memcpy(bytes.data() + static_cast<size_t>(target) * element_size_, value_at + i * element_size_, element_size_);
      previous = target;
    }
    return bytes;
  }

  const uint8_t* sparse_range(const JsonView& part, size_t size, size_t count) {
    const int view = part.index_or_none("bufferView", "bufferViews", document_.count("bufferViews"));
    if (view < 0) part.fail("names no buffer view");
    const size_t offset = static_cast<size_t>(part.integer_or("byteOffset", 0, 0, INT64_C(1) << 40));
    return range(part, view, offset, size, count, size);
  }

  GltfDocument& document_;
  int index_;
  JsonView place_;
  Accessor accessor_;
  size_t component_size_ = 0, element_size_ = 0;
};

float Accessor::value(size_t i, int c) const {
  static constexpr int kSizes[] = {1, 1, 2, 2, 0, 4, 4};
  const double raw = load_component(data_ + i * stride_ + static_cast<size_t>(c * kSizes[type_ - kByte]), type_);
  if (!std::isfinite(raw)) place_.fail(fmt::format("element {} is not a finite number", i));
  return static_cast<float>(normalized_ ? std::max(-1.0, raw / largest_of(type_)) : raw);
}

uint32_t Accessor::integer(size_t i, int c) const {
  const uint8_t* at = data_ + i * stride_;
  switch (type_) {
    case kUnsignedByte:
      return at[c];
    case kUnsignedShort:
      return load<uint16_t>(at + 2 * c);
    default:
      return load<uint32_t>(at + 4 * c);
  }
}

Accessor open_accessor(GltfDocument& document, const JsonView& reference, int least, int most) {
  const int64_t index = reference.integer(0, INT32_MAX);
  const size_t count = document.count("accessors");
  if (static_cast<size_t>(index) >= count) reference.fail(fmt::format("is {}, but there are {} accessors", index, count));
  Accessor accessor = AccessorOpener(document, static_cast<int>(index)).open();
  if (accessor.components_ < least || accessor.components_ > most)
    reference.fail(fmt::format("accessor {} has {} components, needed are {}", index, accessor.components_, least));
  return accessor;
}

Accessor open_indices(GltfDocument& document, const JsonView& reference) {
  const Accessor accessor = open_accessor(document, reference, 1, 1);
  const int64_t type =
      document.element("accessors", static_cast<int>(reference.integer(0, INT32_MAX))).at("componentType").integer(0, 65535);
  if (type != kUnsignedByte && type != kUnsignedShort && type != kUnsignedInt)
    reference.fail("indices must be unsigned integers");
  return accessor;
}

Accessor open_joints(GltfDocument& document, const JsonView& reference) {
  const Accessor accessor = open_accessor(document, reference, 4, 4);
  const int64_t type =
      document.element("accessors", static_cast<int>(reference.integer(0, INT32_MAX))).at("componentType").integer(0, 65535);
  if (type != kUnsignedByte && type != kUnsignedShort) reference.fail("joints must be unsigned bytes or shorts");
  return accessor;
}

std::vector<float> read_floats(GltfDocument& document, const JsonView& reference, int components) {
  const Accessor accessor = open_accessor(document, reference, components, components);
  document.charge(accessor.size() * static_cast<size_t>(components) * 4, reference);
  std::vector<float> values;
  values.reserve(accessor.size() * static_cast<size_t>(components));
  for (size_t i = 0; i < accessor.size(); ++i)
    for (int c = 0; c < components; ++c) values.push_back(accessor.value(i, c));
  return values;
}

}  // namespace vitrine
