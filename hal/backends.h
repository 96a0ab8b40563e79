// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Where hardware layers come from. Each function is defined in its backend's own library (hal/osmesa, hal/sdl, ...), so a
// program links only those that it names.
#pragma once

#include <memory>

#include "formats/status.h"
#include "hal/clock.h"
#include "hal/gpu.h"
#include "hal/input.h"

namespace vitrine::hal {

// Off-screen, in software (Mesa's llvmpipe), no window system. Several may exist; make_current is implicit per call when
// they are used from different threads (each device from one thread only).
Result<std::unique_ptr<Gpu>> create_osmesa_gpu(int width, int height);

// Draws nothing, fast.
std::unique_ptr<Gpu> create_null_gpu(int width, int height);

// A window with GL through SDL2, and the keyboard, mouse and gamepads that come with it.
struct WindowDesc {
  const char* title = "Vitrine";
  int width = 640, height = 480;  // of the picture; the window may be resized, the picture is scaled with its aspect kept
  bool full_screen = false;
  bool vertical_sync = true;
};
struct Window {
  std::unique_ptr<Gpu> gpu;
  std::unique_ptr<Input> input;
};
Result<Window> create_sdl_window(const WindowDesc& desc);

// A recorded script (CSV: header "frame,AXIS,AXIS,...", then positions in [0, 1]; frames ascending, positions between two
// rows are interpolated). `csv` is copied. `axis_names` are those of the image, in its order; an unknown one is refused.
Result<std::unique_ptr<Input>> create_script_input(const char* csv, size_t size, const char* const* axis_names, int axis_count);

std::unique_ptr<Clock> create_posix_clock();
std::unique_ptr<Clock> create_virtual_clock();  // advances only by sleep_until

}  // namespace vitrine::hal
