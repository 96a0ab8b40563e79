// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "hal/gpu_checks.h"

#include <algorithm>
#include <bit>
#include <limits>

namespace vitrine::hal {
namespace {

Status impossible(const char* detail) { return {StatusCode::kMalformed, detail}; }

Status check_size(int width, int height, int max_size) {
  if (width < 1 || height < 1) return impossible("a texture needs at least one texel each way");
  if (width > max_size || height > max_size) return {StatusCode::kUnsupported, "the texture is larger than the device allows"};
  return {};
}

Status check_attribute(const VertexAttribute& attribute, int stride) {
  if (attribute.location < 0 || attribute.location >= kMaxAttributes)
    return impossible("vertex attribute location is not in 0..15");
  if (attribute.components < 1 || attribute.components > 4) return impossible("a vertex attribute has 1 to 4 floats");
  if (attribute.offset < 0 || attribute.offset % 4) return impossible("vertex attribute offset is not a multiple of 4");
  if (attribute.offset > stride - 4 * attribute.components) return impossible("a vertex attribute reaches beyond the vertex");
  return {};
}

Status check_attributes(const MeshDesc& desc) {
  uint32_t seen = 0;
  for (const VertexAttribute& attribute : desc.attributes) {
    if (Status status = check_attribute(attribute, desc.stride); !status.ok()) return status;
    if (seen >> attribute.location & 1) return impossible("two vertex attributes share a location");
    seen |= 1u << attribute.location;
  }
  return seen ? Status{} : impossible("a mesh needs a vertex attribute");
}

}  // namespace

int bytes_per_texel(TextureFormat format) {
  switch (format) {
    case TextureFormat::kRgba8:
      return 4;
    case TextureFormat::kRgba16f:
      return 8;
    case TextureFormat::kRgba32f:
      return 16;
  }
  return 0;
}

int level_count_of(int width, int height) { return std::bit_width(static_cast<unsigned>(std::max(width, height))); }

int level_size(int size, int level) { return std::max(1, size >> level); }

Status check_texture(const TextureDesc& desc, int max_texture_size) {
  if (Status status = check_size(desc.width, desc.height, max_texture_size); !status.ok()) return status;
  if (desc.levels < 1 || desc.levels > level_count_of(desc.width, desc.height))
    return impossible("texture level count is not within the full chain");
  if (!bytes_per_texel(desc.format)) return impossible("unknown texture format");
  if (desc.filter > TextureFilter::kTrilinear) return impossible("unknown texture filter");
  if (desc.wrap_u > TextureWrap::kRepeat || desc.wrap_v > TextureWrap::kRepeat) return impossible("unknown texture wrap");
  return {};
}

Status check_mesh(const MeshDesc& desc) {
  if (desc.stride < 4 || desc.stride > kMaxStride || desc.stride % 4)
    return impossible("vertex stride is not a multiple of 4 in 4..252");
  const size_t stride = static_cast<size_t>(desc.stride);
  if (desc.vertices.empty() || desc.vertices.size() % stride)
    return impossible("vertex bytes are not a whole number of vertices");
  if (desc.indices.empty() || desc.indices.size() % 3) return impossible("indices do not make whole triangles");
  if (desc.indices.size() > static_cast<size_t>(std::numeric_limits<int>::max())) return impossible("too many indices");
  if (Status status = check_attributes(desc); !status.ok()) return status;
  const uint32_t highest = *std::max_element(desc.indices.begin(), desc.indices.end());
  return highest < desc.vertices.size() / stride ? Status{} : impossible("an index names a vertex that is not there");
}

Status check_program(const ProgramDesc& desc) {
  if (!desc.vertex || !desc.fragment || !desc.fragment_library)
    return impossible("a program needs a vertex and a fragment shader");
  if (desc.samplers.size() > kMaxSamplers) return impossible("more than 8 samplers");
  for (const char* name : desc.samplers)
    if (!name || !*name) return impossible("a sampler has no name");
  if (desc.uniform_count < 0 || desc.uniform_count > kMaxUniforms) return impossible("uniform count is not in 0..192");
  return {};
}

Status check_target(const TargetDesc& desc, const DeviceInfo& device) {
  if (Status status = check_size(desc.width, desc.height, device.max_texture_size); !status.ok()) return status;
  if (!bytes_per_texel(desc.format)) return impossible("unknown target format");
  if (desc.format == TextureFormat::kRgba32f && !device.float_targets)
    return {StatusCode::kUnsupported, "the device cannot render to 32-bit floats"};
  return {};
}

}  // namespace vitrine::hal
