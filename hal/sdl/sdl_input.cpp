// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "hal/sdl/sdl_input.h"

#include <SDL.h>

#include <algorithm>
#include <cmath>

namespace vitrine::hal {
namespace {

constexpr float kKeyStep = 1.0f / 240;    // of the axis per frame: four seconds from end to end at 60 frames a second
constexpr float kFastFactor = 4;          // with Shift
constexpr float kWheelStep = 1.0f / 50;   // per notch
constexpr float kStickStep = 1.0f / 120;  // per frame, held out fully
constexpr float kStickRest = 0.15f;       // a worn stick does not come back to 0

float beyond_rest(int raw) {
  const float value = std::clamp(static_cast<float>(raw) / 32767.0f, -1.0f, 1.0f);
  const float size = std::max(0.0f, (std::fabs(value) - kStickRest) / (1 - kStickRest));
  return std::copysign(size, value);
}

bool button_of(int key, uint16_t& button) {
  switch (key) {
    case SDLK_HOME:
      button = kButtonHome;
      return true;
    case SDLK_F1:
      button = kButtonOverlay;
      return true;
    case SDLK_F12:
      button = kButtonScreenshot;
      return true;
    case SDLK_SPACE:
      button = kButtonPause;
      return true;
    case SDLK_F11:
      button = kButtonFullScreen;
      return true;
    default:
      return false;
  }
}

}  // namespace

SdlInput::~SdlInput() {
  for (void* pad : pads_)
    if (pad) SDL_GameControllerClose(static_cast<SDL_GameController*>(pad));
}

int SdlInput::poll(int64_t frame, std::span<ControlEvent> events) {
  SDL_Event event;
  while (count_ < kQueue / 2 && SDL_PollEvent(&event)) handle(event);
  if (frame != frame_) {
    move_by_keys();
    move_by_pads();
  }
  frame_ = frame;
  int written = 0;
  for (; count_ > 0 && written < static_cast<int>(events.size()); --count_, first_ = (first_ + 1) % kQueue)
    events[static_cast<size_t>(written++)] = queue_[first_];
  return written;
}

void SdlInput::push(ControlKind kind, uint16_t control, float value) {
  if (count_ < kQueue) queue_[(first_ + count_++) % kQueue] = {kind, control, value};
}

void SdlInput::handle(const SDL_Event& event) {
  switch (event.type) {
    case SDL_QUIT:
      return push(ControlKind::kQuit, 0, 1);
    case SDL_KEYDOWN:
    case SDL_KEYUP:
      return handle_key(event);
    case SDL_MOUSEBUTTONDOWN:
    case SDL_MOUSEBUTTONUP:
      if (event.button.button == SDL_BUTTON_LEFT) dragging_ = event.type == SDL_MOUSEBUTTONDOWN;
      return;
    case SDL_MOUSEMOTION:
      return handle_motion(event);
    case SDL_MOUSEWHEEL:
      return push(ControlKind::kRelative, 1, kWheelStep * static_cast<float>(event.wheel.y));
    case SDL_CONTROLLERDEVICEADDED:
      return add_pad(event.cdevice.which);
    case SDL_CONTROLLERDEVICEREMOVED:
      return remove_pad(event.cdevice.which);
    case SDL_CONTROLLERBUTTONDOWN:
    case SDL_CONTROLLERBUTTONUP:
      if (event.cbutton.button == SDL_CONTROLLER_BUTTON_BACK) handle_button(kButtonHome, event.type == SDL_CONTROLLERBUTTONDOWN);
      if (event.cbutton.button == SDL_CONTROLLER_BUTTON_START)
        handle_button(kButtonPause, event.type == SDL_CONTROLLERBUTTONDOWN);
      return;
    default:
      return;
  }
}

void SdlInput::handle_key(const SDL_Event& event) {
  if (event.key.repeat) return;
  const bool down = event.type == SDL_KEYDOWN;
  uint16_t button = 0;
  if (event.key.keysym.sym == SDLK_ESCAPE && down)
    push(ControlKind::kQuit, 0, 1);
  else if (button_of(event.key.keysym.sym, button))
    handle_button(button, down);
}

void SdlInput::handle_button(uint16_t button, bool down) {
  if (button == kButtonFullScreen && down) toggle_full_screen();
  push(ControlKind::kButton, button, down ? 1.0f : 0.0f);
}

// Dragging across the whole window moves an axis from end to end.
void SdlInput::handle_motion(const SDL_Event& event) {
  if (!dragging_) return;
  int width = 1, height = 1;
  SDL_GetWindowSize(window_, &width, &height);
  if (event.motion.xrel)
    push(ControlKind::kRelative, 0, static_cast<float>(event.motion.xrel) / static_cast<float>(std::max(width, 1)));
  if (event.motion.yrel)
    push(ControlKind::kRelative, 1, static_cast<float>(-event.motion.yrel) / static_cast<float>(std::max(height, 1)));
}

void SdlInput::move_by_keys() {
  const Uint8* keys = SDL_GetKeyboardState(nullptr);
  const bool fast = keys[SDL_SCANCODE_LSHIFT] || keys[SDL_SCANCODE_RSHIFT];
  const auto held = [&](SDL_Scancode a, SDL_Scancode b) { return keys[a] || keys[b] ? 1 : 0; };
  const int x = held(SDL_SCANCODE_RIGHT, SDL_SCANCODE_D) - held(SDL_SCANCODE_LEFT, SDL_SCANCODE_A);
  const int y = held(SDL_SCANCODE_UP, SDL_SCANCODE_W) - held(SDL_SCANCODE_DOWN, SDL_SCANCODE_S);
  const float step = kKeyStep * (fast ? kFastFactor : 1);
  if (x) push(ControlKind::kRelative, 0, step * static_cast<float>(x));
  if (y) push(ControlKind::kRelative, 1, step * static_cast<float>(y));
}

void SdlInput::move_by_pads() {
  constexpr SDL_GameControllerAxis kSticks[] = {SDL_CONTROLLER_AXIS_LEFTX, SDL_CONTROLLER_AXIS_LEFTY, SDL_CONTROLLER_AXIS_RIGHTX,
                                                SDL_CONTROLLER_AXIS_RIGHTY};
  for (void* pad : pads_)
    for (uint16_t axis = 0; pad && axis < 4; ++axis) {
      const float out = beyond_rest(SDL_GameControllerGetAxis(static_cast<SDL_GameController*>(pad), kSticks[axis]));
      if (out != 0) push(ControlKind::kRelative, axis, kStickStep * (axis % 2 ? -out : out));  // SDL's y grows downwards
    }
}

void SdlInput::add_pad(int index) {
  const auto free = std::find(pads_.begin(), pads_.end(), nullptr);
  if (free != pads_.end()) *free = SDL_GameControllerOpen(index);
}

void SdlInput::remove_pad(int instance) {
  SDL_GameController* gone = SDL_GameControllerFromInstanceID(instance);
  const auto found = std::find(pads_.begin(), pads_.end(), static_cast<void*>(gone));
  if (!gone || found == pads_.end()) return;
  SDL_GameControllerClose(gone);
  *found = nullptr;
}

void SdlInput::toggle_full_screen() {
  const bool full = SDL_GetWindowFlags(window_) & SDL_WINDOW_FULLSCREEN_DESKTOP;
  SDL_SetWindowFullscreen(window_, full ? 0 : SDL_WINDOW_FULLSCREEN_DESKTOP);
}

}  // namespace vitrine::hal
