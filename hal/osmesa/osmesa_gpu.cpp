// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// A context without a window: Mesa draws in software into memory of ours.
#include <GL/osmesa.h>

#include <cstdint>
#include <vector>

#include "hal/backends.h"
#include "hal/gl/gl_gpu.h"

namespace vitrine::hal {
namespace {

void* get_proc(const char* name) { return reinterpret_cast<void*>(OSMesaGetProcAddress(name)); }

class OsmesaContext final : public GlContext {
 public:
  OsmesaContext(OSMesaContext context, int width, int height)
      : context_(context),
        width_(width),
        height_(height),
        pixels_(4 * static_cast<size_t>(width) * static_cast<size_t>(height)) {}
  ~OsmesaContext() override {
    if (OSMesaGetCurrentContext() == context_) OSMesaMakeCurrent(nullptr, nullptr, 0, 0, 0);
    OSMesaDestroyContext(context_);
  }
  bool make_current() override {
    if (OSMesaGetCurrentContext() == context_) return true;  // per thread
    return OSMesaMakeCurrent(context_, pixels_.data(), GL_UNSIGNED_BYTE, width_, height_);
  }
  GetProc loader() const override { return get_proc; }
  void framebuffer_size(int& width, int& height) const override { width = width_, height = height_; }
  bool window() const override { return false; }
  Status swap() override { return {}; }

 private:
  OSMesaContext context_;
  int width_, height_;
  std::vector<uint8_t> pixels_;
};

}  // namespace

Result<std::unique_ptr<Gpu>> create_osmesa_gpu(int width, int height) {
  if (width < 1 || height < 1 || width > 16384 || height > 16384)
    return Status{StatusCode::kUnsupported, "the picture is larger than the device allows"};
  const int attributes[] = {OSMESA_FORMAT,
                            OSMESA_RGBA,
                            OSMESA_DEPTH_BITS,
                            24,
                            OSMESA_PROFILE,
                            OSMESA_CORE_PROFILE,
                            OSMESA_CONTEXT_MAJOR_VERSION,
                            3,
                            OSMESA_CONTEXT_MINOR_VERSION,
                            3,
                            0};
  const OSMesaContext context = OSMesaCreateContextAttribs(attributes, nullptr);
  if (!context) return Status{StatusCode::kDevice, "OSMesa has no GL 3.3 core context"};
  return create_gl_gpu(std::make_unique<OsmesaContext>(context, width, height), width, height);
}

}  // namespace vitrine::hal
