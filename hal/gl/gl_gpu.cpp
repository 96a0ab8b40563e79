// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "hal/gl/gl_gpu.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "hal/checked_gpu.h"
#include "hal/gl/gl_functions.h"
#include "hal/gl/gl_program.h"
#include "hal/gpu_checks.h"

namespace vitrine::hal {
namespace {

struct Transfer {
  GLint internal;
  GLenum type;
};

Transfer transfer_of(TextureFormat format) {
  switch (format) {
    case TextureFormat::kRgba16f:
      return {GL_RGBA16F, GL_HALF_FLOAT};
    case TextureFormat::kRgba32f:
      return {GL_RGBA32F, GL_FLOAT};
    case TextureFormat::kRgba8:
      break;
  }
  return {GL_RGBA8, GL_UNSIGNED_BYTE};
}

GLint wrap_of(TextureWrap wrap) { return wrap == TextureWrap::kRepeat ? GL_REPEAT : GL_CLAMP_TO_EDGE; }

Status device(const char* detail) { return {StatusCode::kDevice, detail}; }
constexpr char kNotCurrent[] = "the GL context cannot be made current";

class GlGpu final : public CheckedGpu {
 public:
  GlGpu(std::unique_ptr<GlContext> context, int width, int height)
      : context_(std::move(context)), width_(width), height_(height) {}
  ~GlGpu() override = default;  // all objects go with the context
  Status open();

  DeviceInfo info() const override { return info_; }
  int width() const override { return width_; }
  int height() const override { return height_; }

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
  Status do_end_pass() override;
  Status do_read_pixels(const TargetSlot* target, TextureFormat format, int width, int height,
                        std::span<std::byte> pixels) override;
  Status do_present() override;

  bool enter() { return context_->make_current(); }
  Status failure(const char* detail) { return gl_.GetError() == GL_NO_ERROR ? Status{} : device(detail); }
  bool has_extension(const char* name) const;
  bool renders_to_floats();
  void bind_state(const Draw& draw);
  void upload_vertices(MeshSlot& slot, const MeshDesc& desc);
  void read_converted(TextureFormat from, int width, int height, std::span<std::byte> pixels);
  void blit_to_window();

