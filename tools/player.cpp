// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "tools/player.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <new>
#include <nlohmann/json.hpp>

#include "hal/backends.h"
#include "tools/allocation_counter.h"
#include "tools/bus_error.h"
#include "tools/png.h"

namespace vitrine {
namespace {

constexpr int64_t kFrameNs = 1'000'000'000 / 60;

const char* remedy_for(StatusCode code) {
  switch (code) {
    case StatusCode::kBadMagic:
      return "give an image that vitrine compile wrote";
    case StatusCode::kUnsupportedVersion:
      return "play it with the version of vitrine-play that belongs to it";
    case StatusCode::kTruncated:
    case StatusCode::kChecksumMismatch:
      return "copy the image again";
    case StatusCode::kMalformed:
      return "compile the image again";
    case StatusCode::kUnsupported:
      return "compile it for what this device has";
    case StatusCode::kOutOfMemory:
      return "compile it with a smaller profile";
    case StatusCode::kDevice:
      return "try --backend osmesa";
    case StatusCode::kIo:
    case StatusCode::kOk:
      break;
  }
  return "check the path and its permissions";
}

void require(const Status& status, const std::string& file) {
  if (!status.ok()) throw PlayError(file, status.detail(), remedy_for(status.code()));
}

template <typename T>
T take(Result<T> result, const std::string& file) {
  require(result.status(), file);
  return std::move(result.value());
}

}  // namespace

volatile std::sig_atomic_t stop_signal = 0;

void Player::FreeBlock::operator()(std::byte* block) const { ::operator delete (block, std::align_val_t{64}); }

Player::Player(const PlayOptions& options) : options_(options), backend_(backend_of(options)), clock_(hal::create_posix_clock()) {
  open_image();
  start_ = position_ = parse_position(options_.at, image_);
  open_script();
  open_device();
  load_engine();
}

void Player::open_image() {
  explain_bus_errors("vitrine-play", options_.image);
  file_ = take(hal::MappedFile::open(options_.image.c_str()), options_.image);
  image_ = take(ImageView::open(file_.bytes()), options_.image);
}

void Player::open_script() {
  if (options_.script.empty()) return;
  const hal::MappedFile csv = take(hal::MappedFile::open(options_.script.c_str()), options_.script);
  std::vector<std::string> names;
  std::vector<const char*> pointers;
  for (int a = 0; a < image_.space().axis_count; ++a) names.push_back(axis_name(image_, a));
  for (const std::string& name : names) pointers.push_back(name.c_str());
  auto script = hal::create_script_input(reinterpret_cast<const char*>(csv.bytes().data()), csv.bytes().size(), pointers.data(),
                                         static_cast<int>(pointers.size()));
  if (!script.ok())
    throw PlayError(options_.script, script.status().detail(), "correct the script (vitrine-play --help shows the form)");
  script_ = std::move(script.value());
}

void Player::open_device() {
  const int width = static_cast<int>(image_.directory().width()), height = static_cast<int>(image_.directory().height());
  std::unique_ptr<hal::Gpu> gpu;
  if (backend_ == Backend::kNull) gpu = hal::create_null_gpu(width, height);
  if (backend_ == Backend::kOsmesa) gpu = take(hal::create_osmesa_gpu(width, height), options_.image);
  if (backend_ == Backend::kSdl) {
    hal::Window window =
        take(hal::create_sdl_window(
                 {.title = options_.image.c_str(), .width = width, .height = height, .full_screen = options_.full_screen}),
             options_.image);
    gpu = std::move(window.gpu);
    window_input_ = std::move(window.input);
    overlay_ = take(Overlay::create(*gpu), options_.image);
  }
  // The overlay keeps the device's address: it is drawn outside of what is counted.
  gpu_ = uncounted(std::move(gpu));
  pixels_.resize(4 * static_cast<size_t>(width) * static_cast<size_t>(height));
}

void Player::load_engine() {
  const size_t bytes = Engine::required_bytes(image_);
  if (bytes > limits::kEngineBytes)
    throw PlayError(options_.image, "the image needs more memory than any may", "compile it again with smaller textures");
  block_.reset(static_cast<std::byte*>(::operator new (bytes, std::align_val_t{64}, std::nothrow)));
  if (!block_)
    throw PlayError(options_.image, fmt::format("there are no {} MB of memory for it", bytes >> 20),
                    "close other programs or compile it with a smaller profile");
  engine_ = take(Engine::load(image_, *gpu_, {block_.get(), bytes}, {.unlimited = options_.still()}), options_.image);
}

int64_t Player::frame_limit() const {
  if (options_.frames) return *options_.frames;
  return script_ || window_input_ ? std::numeric_limits<int64_t>::max() : kFramesWithoutEnd;
}

void Player::play() {
  if (options_.still()) return play_still();
  if (!options_.out.empty()) {
    std::error_code error;
    std::filesystem::create_directories(options_.out, error);
    if (error)
      throw PlayError(options_.out, error.message(), "give --out a folder that can be made, or a name that ends in .png");
  }
  next_frame_ns_ = clock_->now_ns();
  while (frame_ < frame_limit() && !stop_signal) {
    read_controls();
    if (quit_) break;
    play_frame();
    if (!options_.out.empty()) write_picture(fmt::format("{}/frame_{:05}.png", options_.out, frame_));
    ++frame_;
    if (!paused_) ++script_frame_;
  }
  if (!options_.quiet && !options_.out.empty()) fmt::print(stderr, "{} frames in {}\n", frame_, options_.out);
}

void Player::play_still() {
  play_frame();
  write_picture(options_.out);
}

void Player::read_controls() {
  std::array<hal::ControlEvent, 64> events;
  if (script_) {
    const int count = script_->poll(script_frame_, events);
    for (int i = 0; i < count; ++i) handle(events[static_cast<size_t>(i)]);
  }
  if (!window_input_) return;
  const int count = window_input_->poll(frame_, events);
  for (int i = 0; i < count; ++i) handle(events[static_cast<size_t>(i)]);
}

void Player::handle(const hal::ControlEvent& event) {
  if (event.kind == hal::ControlKind::kQuit) quit_ = true;
  if (event.kind == hal::ControlKind::kButton && event.value > 0) press(event.control);
  const ParameterSpace space = image_.space();
  if (event.control >= space.axis_count) return;
  float& position = position_[event.control];
  if (event.kind == hal::ControlKind::kAbsolute) position = std::clamp(event.value, 0.0f, 1.0f);
  if (event.kind != hal::ControlKind::kRelative) return;
  const float moved = position + event.value;
  position = space.axes[event.control].kind == AxisKind::kPeriodic ? moved - std::floor(moved) : std::clamp(moved, 0.0f, 1.0f);
}

void Player::press(uint16_t button) {
  if (button == hal::kButtonHome) position_ = start_;
  if (button == hal::kButtonOverlay) show_overlay_ = !show_overlay_;
  if (button == hal::kButtonPause) paused_ = !paused_;
  if (button == hal::kButtonScreenshot) take_screenshot_ = true;
}

void Player::play_frame() {
  const int64_t begin = clock_->now_ns();
  Status played;
  {
    const CountAllocations count;
    played = engine_->frame(position_, {});
  }
  require(played, options_.image);
  last_frame_ns_ = clock_->now_ns() - begin;
  if (show_overlay_ && overlay_) draw_overlay();
  if (std::exchange(take_screenshot_, false)) {
    const std::string stem = std::filesystem::path(options_.image).stem().string();
    write_picture(fmt::format("{}_{:03}.png", stem, screenshots_++));
  }
  require(gpu_->present(), options_.image);
  // Off screen the device may still be at work until the picture is presented; a window waits there for the screen.
  if (!window_input_) last_frame_ns_ = clock_->now_ns() - begin;
  times_->add(last_frame_ns_);
  if (!window_input_) return;
  next_frame_ns_ = std::max(next_frame_ns_ + kFrameNs, clock_->now_ns() - kFrameNs);
  clock_->sleep_until(next_frame_ns_);
}

void Player::draw_overlay() {
  const EngineStats& stats = engine_->stats();
  std::array<char, 512> text;
  char* end = fmt::format_to_n(text.data(), text.size() - 1, "{:.2f} ms\n{} of {} units\nlate {}  overruns {}  settling {}\n",
                               static_cast<double>(last_frame_ns_) * 1e-6, stats.units_last,
                               image_.directory().plan()->units_budget(), stats.late_nodes, stats.overruns, stats.settling_frames)
                  .out;
  for (int a = 0; a < image_.space().axis_count; ++a)
    end = fmt::format_to_n(end, text.data() + text.size() - 1 - end, "{} {:.3f}  ",
                           image_.directory().axes()->Get(static_cast<uint32_t>(a))->name()->c_str(),
                           position_[static_cast<size_t>(a)])
              .out;
  *std::min(end, text.data() + text.size() - 1) = '\0';
  require(overlay_->draw(text.data()), options_.image);
}

void Player::write_picture(const std::string& path) {
  require(gpu_->read_pixels({}, hal::TextureFormat::kRgba8, std::as_writable_bytes(std::span(pixels_))), options_.image);
  require(write_png(path, gpu_->width(), gpu_->height(), rgb_from_read_back(gpu_->width(), gpu_->height(), pixels_)), path);
}

void Player::print_stats() const {
  if (options_.json)
    print_json();
  else if (options_.stats)
    print_table();
}

void Player::print_json() const {
  const EngineStats& stats = engine_->stats();
  const fb::Plan& plan = *image_.directory().plan();
  const double mean = stats.frames ? static_cast<double>(stats.units_sum) / static_cast<double>(stats.frames) : 0;
  const nlohmann::ordered_json json{
      {"frames", stats.frames},
      {"late_nodes", stats.late_nodes},
      {"overruns", stats.overruns},
      {"settling_frames", stats.settling_frames},
      {"damaged_nodes", stats.damaged_nodes},
      {"allocations", allocations_counted()},
      {"units", {{"budget", plan.units_budget()}, {"max", stats.units_max}, {"mean", mean}}},
      {"upload_bytes", {{"budget", plan.upload_worst()}, {"max", stats.upload_bytes_max}}},
      {"cache_bytes", stats.cache_bytes},
      {"frame_ms", {{"p50", times_->percentile_ms(0.5)}, {"p99", times_->percentile_ms(0.99)}, {"max", times_->max_ms()}}},
      {"renderer", gpu_->info().renderer},
  };
  fmt::print("{}\n", json.dump());
}

void Player::print_table() const {
  const EngineStats& stats = engine_->stats();
  const fb::Plan& plan = *image_.directory().plan();
  const double mean = stats.frames ? static_cast<double>(stats.units_sum) / static_cast<double>(stats.frames) : 0;
  fmt::print("frames        {}\n", stats.frames);
  fmt::print("late nodes    {}\n", stats.late_nodes);
  fmt::print("overruns      {}\n", stats.overruns);
  fmt::print("settling      {} frames\n", stats.settling_frames);
  fmt::print("damaged nodes {}\n", stats.damaged_nodes);
  fmt::print("allocations   {}\n", allocations_counted());
  fmt::print("units         {} of {} at most, {:.0f} in the mean\n", stats.units_max, plan.units_budget(), mean);
  fmt::print("upload bytes  {} of {} at most\n", stats.upload_bytes_max, plan.upload_worst());
  fmt::print("cache bytes   {} of {} at most\n", stats.cache_bytes, plan.cache_bytes());
  fmt::print("frame ms      p50 {:.2f}  p99 {:.2f}  max {:.2f}  ({})\n", times_->percentile_ms(0.5), times_->percentile_ms(0.99),
             times_->max_ms(), gpu_->info().renderer);
}

}  // namespace vitrine
