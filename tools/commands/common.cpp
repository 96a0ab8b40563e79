// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include <tbb/global_control.h>

#include <cstdlib>
#include <string>

#include "host/base/interrupt.h"
#include "host/base/terminal_progress.h"
#include "tools/commands/commands.h"

namespace vitrine {
namespace {

// Says nothing, but can be interrupted.
class QuietProgress final : public Progress {
 public:
  void begin(const char*, int64_t, int64_t, const char*) override {}
  void advance(int64_t) override {
    if (interrupt_requested()) throw Interrupted();
  }
  void end() override {}
};

}  // namespace

std::unique_ptr<Progress> make_progress(const CommonOptions& options) {
  if (options.quiet) return std::make_unique<QuietProgress>();
  return std::make_unique<TerminalProgress>(stderr, can_redraw(stderr));
}

std::shared_ptr<void> limit_jobs(const CommonOptions& options) {
  if (options.jobs <= 0) return nullptr;
  setenv("LP_NUM_THREADS", std::to_string(options.jobs).c_str(), 0);  // Mesa's rasterizer
  return std::make_shared<tbb::global_control>(tbb::global_control::max_allowed_parallelism, static_cast<size_t>(options.jobs));
}

}  // namespace vitrine
