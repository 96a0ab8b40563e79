// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "tools/allocation_counter.h"

#include <cstdlib>
#include <new>
#include <utility>

namespace vitrine {
namespace {

thread_local bool counting = false;
thread_local int64_t counted = 0;

class Pause {
 public:
  Pause() : before_(std::exchange(counting, false)) {}
  ~Pause() { counting = before_; }
  Pause(const Pause&) = delete;
  Pause& operator=(const Pause&) = delete;

 private:
  bool before_;
};

class UncountedGpu final : public hal::Gpu {
 public:
  explicit UncountedGpu(std::unique_ptr<hal::Gpu> gpu) : gpu_(std::move(gpu)) {}
  hal::DeviceInfo info() const override { return gpu_->info(); }
  Result<hal::Texture> create_texture(const hal::TextureDesc& desc) override { return pause(), gpu_->create_texture(desc); }
  Status update_texture(hal::Texture texture, int level, int x, int y, int width, int height,
                        std::span<const std::byte> texels) override {
    const Pause paused;
    return gpu_->update_texture(texture, level, x, y, width, height, texels);
  }
  Result<hal::Mesh> create_mesh(const hal::MeshDesc& desc) override { return pause(), gpu_->create_mesh(desc); }
  Result<hal::Program> create_program(const hal::ProgramDesc& desc) override { return pause(), gpu_->create_program(desc); }
  Result<hal::Target> create_target(const hal::TargetDesc& desc) override { return pause(), gpu_->create_target(desc); }
  hal::Texture color_of(hal::Target target) override { return gpu_->color_of(target); }
  void destroy(hal::Texture texture) override { gpu_->destroy(texture); }
  void destroy(hal::Mesh mesh) override { gpu_->destroy(mesh); }
  void destroy(hal::Program program) override { gpu_->destroy(program); }
  void destroy(hal::Target target) override { gpu_->destroy(target); }
  Status begin_pass(const hal::PassDesc& desc) override { return pause(), gpu_->begin_pass(desc); }
  Status draw(const hal::Draw& draw) override { return pause(), gpu_->draw(draw); }
  Status end_pass() override { return pause(), gpu_->end_pass(); }
  Status read_pixels(hal::Target target, hal::TextureFormat format, std::span<std::byte> pixels) override {
    return pause(), gpu_->read_pixels(target, format, pixels);
  }
  Status present() override { return pause(), gpu_->present(); }
  int width() const override { return gpu_->width(); }
  int height() const override { return gpu_->height(); }

 private:
  // Lives until the end of the full expression that it stands in: `return pause(), call`.
  static Pause pause() { return Pause(); }
  std::unique_ptr<hal::Gpu> gpu_;
};

}  // namespace

int64_t allocations_counted() { return counted; }
CountAllocations::CountAllocations() { counting = true; }
CountAllocations::~CountAllocations() { counting = false; }
std::unique_ptr<hal::Gpu> uncounted(std::unique_ptr<hal::Gpu> gpu) { return std::make_unique<UncountedGpu>(std::move(gpu)); }

}  // namespace vitrine

// The array, sized and nothrow forms of the standard library all come down to these. Sanitizers bring their own, which do not.
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
namespace vitrine {
namespace {

void* allocate(size_t bytes) {
  counted += counting;
  return std::malloc(bytes ? bytes : 1);
}

void* allocate_aligned(size_t bytes, std::align_val_t alignment) {
  const auto a = static_cast<size_t>(alignment);
  counted += counting;
  return std::aligned_alloc(a, (bytes + a - 1) / a * a);
}

}  // namespace
}  // namespace vitrine

void* operator new(size_t bytes) {
  if (void* memory = vitrine::allocate(bytes)) return memory;
  throw std::bad_alloc();
}
void* operator new(size_t bytes, std::align_val_t alignment) {
  if (void* memory = vitrine::allocate_aligned(bytes, alignment)) return memory;
  throw std::bad_alloc();
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, size_t, std::align_val_t) noexcept { std::free(memory); }
#endif
