// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>

#include "hal/input.h"

struct SDL_Window;
union SDL_Event;

namespace vitrine::hal {

// Keyboard, mouse and gamepads of one window. Keys held and sticks held out move once a frame, so that speed does not depend
// on the system's key repeat.
class SdlInput final : public Input {
 public:
  explicit SdlInput(SDL_Window* window) : window_(window) {}
  ~SdlInput() override;
  int poll(int64_t frame, std::span<ControlEvent> events) override;

 private:
  void push(ControlKind kind, uint16_t control, float value);
  void handle(const SDL_Event& event);
  void handle_key(const SDL_Event& event);
  void handle_motion(const SDL_Event& event);
  void handle_button(uint16_t button, bool down);
  void add_pad(int index);
  void remove_pad(int instance);
  void move_by_keys();
  void move_by_pads();
  void toggle_full_screen();

  static constexpr size_t kQueue = 256, kPads = 4;
  SDL_Window* window_;
  std::array<ControlEvent, kQueue> queue_{};
  size_t first_ = 0, count_ = 0;
  std::array<void*, kPads> pads_{};
  int64_t frame_ = -1;
  bool dragging_ = false;
};

}  // namespace vitrine::hal