  std::unique_ptr<GlContext> context_;
  GlFunctions gl_{};
  DeviceInfo info_;
  int width_, height_;
  bool es_ = false, filters_floats_ = true;
  GLuint empty_array_ = 0;
  TargetSlot screen_;  // where the context is a window
  TextureSlot screen_color_;
};

Status GlGpu::open() {
  if (!enter()) return device(kNotCurrent);
  if (Status status = load_gl_functions(context_->loader(), gl_); !status.ok()) return status;
  const char* version = reinterpret_cast<const char*>(gl_.GetString(GL_VERSION));
  const char* renderer = reinterpret_cast<const char*>(gl_.GetString(GL_RENDERER));
  if (!version) return device("the GL driver does not name its version");
  es_ = std::strncmp(version, "OpenGL ES", 9) == 0;
  info_.renderer = renderer ? renderer : "";
  gl_.GetIntegerv(GL_MAX_TEXTURE_SIZE, &info_.max_texture_size);
  if (width_ < 1 || height_ < 1 || width_ > info_.max_texture_size || height_ > info_.max_texture_size)
    return {StatusCode::kUnsupported, "the picture is larger than the device allows"};
  gl_.GenVertexArrays(1, &empty_array_);
  gl_.Disable(GL_DITHER);
  gl_.DepthFunc(GL_LEQUAL);
  filters_floats_ = !es_ || has_extension("GL_OES_texture_float_linear");
  info_.float_targets = renders_to_floats();
  if (!context_->window()) return failure("the GL driver failed at start");
  screen_.desc = {width_, height_, TextureFormat::kRgba8, true};
  screen_color_.desc = {width_, height_, 1, TextureFormat::kRgba8, TextureFilter::kNearest};
  return do_create_target(screen_, screen_color_);
}

bool GlGpu::has_extension(const char* name) const {
  GLint count = 0;
  gl_.GetIntegerv(GL_NUM_EXTENSIONS, &count);
  for (GLint i = 0; i < count; ++i)
    if (!std::strcmp(reinterpret_cast<const char*>(gl_.GetStringi(GL_EXTENSIONS, static_cast<GLuint>(i))), name)) return true;
  return false;
}

bool GlGpu::renders_to_floats() {
  TargetSlot probe{.desc = {1, 1, TextureFormat::kRgba32f, false}};
  TextureSlot color{.desc = {1, 1, 1, TextureFormat::kRgba32f, TextureFilter::kNearest}};
  if (!do_create_target(probe, color).ok()) return false;
  do_destroy_target(probe, color);
  return true;
}

Status GlGpu::do_create_texture(TextureSlot& slot) {
  const TextureDesc& desc = slot.desc;
  if (!enter()) return device(kNotCurrent);
  if (desc.format == TextureFormat::kRgba32f && desc.filter != TextureFilter::kNearest && !filters_floats_)
    return {StatusCode::kUnsupported, "the device does not filter 32-bit float textures"};
  const Transfer transfer = transfer_of(desc.format);
  gl_.GenTextures(1, &slot.native);
  gl_.ActiveTexture(GL_TEXTURE0);
  gl_.BindTexture(GL_TEXTURE_2D, slot.native);
  for (int l = 0; l < desc.levels; ++l)
    gl_.TexImage2D(GL_TEXTURE_2D, l, transfer.internal, level_size(desc.width, l), level_size(desc.height, l), 0, GL_RGBA,
                   transfer.type, nullptr);
  const bool nearest = desc.filter == TextureFilter::kNearest;
  const GLint minify = desc.filter == TextureFilter::kTrilinear ? GL_LINEAR_MIPMAP_LINEAR : nearest ? GL_NEAREST : GL_LINEAR;
  gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, minify);
  gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, nearest ? GL_NEAREST : GL_LINEAR);
  gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, wrap_of(desc.wrap_u));
  gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, wrap_of(desc.wrap_v));
  gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, desc.levels - 1);
  Status status = failure("the GL driver refuses a texture");
  if (!status.ok()) do_destroy_texture(slot);
  return status;
}

Status GlGpu::do_update_texture(const TextureSlot& slot, const Rectangle& r, std::span<const std::byte> texels) {
  if (!enter()) return device(kNotCurrent);
  gl_.ActiveTexture(GL_TEXTURE0);
  gl_.BindTexture(GL_TEXTURE_2D, slot.native);
  gl_.TexSubImage2D(GL_TEXTURE_2D, r.level, r.x, r.y, r.width, r.height, GL_RGBA, transfer_of(slot.desc.format).type,
                    texels.data());
  return {};
}

void GlGpu::upload_vertices(MeshSlot& slot, const MeshDesc& desc) {
  gl_.GenBuffers(1, &slot.native_vertices);
  gl_.BindBuffer(GL_ARRAY_BUFFER, slot.native_vertices);
  gl_.BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(desc.vertices.size()), desc.vertices.data(), GL_STATIC_DRAW);
  gl_.GenBuffers(1, &slot.native_indices);
  gl_.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, slot.native_indices);  // remembered by the vertex array
  gl_.BufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(desc.indices.size_bytes()), desc.indices.data(),
                 GL_STATIC_DRAW);
  for (const VertexAttribute& a : desc.attributes) {
    const auto location = static_cast<GLuint>(a.location);
    gl_.EnableVertexAttribArray(location);
    gl_.VertexAttribPointer(location, a.components, GL_FLOAT, GL_FALSE, desc.stride,
                            reinterpret_cast<const void*>(static_cast<uintptr_t>(a.offset)));
  }
}

Status GlGpu::do_create_mesh(MeshSlot& slot, const MeshDesc& desc) {
  if (!enter()) return device(kNotCurrent);
  gl_.GenVertexArrays(1, &slot.native_array);
  gl_.BindVertexArray(slot.native_array);
  upload_vertices(slot, desc);
  gl_.BindVertexArray(empty_array_);
  Status status = failure("the GL driver refuses a mesh");
  if (!status.ok()) do_destroy_mesh(slot);
  return status;
}

