// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Controls: a stream of events by value, drained once a frame. Hot-plug is normal life: a control that goes away simply
// sends nothing more.
#pragma once

#include <cstdint>
#include <span>

namespace vitrine::hal {

enum class ControlKind : uint8_t {
  kAbsolute,  // value in [0, 1]
  kRelative,  // value in units of the whole axis: +0.01 moves by a hundredth
  kButton,    // value 1 pressed, 0 released
  kQuit,      // the user closed the window, or the script is over
};

struct ControlEvent {
  ControlKind kind = ControlKind::kAbsolute;
  uint16_t control = 0;  // absolute, relative: which axis of the image; button: see Button
  float value = 0;
};

enum Button : uint16_t { kButtonHome = 0, kButtonOverlay = 1, kButtonScreenshot = 2, kButtonPause = 3, kButtonFullScreen = 4 };

class Input {
 public:
  virtual ~Input() = default;
  // Writes what came in since the last call, oldest first; returns how many (at most events.size(); the rest comes next
  // time). Never blocks, never allocates. `frame` is the number of the frame about to be drawn.
  virtual int poll(int64_t frame, std::span<ControlEvent> events) = 0;
};

}  // namespace vitrine::hal
