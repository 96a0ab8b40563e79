// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The engine: plays an image. Usage:
//
//   auto image = ImageView::open(file.bytes());                    // verified in full
//   auto bytes = Engine::required_bytes(image.value());            // one block, asked for once
//   auto engine = Engine::load(image.value(), gpu, block);         // the last allocation and the last file access
//   loop: engine->frame(position, output); engine->stats()
//
// A frame: find the samples that are shown and those that are near (parameters), decode what they need in order of deadline
// within the plan's units (schedule, decode), sum levels, undo the companding, make MIP levels (compose), upload and draw
// (draw). A node that is not there in time is late: the picture is then made of the coarser levels that are, and the count
// goes up.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "formats/image.h"
#include "formats/parameter_space.h"
#include "hal/gpu.h"

namespace vitrine {

struct EngineStats {
  int64_t frames = 0;
  int64_t late_nodes =
      0;  // nodes that a shown sample needed and that were not decoded when it was drawn (jumps excepted: see settling)
  int64_t overruns = 0;         // frames whose decoding went beyond the units of the plan
  int64_t settling_frames = 0;  // frames drawn coarse while settling after a jump (the first frame, or motion beyond max_speed)
  uint64_t units_max = 0, units_sum = 0, units_last = 0;
  uint64_t upload_bytes_max = 0, upload_bytes_last = 0;
  int64_t damaged_nodes = 0;  // whose bytes did not decode: the picture goes without them
  size_t cache_bytes = 0;     // the decoded nodes' part of the block
};

struct EngineOptions {
  bool unlimited = false;  // decode everything that is shown at once, whatever the budget (stills, verification)
};

class Engine {
 public:
  // What the image needs beside small tables. A caller on a small device compares it with what it has: an image may ask for
  // as much as limits::kEngineBytes and, where its tops of pyramids are many, more.
  static size_t required_bytes(const ImageView& image);
  // `block`: at least required_bytes, 64-byte aligned, stays the caller's and in place. Creates all GPU objects.
  static Result<std::unique_ptr<Engine>> load(const ImageView& image, hal::Gpu& gpu, std::span<std::byte> block,
                                              const EngineOptions& options = {});
  ~Engine();  // destroys all GPU objects

  // Decodes, composes and draws the picture at `position` into `output` (id 0: the screen). Allocates nothing.
  Status frame(const Position& position, hal::Target output);
  const EngineStats& stats() const;

 private:
  struct State;
  explicit Engine(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace vitrine