Status GlGpu::do_create_program(ProgramSlot& slot, const ProgramDesc& desc) {
  if (!enter()) return device(kNotCurrent);
  Result<GLuint> program = build_gl_program(gl_, desc, es_);
  if (!program.ok()) return program.status();
  slot.native = program.value();
  slot.native_params = gl_.GetUniformLocation(slot.native, "params");
  return {};
}

Status GlGpu::do_create_target(TargetSlot& slot, TextureSlot& color) {
  if (Status status = do_create_texture(color); !status.ok()) return status;
  gl_.GenFramebuffers(1, &slot.native);
  gl_.BindFramebuffer(GL_FRAMEBUFFER, slot.native);
  gl_.FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, color.native, 0);
  if (slot.desc.depth) {
    gl_.GenRenderbuffers(1, &slot.native_depth);
    gl_.BindRenderbuffer(GL_RENDERBUFFER, slot.native_depth);
    gl_.RenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT24, slot.desc.width, slot.desc.height);
    gl_.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, slot.native_depth);
  }
  const bool complete = gl_.CheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
  if (complete && failure("").ok()) return {};
  do_destroy_target(slot, color);
  return {StatusCode::kUnsupported, "the device cannot render to this target"};
}

void GlGpu::do_destroy_texture(TextureSlot& slot) {
  if (enter()) gl_.DeleteTextures(1, &slot.native);
}

void GlGpu::do_destroy_mesh(MeshSlot& slot) {
  if (!enter()) return;
  gl_.DeleteVertexArrays(1, &slot.native_array);
  gl_.DeleteBuffers(1, &slot.native_vertices);
  gl_.DeleteBuffers(1, &slot.native_indices);
}

void GlGpu::do_destroy_program(ProgramSlot& slot) {
  if (enter()) gl_.DeleteProgram(slot.native);
}

void GlGpu::do_destroy_target(TargetSlot& slot, TextureSlot& color) {
  if (!enter()) return;
  gl_.DeleteFramebuffers(1, &slot.native);
  if (slot.native_depth) gl_.DeleteRenderbuffers(1, &slot.native_depth);
  gl_.DeleteTextures(1, &color.native);
}

Status GlGpu::do_begin_pass(const PassDesc& desc, const TargetSlot* target) {
  if (!enter()) return device(kNotCurrent);
  gl_.BindFramebuffer(GL_FRAMEBUFFER, target ? target->native : screen_.native);
  gl_.Viewport(0, 0, target ? target->desc.width : width_, target ? target->desc.height : height_);
  if (!desc.clear) return {};
  gl_.DepthMask(GL_TRUE);
  gl_.ClearColor(desc.clear_color[0], desc.clear_color[1], desc.clear_color[2], desc.clear_color[3]);
  gl_.Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  return {};
}

void GlGpu::bind_state(const Draw& draw) {
  draw.depth_test ? gl_.Enable(GL_DEPTH_TEST) : gl_.Disable(GL_DEPTH_TEST);
  draw.cull != Cull::kNone ? gl_.Enable(GL_CULL_FACE) : gl_.Disable(GL_CULL_FACE);
  if (draw.cull != Cull::kNone) gl_.CullFace(draw.cull == Cull::kBack ? GL_BACK : GL_FRONT);
}

Status GlGpu::do_draw(const Draw& draw, const ProgramSlot& program, const MeshSlot* mesh,
                      std::span<const TextureSlot* const> textures) {
  if (!enter()) return device(kNotCurrent);
  bind_state(draw);
  gl_.UseProgram(program.native);
  if (program.native_params >= 0)
    gl_.Uniform4fv(program.native_params, static_cast<GLsizei>(program.uniform_count), draw.uniforms.data());
  for (size_t i = 0; i < textures.size(); ++i) {
    gl_.ActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(i));
    gl_.BindTexture(GL_TEXTURE_2D, textures[i]->native);
  }
  gl_.BindVertexArray(mesh ? mesh->native_array : empty_array_);
  const void* offset = reinterpret_cast<const void*>(static_cast<uintptr_t>(draw.first_index) * sizeof(uint32_t));
  if (mesh)
    gl_.DrawElements(GL_TRIANGLES, static_cast<GLsizei>(draw.index_count), GL_UNSIGNED_INT, offset);
  else
    gl_.DrawArrays(GL_TRIANGLES, 0, 3);
  return {};
}

