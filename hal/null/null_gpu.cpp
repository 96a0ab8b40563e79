// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "hal/null/null_gpu.h"

#include <algorithm>

#include "hal/backends.h"
#include "hal/gpu_checks.h"

namespace vitrine::hal {
namespace {

uint64_t bytes_of(const TextureDesc& desc) {
  uint64_t texels = 0;
  for (int l = 0; l < desc.levels; ++l)
    texels += static_cast<uint64_t>(level_size(desc.width, l)) * static_cast<uint64_t>(level_size(desc.height, l));
  return texels * static_cast<uint64_t>(bytes_per_texel(desc.format));
}

}  // namespace

Status NullGpu::do_create_texture(TextureSlot& slot) {
  ++counts_.textures;
  counts_.texture_bytes += bytes_of(slot.desc);
  return {};
}

Status NullGpu::do_update_texture(const TextureSlot&, const Rectangle&, std::span<const std::byte> texels) {
  ++counts_.updates;
  counts_.update_bytes += texels.size();
  return {};
}

Status NullGpu::do_create_mesh(MeshSlot&, const MeshDesc&) { return ++counts_.meshes, Status{}; }
Status NullGpu::do_create_program(ProgramSlot&, const ProgramDesc&) { return ++counts_.programs, Status{}; }
Status NullGpu::do_create_target(TargetSlot&, TextureSlot&) { return ++counts_.targets, Status{}; }

void NullGpu::do_destroy_texture(TextureSlot& slot) {
  --counts_.textures;
  counts_.texture_bytes -= bytes_of(slot.desc);
}

void NullGpu::do_destroy_mesh(MeshSlot&) { --counts_.meshes; }
void NullGpu::do_destroy_program(ProgramSlot&) { --counts_.programs; }
void NullGpu::do_destroy_target(TargetSlot&, TextureSlot&) { --counts_.targets; }

Status NullGpu::do_begin_pass(const PassDesc&, const TargetSlot*) { return ++counts_.passes, Status{}; }

Status NullGpu::do_draw(const Draw& draw, const ProgramSlot&, const MeshSlot*, std::span<const TextureSlot* const>) {
  ++counts_.draws;
  counts_.indices += draw.index_count;
  return {};
}

Status NullGpu::do_read_pixels(const TargetSlot*, TextureFormat, int, int, std::span<std::byte> pixels) {
  ++counts_.reads;
  std::fill(pixels.begin(), pixels.end(), std::byte{0});
  return {};
}

Status NullGpu::do_present() { return ++counts_.presents, Status{}; }

std::unique_ptr<Gpu> create_null_gpu(int width, int height) { return std::make_unique<NullGpu>(width, height); }

}  // namespace vitrine::hal
