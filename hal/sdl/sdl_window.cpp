// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include <SDL.h>

#include <algorithm>
#include <cstdlib>
#include <string_view>

#include "hal/backends.h"
#include "hal/gl/gl_gpu.h"
#include "hal/sdl/sdl_input.h"

namespace vitrine::hal {
namespace {

constexpr Uint32 kSubsystems = SDL_INIT_VIDEO | SDL_INIT_GAMECONTROLLER;

// The library, the window and its context: closed in reverse when both the device and the input are gone.
struct SdlSession {
  SDL_Window* window = nullptr;
  SDL_GLContext context = nullptr;
  ~SdlSession() {
    if (context) SDL_GL_DeleteContext(context);
    if (window) SDL_DestroyWindow(window);
    SDL_QuitSubSystem(kSubsystems);
  }
};

class SdlContext final : public GlContext {
 public:
  explicit SdlContext(std::shared_ptr<SdlSession> session) : session_(std::move(session)) {}
  bool make_current() override {
    if (SDL_GL_GetCurrentContext() == session_->context) return true;
    return SDL_GL_MakeCurrent(session_->window, session_->context) == 0;
  }
  GetProc loader() const override { return SDL_GL_GetProcAddress; }
  void framebuffer_size(int& width, int& height) const override { SDL_GL_GetDrawableSize(session_->window, &width, &height); }
  bool window() const override { return true; }
  Status swap() override {
    SDL_GL_SwapWindow(session_->window);
    return {};
  }

 private:
  std::shared_ptr<SdlSession> session_;
};

class SessionInput final : public Input {
 public:
  explicit SessionInput(std::shared_ptr<SdlSession> session) : session_(std::move(session)), input_(session_->window) {}
  int poll(int64_t frame, std::span<ControlEvent> events) override { return input_.poll(frame, events); }

 private:
  std::shared_ptr<SdlSession> session_;
  SdlInput input_;
};

struct GlVersion {
  int profile, major, minor;
};
constexpr GlVersion kVersions[] = {{SDL_GL_CONTEXT_PROFILE_CORE, 3, 3}, {SDL_GL_CONTEXT_PROFILE_ES, 3, 0}};

bool open_window(SdlSession& session, const WindowDesc& desc, const GlVersion& version) {
  SDL_GL_SetAttribute(SDL_GL_CONTEXT_PROFILE_MASK, version.profile);
  SDL_GL_SetAttribute(SDL_GL_CONTEXT_MAJOR_VERSION, version.major);
  SDL_GL_SetAttribute(SDL_GL_CONTEXT_MINOR_VERSION, version.minor);
  SDL_GL_SetAttribute(SDL_GL_DOUBLEBUFFER, 1);
  const Uint32 flags = SDL_WINDOW_OPENGL | SDL_WINDOW_RESIZABLE | SDL_WINDOW_ALLOW_HIGHDPI |
                       (desc.full_screen ? Uint32{SDL_WINDOW_FULLSCREEN_DESKTOP} : 0u);
  session.window = SDL_CreateWindow(desc.title, SDL_WINDOWPOS_CENTERED, SDL_WINDOWPOS_CENTERED, desc.width, desc.height, flags);
  if (!session.window) return false;
  session.context = SDL_GL_CreateContext(session.window);
  if (session.context) return true;
  SDL_DestroyWindow(session.window);
  session.window = nullptr;
  return false;
}

}  // namespace

Result<Window> create_sdl_window(const WindowDesc& desc) {
  if (desc.width < 1 || desc.height < 1 || desc.width > 16384 || desc.height > 16384)
    return Status{StatusCode::kUnsupported, "the picture is larger than the device allows"};
  SDL_SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");  // the program handles its own
  if (SDL_InitSubSystem(kSubsystems) != 0) return Status{StatusCode::kDevice, "SDL finds no display"};
  // Without a display SDL falls back to drivers that show nothing; a test asks for one by name.
  const std::string_view driver = SDL_GetCurrentVideoDriver();
  if ((driver == "offscreen" || driver == "dummy") && !std::getenv("SDL_VIDEODRIVER")) {
    SDL_QuitSubSystem(kSubsystems);
    return Status{StatusCode::kDevice, "SDL finds no display"};
  }
  auto session = std::make_shared<SdlSession>();
  const bool opened = std::any_of(std::begin(kVersions), std::end(kVersions),
                                  [&](const GlVersion& version) { return open_window(*session, desc, version); });
  if (!opened) return Status{StatusCode::kDevice, "SDL cannot open a window with GL 3.3 or GL ES 3.0"};
  SDL_GL_SetSwapInterval(desc.vertical_sync ? 1 : 0);  // some drivers cannot: the program paces itself then
  auto gpu = create_gl_gpu(std::make_unique<SdlContext>(session), desc.width, desc.height);
  if (!gpu.ok()) return gpu.status();
  Window window;
  window.gpu = std::move(gpu.value());
  window.input = std::make_unique<SessionInput>(std::move(session));
  return Result<Window>(std::move(window));
}

}  // namespace vitrine::hal
