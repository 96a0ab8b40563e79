// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "hal/checked_gpu.h"

#include <array>

#include "hal/gpu_checks.h"

namespace vitrine::hal {
namespace {

Status malformed(const char* detail) { return {StatusCode::kMalformed, detail}; }

template <typename Slots>
auto* find(Slots& slots, uint32_t id) {
  const auto it = slots.find(id);
  return it == slots.end() ? nullptr : &it->second;
}

bool inside(int first, int count, int size) { return first >= 0 && count >= 1 && first <= size && count <= size - first; }

}  // namespace

Result<Texture> CheckedGpu::create_texture(const TextureDesc& desc) {
  if (Status status = check_texture(desc, info().max_texture_size); !status.ok()) return status;
  TextureSlot slot{.desc = desc};
  if (Status status = do_create_texture(slot); !status.ok()) return status;
  textures_.emplace(++last_id_, slot);
  return Texture{last_id_};
}

Status CheckedGpu::update_texture(Texture texture, int level, int x, int y, int width, int height,
                                  std::span<const std::byte> texels) {
  const TextureSlot* slot = find(textures_, texture.id);
  if (!slot) return malformed("no such texture");
  if (slot->target) return malformed("a target's texture is drawn to, not updated");
  if (level < 0 || level >= slot->desc.levels) return malformed("no such texture level");
  if (!inside(x, width, level_size(slot->desc.width, level)) || !inside(y, height, level_size(slot->desc.height, level)))
    return malformed("the rectangle is not inside the level");
  const size_t bytes =
      static_cast<size_t>(width) * static_cast<size_t>(height) * static_cast<size_t>(bytes_per_texel(slot->desc.format));
  if (texels.size() != bytes) return malformed("texel bytes do not match the rectangle");
  return do_update_texture(*slot, {level, x, y, width, height}, texels);
}

Result<Mesh> CheckedGpu::create_mesh(const MeshDesc& desc) {
  if (Status status = check_mesh(desc); !status.ok()) return status;
  MeshSlot slot{.index_count = static_cast<uint32_t>(desc.indices.size())};
  if (Status status = do_create_mesh(slot, desc); !status.ok()) return status;
  meshes_.emplace(++last_id_, slot);
  return Mesh{last_id_};
}

Result<Program> CheckedGpu::create_program(const ProgramDesc& desc) {
  if (Status status = check_program(desc); !status.ok()) return status;
  ProgramSlot slot{.sampler_count = desc.samplers.size(), .uniform_count = static_cast<size_t>(desc.uniform_count)};
  if (Status status = do_create_program(slot, desc); !status.ok()) return status;
  programs_.emplace(++last_id_, slot);
  return Program{last_id_};
}

Result<Target> CheckedGpu::create_target(const TargetDesc& desc) {
  if (Status status = check_target(desc, info()); !status.ok()) return status;
  if (in_pass_) return malformed("a target cannot be made within a pass");
  TargetSlot slot{.desc = desc};
  TextureSlot color{.desc = {desc.width, desc.height, 1, desc.format, TextureFilter::kNearest}};
  if (Status status = do_create_target(slot, color); !status.ok()) return status;
  color.target = ++last_id_;
  slot.color = Texture{++last_id_};
  targets_.emplace(color.target, slot);
  textures_.emplace(slot.color.id, color);
  return Target{color.target};
}

Texture CheckedGpu::color_of(Target target) {
  const TargetSlot* slot = find(targets_, target.id);
  return slot ? slot->color : Texture{};
}

void CheckedGpu::destroy(Texture texture) {
  TextureSlot* slot = find(textures_, texture.id);
  if (!slot || slot->target) return;
  do_destroy_texture(*slot);
  textures_.erase(texture.id);
}

void CheckedGpu::destroy(Mesh mesh) {
  MeshSlot* slot = find(meshes_, mesh.id);
  if (!slot) return;
  do_destroy_mesh(*slot);
  meshes_.erase(mesh.id);
}

void CheckedGpu::destroy(Program program) {
  ProgramSlot* slot = find(programs_, program.id);
  if (!slot) return;
  do_destroy_program(*slot);
  programs_.erase(program.id);
}

void CheckedGpu::destroy(Target target) {
  TargetSlot* slot = find(targets_, target.id);
  if (!slot || (in_pass_ && pass_target_ == target.id)) return;
  const uint32_t color = slot->color.id;
  do_destroy_target(*slot, *find(textures_, color));
  textures_.erase(color);
  targets_.erase(target.id);
}

Status CheckedGpu::begin_pass(const PassDesc& desc) {
  if (in_pass_) return malformed("a pass is open already");
  const TargetSlot* target = desc.target.id ? find(targets_, desc.target.id) : nullptr;
  if (desc.target.id && !target) return malformed("no such target");
  if (Status status = do_begin_pass(desc, target); !status.ok()) return status;
  in_pass_ = true;
  pass_target_ = desc.target.id;
  return {};
}

// The texture, if it lives and is not what the pass draws to (reading it then is undefined in GL).
const CheckedGpu::TextureSlot* CheckedGpu::sampled(Texture texture) const {
  const TextureSlot* slot = find(textures_, texture.id);
  return slot && (!slot->target || slot->target != pass_target_) ? slot : nullptr;
}

Status CheckedGpu::check_draw(const Draw& draw) const {
  if (!in_pass_) return malformed("a draw needs an open pass");
  const ProgramSlot* program = find(programs_, draw.program.id);
  if (!program) return malformed("no such program");
  if (draw.textures.size() != program->sampler_count) return malformed("a draw needs one texture for each sampler");
  if (draw.uniforms.size() != 4 * program->uniform_count) return malformed("a draw needs all uniforms of its program");
  if (draw.cull > Cull::kFront) return malformed("unknown cull mode");
  if (!draw.mesh.id) return draw.first_index || draw.index_count ? malformed("the covering triangle has no indices") : Status{};
  const MeshSlot* mesh = find(meshes_, draw.mesh.id);
  if (!mesh) return malformed("no such mesh");
  if (draw.first_index > mesh->index_count || draw.index_count > mesh->index_count - draw.first_index)
    return malformed("a draw reaches beyond the mesh's indices");
  return draw.index_count % 3 ? malformed("a draw does not take whole triangles") : Status{};
}

Status CheckedGpu::draw(const Draw& draw) {
  if (Status status = check_draw(draw); !status.ok()) return status;
  std::array<const TextureSlot*, kMaxSamplers> textures{};
  for (size_t i = 0; i < draw.textures.size(); ++i) {
    textures[i] = sampled(draw.textures[i]);
    if (!textures[i]) return malformed("a sampled texture is not there, or is what the pass draws to");
  }
  if (draw.mesh.id && !draw.index_count) return {};
  const MeshSlot* mesh = draw.mesh.id ? find(meshes_, draw.mesh.id) : nullptr;
  return do_draw(draw, *find(programs_, draw.program.id), mesh, {textures.data(), draw.textures.size()});
}

Status CheckedGpu::end_pass() {
  if (!in_pass_) return malformed("no pass is open");
  in_pass_ = false;
  pass_target_ = 0;
  return do_end_pass();
}

Status CheckedGpu::read_pixels(Target target, TextureFormat format, std::span<std::byte> pixels) {
  if (in_pass_) return malformed("pixels cannot be read within a pass");
  const TargetSlot* slot = target.id ? find(targets_, target.id) : nullptr;
  if (target.id && !slot) return malformed("no such target");
  if (format != TextureFormat::kRgba8 && format != TextureFormat::kRgba32f)
    return malformed("pixels are read as kRgba8 or kRgba32f");
  const int w = slot ? slot->desc.width : width(), h = slot ? slot->desc.height : height();
  const size_t bytes = static_cast<size_t>(w) * static_cast<size_t>(h) * static_cast<size_t>(bytes_per_texel(format));
  if (pixels.size() != bytes) return malformed("pixel bytes do not match the target");
  return do_read_pixels(slot, format, w, h, pixels);
}

Status CheckedGpu::present() {
  if (in_pass_) return malformed("a pass is still open");
  return do_present();
}

}  // namespace vitrine::hal
