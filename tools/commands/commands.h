// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The subcommands of vitrine: what each is told, and its run(). What the options mean stands where they are read, in
// command_line.cpp. run() throws InputError for a mistake in what it is given, UsageError for one in the options.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "host/base/progress.h"

namespace vitrine {

// Options that every subcommand understands.
struct CommonOptions {
  bool quiet = false;
  bool json = false;
  int jobs = 0;  // 0: all cores
};

struct NewCommand {
  std::string directory, model;
  CommonOptions common;
  void run() const;
};

struct RenderCommand {
  std::string scene, at, size, output;
  int samples_per_pixel = 0;  // 0: the scene's
  double noise_db = 0;        // 0: every pixel gets the same
  uint32_t seed = 0;
  bool layers = false;
  CommonOptions common;
  void run() const;
};

struct CompileCommand {
  std::string scene, image, preset = "full", profile, storage, codec, work;
  CommonOptions common;
  void run() const;
};

struct InspectCommand {
  std::string image, report;
  CommonOptions common;
  void run() const;
};

struct VerifyCommand {
  std::string image, scene, work, sheet;
  int at = 3, between = 2, off = 2;  // references of each kind
  CommonOptions common;
  void run() const;
};

struct BenchTraceCommand {
  std::string scene;
  int samples_per_pixel = 8;
  CommonOptions common;
  void run() const;
};

struct BenchNoiseCommand {
  std::string scene, preset = "small", size, work;
  int views = 8, even = 0;
  bool frames_only = false;
  CommonOptions common;
  void run() const;
};

struct BenchInferenceCommand {
  std::string scene, object, size, sheet, textures;
  int samples_per_pixel = 256;
  bool matrices = false;
  CommonOptions common;
  void run() const;
};

struct BenchCoordinatesCommand {
  std::string scene, size, work;
  int views = 8, samples_per_pixel = 128;
  CommonOptions common;
  void run() const;
};

struct BenchInferenceCostCommand {
  std::string scene, size, plot, work;
  bool no_trace = false, no_scaling = false, whole = false;
  CommonOptions common;
  void run() const;
};

struct BenchCompressionCommand {
  std::string scene, size, work, page;
  int samples = 8;      // 0: all
  double noise_db = 0;  // 0: the scene's
  std::vector<double> ratios;
  std::vector<std::string> coders;
  bool frames_only = false, no_videos = false;
  CommonOptions common;
  void run() const;
};

struct BenchAllocationCommand {
  std::string scene, preset = "small", storage, work, plot;
  CommonOptions common;
  void run() const;
};

struct BenchSmoothingCommand {
  std::string scene, preset = "small", work;
  CommonOptions common;
  void run() const;
};

struct BenchDecodeCommand {
  std::string image, scene, work;
  int rounds = 15;
  CommonOptions common;
  void run() const;
};

// Progress as the options ask: silent, a terminal line, or plain lines, always on stderr.
std::unique_ptr<Progress> make_progress(const CommonOptions& options);
// Limits all stages to `jobs` threads for the life of the returned object.
std::shared_ptr<void> limit_jobs(const CommonOptions& options);

}  // namespace vitrine
