// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The half of a Gpu that all backends share: it owns the handles, validates every call in full, and hands the backend only
// what is sound. A backend fills in the do_ functions; `native` members are the backend's own names of the objects.
#pragma once

#include <unordered_map>

#include "hal/gpu.h"

namespace vitrine::hal {

class CheckedGpu : public Gpu {
 public:
  Result<Texture> create_texture(const TextureDesc& desc) final;
  Status update_texture(Texture texture, int level, int x, int y, int width, int height, std::span<const std::byte> texels) final;
  Result<Mesh> create_mesh(const MeshDesc& desc) final;
  Result<Program> create_program(const ProgramDesc& desc) final;
  Result<Target> create_target(const TargetDesc& desc) final;
  Texture color_of(Target target) final;
  void destroy(Texture texture) final;  // a target's own texture goes with its target only
  void destroy(Mesh mesh) final;
  void destroy(Program program) final;
  void destroy(Target target) final;
  Status begin_pass(const PassDesc& desc) final;
  Status draw(const Draw& draw) final;
  Status end_pass() final;
  Status read_pixels(Target target, TextureFormat format, std::span<std::byte> pixels) final;
  Status present() final;

 protected:
  struct TextureSlot {
    TextureDesc desc;
    uint32_t target = 0;  // whose colour this is, or 0
    uint32_t native = 0;
  };
  struct MeshSlot {
    uint32_t index_count = 0;
    uint32_t native_array = 0, native_vertices = 0, native_indices = 0;
  };
  struct ProgramSlot {
    size_t sampler_count = 0, uniform_count = 0;
    uint32_t native = 0;
    int32_t native_params = -1;
  };
  struct TargetSlot {
    TargetDesc desc;
    Texture color;
    uint32_t native = 0, native_depth = 0;
  };
  struct Rectangle {
    int level, x, y, width, height;
  };

  // On failure a create has left nothing behind.
  virtual Status do_create_texture(TextureSlot& slot) = 0;
  virtual Status do_update_texture(const TextureSlot& slot, const Rectangle& rectangle, std::span<const std::byte> texels) = 0;
  virtual Status do_create_mesh(MeshSlot& slot, const MeshDesc& desc) = 0;
  virtual Status do_create_program(ProgramSlot& slot, const ProgramDesc& desc) = 0;
  virtual Status do_create_target(TargetSlot& slot, TextureSlot& color) = 0;
  virtual void do_destroy_texture(TextureSlot& slot) = 0;
  virtual void do_destroy_mesh(MeshSlot& slot) = 0;
  virtual void do_destroy_program(ProgramSlot& slot) = 0;
  virtual void do_destroy_target(TargetSlot& slot, TextureSlot& color) = 0;
  // `target` null: the context's own framebuffer. `mesh` null: the triangle that covers the target.
  virtual Status do_begin_pass(const PassDesc& desc, const TargetSlot* target) = 0;
  virtual Status do_draw(const Draw& draw, const ProgramSlot& program, const MeshSlot* mesh,
                         std::span<const TextureSlot* const> textures) = 0;
  virtual Status do_end_pass() = 0;
  virtual Status do_read_pixels(const TargetSlot* target, TextureFormat format, int width, int height,
                                std::span<std::byte> pixels) = 0;
  virtual Status do_present() = 0;

 private:
  const TextureSlot* sampled(Texture texture) const;
  Status check_draw(const Draw& draw) const;

  std::unordered_map<uint32_t, TextureSlot> textures_;
  std::unordered_map<uint32_t, MeshSlot> meshes_;
  std::unordered_map<uint32_t, ProgramSlot> programs_;
  std::unordered_map<uint32_t, TargetSlot> targets_;
  uint32_t last_id_ = 0;
  bool in_pass_ = false;
  uint32_t pass_target_ = 0;
};

}  // namespace vitrine::hal
