// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/base/progress.h"

namespace vitrine {
namespace {

class SilentProgress final : public Progress {
 public:
  void begin(const char*, int64_t, int64_t, const char*) override {}
  void advance(int64_t) override {}
  void end() override {}
};

}  // namespace

Progress& silent_progress() {
  static SilentProgress progress;
  return progress;
}

}  // namespace vitrine