Status GlGpu::do_end_pass() { return enter() ? failure("the GL driver failed while drawing") : device(kNotCurrent); }

Status GlGpu::do_read_pixels(const TargetSlot* target, TextureFormat format, int width, int height, std::span<std::byte> pixels) {
  if (!enter()) return device(kNotCurrent);
  gl_.BindFramebuffer(GL_FRAMEBUFFER, target ? target->native : screen_.native);
  const bool own_is_bytes = !target || target->desc.format == TextureFormat::kRgba8;
  if (own_is_bytes == (format == TextureFormat::kRgba8))
    gl_.ReadPixels(0, 0, width, height, GL_RGBA, transfer_of(format).type, pixels.data());
  else
    read_converted(own_is_bytes ? TextureFormat::kRgba8 : TextureFormat::kRgba32f, width, height, pixels);
  return failure("the GL driver cannot read the pixels");
}

// GL ES promises to read a framebuffer only in its own kind of numbers: in pieces, converted here, the same on desktop GL.
void GlGpu::read_converted(TextureFormat from, int width, int height, std::span<std::byte> pixels) {
  constexpr int kPiece = 64;
  std::array<uint8_t, 4 * kPiece> bytes;
  std::array<float, 4 * kPiece> floats;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; x += kPiece) {
      const int count = std::min(kPiece, width - x);
      const size_t first = 4 * (static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x));
      if (from == TextureFormat::kRgba8) {
        gl_.ReadPixels(x, y, count, 1, GL_RGBA, GL_UNSIGNED_BYTE, bytes.data());
        for (size_t i = 0; i < static_cast<size_t>(4 * count); ++i) floats[i] = static_cast<float>(bytes[i]) / 255.0f;
        std::memcpy(pixels.data() + first * sizeof(float), floats.data(), static_cast<size_t>(4 * count) * sizeof(float));
      } else {
        gl_.ReadPixels(x, y, count, 1, GL_RGBA, GL_FLOAT, floats.data());
        for (size_t i = 0; i < static_cast<size_t>(4 * count); ++i)
          bytes[i] = static_cast<uint8_t>(255.0f * (floats[i] > 0 ? std::min(floats[i], 1.0f) : 0.0f) + 0.5f);
        std::memcpy(pixels.data() + first, bytes.data(), static_cast<size_t>(4 * count));
      }
    }
}

// The picture as large as it fits with its aspect, centred, the rest black.
void GlGpu::blit_to_window() {
  int window_width = 0, window_height = 0;
  context_->framebuffer_size(window_width, window_height);
  const double scale = std::min(double(window_width) / width_, double(window_height) / height_);
  const int w = static_cast<int>(std::lround(scale * width_)), h = static_cast<int>(std::lround(scale * height_));
  const int x = (window_width - w) / 2, y = (window_height - h) / 2;
  gl_.BindFramebuffer(GL_FRAMEBUFFER, 0);
  gl_.ClearColor(0, 0, 0, 1);
  gl_.Clear(GL_COLOR_BUFFER_BIT);
  gl_.BindFramebuffer(GL_READ_FRAMEBUFFER, screen_.native);
  gl_.BlitFramebuffer(0, 0, width_, height_, x, y, x + w, y + h, GL_COLOR_BUFFER_BIT,
                      w == width_ && h == height_ ? GL_NEAREST : GL_LINEAR);
}

Status GlGpu::do_present() {
  if (!enter()) return device(kNotCurrent);
  if (context_->window())
    blit_to_window();
  else
    gl_.Finish();  // so that a frame's time is its own
  if (Status status = context_->swap(); !status.ok()) return status;
  return failure("the GL driver failed while presenting");
}

}  // namespace

Result<std::unique_ptr<Gpu>> create_gl_gpu(std::unique_ptr<GlContext> context, int width, int height) {
  auto gpu = std::make_unique<GlGpu>(std::move(context), width, height);
  if (Status status = gpu->open(); !status.ok()) return status;
  return Result<std::unique_ptr<Gpu>>(std::move(gpu));
}

}  // namespace vitrine::hal
