// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// vitrine, the host compiler: see tools/commands for what each subcommand does.
#include <cstdio>
#include <exception>

#include "host/base/error.h"
#include "host/base/interrupt.h"
#include "tools/commands/commands.h"

namespace {

int fail(const char* message, int code) {
  std::fprintf(stderr, "vitrine: %s\n", message);
  return code;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Vitrine compiles a scene with dials into an image that a small engine plays."};
  app.set_version_flag("--version", "vitrine " VITRINE_VERSION);
  app.require_subcommand(1);
  app.footer("Example: vitrine new shop --from lamp.glb && vitrine compile shop -o lamp.vit --preset small && vitrine-play lamp.vit");
  vitrine::add_new_command(app);
  vitrine::add_render_command(app);
  vitrine::add_compile_command(app);
  vitrine::add_inspect_command(app);
  vitrine::add_verify_command(app);
  vitrine::install_interrupt_handler();
  try {
    app.parse(argc, argv);
    return 0;
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);
    return fail((std::string(error.what()) + ": see vitrine --help").c_str(), 2);
  } catch (const vitrine::InputError& error) {
    return fail(error.what(), 1);
  } catch (const vitrine::Interrupted& error) {
    return fail(error.what(), 130);
  } catch (const std::bad_alloc&) {
    return fail("out of memory: the scene is too large for this machine: lower the resolution or the samples", 1);
  } catch (const std::exception& error) {
    return fail((std::string("internal error: ") + error.what() + ": please report it").c_str(), 1);
  }
}
