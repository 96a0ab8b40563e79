// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The window on SDL's offscreen driver (EGL without a display); skipped where SDL was built without it.
#include <SDL.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <vector>

#include "hal/backends.h"

#if defined(__SANITIZE_ADDRESS__)
#include <sanitizer/lsan_interface.h>
#endif

namespace vitrine::hal {
namespace {

class SdlTest : public ::testing::Test {
 protected:
  void SetUp() override {
    ::setenv("SDL_VIDEODRIVER", "offscreen", 1);
    auto opened = create_sdl_window({.width = 32, .height = 16, .vertical_sync = false});
    if (!opened.ok()) GTEST_SKIP() << opened.status().detail();
    window = std::move(opened.value());
    poll();
  }
  std::vector<ControlEvent> poll() {
    std::array<ControlEvent, 64> events;
    const int count = window.input->poll(frame++, events);
    return {events.begin(), events.begin() + count};
  }
  static void key(int symbol, bool down) {
    SDL_Event event{};
    event.type = down ? SDL_KEYDOWN : SDL_KEYUP;
    event.key.keysym.sym = symbol;
    SDL_PushEvent(&event);
  }
#if defined(__SANITIZE_ADDRESS__)
  __lsan::ScopedDisabler drivers_keep_memory;  // and are unloaded before leaks are counted, so that no name tells them
#endif
  Window window;
  int64_t frame = 0;
};

TEST_F(SdlTest, ThePictureKeepsItsSizeWhateverTheWindowDoes) {
  EXPECT_EQ(window.gpu->width(), 32);
  EXPECT_EQ(window.gpu->height(), 16);
  ASSERT_TRUE(window.gpu->begin_pass({.target = {}, .clear_color = {0, 1, 0, 1}}).ok());
  ASSERT_TRUE(window.gpu->end_pass().ok());
  EXPECT_TRUE(window.gpu->present().ok());
  std::vector<uint8_t> pixels(32 * 16 * 4);
  ASSERT_TRUE(window.gpu->read_pixels({}, TextureFormat::kRgba8, std::as_writable_bytes(std::span(pixels))).ok());
  EXPECT_EQ(pixels[1], 255);
}

TEST_F(SdlTest, KeysBecomeButtonsAndEscapeQuits) {
  key(SDLK_HOME, true);
  key(SDLK_HOME, false);
  key(SDLK_F1, true);
  key(SDLK_ESCAPE, true);
  const auto events = poll();
  ASSERT_EQ(events.size(), 4u);
  EXPECT_TRUE(events[0].kind == ControlKind::kButton && events[0].control == kButtonHome && events[0].value == 1);
  EXPECT_EQ(events[1].value, 0);
  EXPECT_EQ(events[2].control, kButtonOverlay);
  EXPECT_EQ(events[3].kind, ControlKind::kQuit);
}

TEST_F(SdlTest, DraggingMovesAxesAndMovingAloneDoesNot) {
  SDL_Event motion{}, press{};
  motion.type = SDL_MOUSEMOTION;
  motion.motion.xrel = 8;
  motion.motion.yrel = -4;
  press.type = SDL_MOUSEBUTTONDOWN;
  press.button.button = SDL_BUTTON_LEFT;
  SDL_PushEvent(&motion);
  EXPECT_TRUE(poll().empty());
  SDL_PushEvent(&press);
  SDL_PushEvent(&motion);
  const auto events = poll();
  ASSERT_EQ(events.size(), 2u);
  EXPECT_FLOAT_EQ(events[0].value, 0.25f);
  EXPECT_EQ(events[1].control, 1);
  EXPECT_FLOAT_EQ(events[1].value, 0.25f);
}

TEST_F(SdlTest, TheWheelMovesTheSecondAxis) {
  SDL_Event wheel{};
  wheel.type = SDL_MOUSEWHEEL;
  wheel.wheel.y = -1;
  SDL_PushEvent(&wheel);
  const auto events = poll();
  ASSERT_EQ(events.size(), 1u);
  EXPECT_TRUE(events[0].kind == ControlKind::kRelative && events[0].control == 1 && events[0].value < 0);
}

}  // namespace
}  // namespace vitrine::hal
