// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The subcommands of vitrine: each adds itself to the command line and runs as a callback. A mistake of the user is thrown
// as InputError; main prints it.
#pragma once

#include <memory>
#include <string>

#include <CLI/CLI.hpp>

#include "host/base/progress.h"

namespace vitrine {

// Options that every subcommand understands.
struct CommonOptions {
  bool quiet = false;
  bool json = false;
  int jobs = 0;  // 0: all cores
};

void add_common_options(CLI::App& command, CommonOptions& options);
// Progress as the options ask: silent, a terminal line, or plain lines, always on stderr.
std::unique_ptr<Progress> make_progress(const CommonOptions& options);
// Limits all stages to `jobs` threads for the life of the returned object.
std::shared_ptr<void> limit_jobs(const CommonOptions& options);

void add_new_command(CLI::App& app);
void add_render_command(CLI::App& app);
void add_compile_command(CLI::App& app);
void add_inspect_command(CLI::App& app);
void add_verify_command(CLI::App& app);

}  // namespace vitrine
