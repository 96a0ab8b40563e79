// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The loop around the engine: reads controls, plays frames, writes pictures.
#pragma once

#include <csignal>
#include <memory>
#include <vector>

#include "hal/clock.h"
#include "hal/input.h"
#include "hal/storage.h"
#include "target/engine.h"
#include "tools/frame_times.h"
#include "tools/play_options.h"
#include "tools/play_overlay.h"

namespace vitrine {

// Set by SIGINT and SIGTERM: the frame is finished, then the loop ends.
extern volatile std::sig_atomic_t stop_signal;

class Player {
 public:
  // Opens everything. Throws PlayError and UsageError.
  explicit Player(const PlayOptions& options);
  void play();
  void print_stats() const;

 private:
  void open_image();
  void open_device();
  void open_script();
  void load_engine();
  void play_still();
  void read_controls();
  void handle(const hal::ControlEvent& event);
  void press(uint16_t button);
  void play_frame();
  void draw_overlay();
  void write_picture(const std::string& path);
  void print_json() const;
  void print_table() const;
  int64_t frame_limit() const;

  struct FreeBlock {
    void operator()(std::byte* block) const;
  };

  PlayOptions options_;
  Backend backend_;
  hal::MappedFile file_;
  ImageView image_;
  std::unique_ptr<hal::Gpu> gpu_;
  std::unique_ptr<hal::Input> window_input_, script_;
  std::unique_ptr<hal::Clock> clock_;
  std::unique_ptr<std::byte, FreeBlock> block_;
  std::unique_ptr<Engine> engine_;
  std::unique_ptr<Overlay> overlay_;
  std::vector<uint8_t> pixels_;
  std::unique_ptr<FrameTimes> times_ = std::make_unique<FrameTimes>();
  Position start_{}, position_{};
  int64_t frame_ = 0, script_frame_ = 0, screenshots_ = 0;
  int64_t last_frame_ns_ = 0, next_frame_ns_ = 0;
  bool quit_ = false, paused_ = false, show_overlay_ = false, take_screenshot_ = false;
};

}  // namespace vitrine
