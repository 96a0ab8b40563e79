// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// A device that draws nothing, fast. It refuses what every other backend refuses and counts the rest, so that playback logic
// can be tested without pixels.
#pragma once

#include "hal/checked_gpu.h"

namespace vitrine::hal {

struct GpuCounts {
  int64_t textures = 0, meshes = 0, programs = 0, targets = 0;  // alive now (a target's colour is not a texture here)
  int64_t updates = 0, passes = 0, draws = 0, indices = 0, reads = 0, presents = 0;
  uint64_t texture_bytes = 0;  // alive now, all levels
  uint64_t update_bytes = 0;   // since the start
};

class NullGpu final : public CheckedGpu {
 public:
  NullGpu(int width, int height) : width_(width), height_(height) {}
  DeviceInfo info() const override { return {"null", true, 16384}; }
  int width() const override { return width_; }
  int height() const override { return height_; }
  const GpuCounts& counts() const { return counts_; }

 private:
  Status do_create_texture(TextureSlot& slot) override;
  Status do_update_texture(const TextureSlot& slot, const Rectangle& rectangle, std::span<const std::byte> texels) override;
  Status do_create_mesh(MeshSlot& slot, const MeshDesc& desc) override;
  Status do_create_program(ProgramSlot& slot, const ProgramDesc& desc) override;
  Status do_create_target(TargetSlot& slot, TextureSlot& color) override;
  void do_destroy_texture(TextureSlot& slot) override;
  void do_destroy_mesh(MeshSlot& slot) override;
  void do_destroy_program(ProgramSlot& slot) override;
  void do_destroy_target(TargetSlot& slot, TextureSlot& color) override;
  Status do_begin_pass(const PassDesc& desc, const TargetSlot* target) override;
  Status do_draw(const Draw& draw, const ProgramSlot& program, const MeshSlot* mesh,
                 std::span<const TextureSlot* const> textures) override;
  Status do_end_pass() override { return {}; }
  Status do_read_pixels(const TargetSlot* target, TextureFormat format, int width, int height,
                        std::span<std::byte> pixels) override;
  Status do_present() override;

  int width_, height_;
  GpuCounts counts_;
};

}  // namespace vitrine::hal
