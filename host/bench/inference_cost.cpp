// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/bench/inference_cost.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "hal/backends.h"
#include "host/base/error.h"
#include "host/bench/frozen_scene.h"
#include "host/bench/processor_time.h"
#include "host/infer/geometry_states.h"
#include "host/infer/state_objects.h"

namespace vitrine {
namespace {

constexpr int kCheapPaths = 2;  // a pixel: what inference costs does not depend on noise
constexpr int kSampleCounts[] = {1, 2, 4, 8};
constexpr double kPixelShares[] = {0.25, 0.5, 1};

// The first stage that infer_textures announces begins when all sizes are known.
class SurveyClock final : public Progress {
 public:
  explicit SurveyClock(Progress& inner) : inner_(inner), start_(processor_seconds()) {}
  void begin(const char* stage, int64_t total, int64_t already, const char* unit) override {
    if (survey_ == 0) survey_ = processor_seconds() - start_;
    inner_.begin(stage, total, already, unit);
  }
  void advance(int64_t steps) override { inner_.advance(steps); }
  void end() override { inner_.end(); }
  double survey() const { return survey_; }

 private:
  Progress& inner_;
  double start_, survey_ = 0;
};

template <typename Action>
double seconds_of(const Action& action) {
  const double start = processor_seconds();
  action();
  return processor_seconds() - start;
}

int64_t peak_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return int64_t{1024} * usage.ru_maxrss;
}

class CostMeasurement {
 public:
  CostMeasurement(const InferenceCostOptions& options, const std::filesystem::path& folder, Progress& progress)
      : options_(options), folder_(folder), progress_(progress) {}

  // Processor seconds for the frames that the store has not yet.
  double trace(const Scene& scene, const TraceOptions& options) {
    const Store store(folder_);
    const ParameterSpace space = scene.space();
    const StoreKey base = scene_key(scene);
    Tracer tracer(scene);
    keys_.clear();
    progress_.begin("trace", space.sample_count(), 0, "frames");
    double seconds = 0;
    for (int64_t sample = 0; sample < space.sample_count(); ++sample) {
      const Position position = space.position_of(space.index_from_flat(sample));
      keys_.push_back(frame_key(base, scene, position, options));
      if (!store.has_frame(keys_.back())) {
        PartOfStep part(progress_);
        Frame frame;
        seconds += seconds_of([&] { frame = tracer.render(position, options, part); });
        store.save_frame(keys_.back(), scene, frame);
      }
      progress_.advance(1);
    }
    progress_.end();
    return seconds;
  }

  // Of the frames traced last.
  InferenceCostRow infer(const Scene& scene) {
    std::filesystem::remove_all(folder_ / "textures");
    const Store store(folder_);
    auto gpu = hal::create_osmesa_gpu(scene.settings.width, scene.settings.height);
    if (!gpu.ok()) throw InputError("OSMesa", gpu.status().detail(), "install the packages of tools/packages.txt");
    InferenceOptions options;
    options.width = scene.settings.width;
    options.height = scene.settings.height;
    options.supersampling = options_.supersampling;
    InferenceCostRow row{scene.space().sample_count(), options.width, options.height, {}, 0};
    Inference inference;
    SurveyClock clock(progress_);
    const double total = seconds_of([&] { inference = infer_textures(scene, keys_, store, *gpu.value(), options, clock); });
    row.seconds.survey = clock.survey();
    time_matrices(scene, inference, options, *gpu.value(), row.seconds);
    row.seconds.solve = total - row.seconds.survey - row.seconds.choose_reader - row.seconds.read_matrices;
    for (const Field& field : inference.fields) row.texels += int64_t{field.texture_width} * field.texture_height;
    return row;
  }

 private:
  // What choosing readers and reading takes, done once more by itself: every object as often as it has fields.
  static void time_matrices(const Scene& scene, const Inference& inference, const InferenceOptions& options, hal::Gpu& gpu,
                            InferenceSeconds& seconds) {
    const float aspect = static_cast<float>(options.width) / static_cast<float>(options.height);
    const GeometryStates geometry = make_geometry_states(scene, geometry_axes(scene), inference.objects, aspect);
    std::vector<Placement> usual(inference.objects.size(), {{1, 1}, {}});
    for (const Field& field : inference.fields)
      usual[static_cast<size_t>(field.drawn_object)] = {field.size(), field.maps.front()};
    StateObjectReader reader(gpu, options, inference.objects, usual);
    const auto read = [&](const GeometryState& state) {
      std::vector<std::unique_ptr<StateObject>> entries;
      std::vector<StateObjectReader::Request> requests;
      for (const Field& field : inference.fields) {
        entries.push_back(std::make_unique<StateObject>(Placement{field.size(), field.maps.front()}));
        requests.push_back({&state, static_cast<size_t>(field.drawn_object), entries.back().get()});
      }
      reader.read(requests);
    };
    const double first = seconds_of([&] { read(geometry.states.front()); });
    for (const GeometryState& state : geometry.states) seconds.read_matrices += seconds_of([&] { read(state); });
    seconds.choose_reader = std::max(0.0, first - seconds.read_matrices / static_cast<double>(geometry.states.size()));
  }

  const InferenceCostOptions& options_;
  std::filesystem::path folder_;
  Progress& progress_;
  std::vector<StoreKey> keys_;
};

// `samples` samples from end to end of the first axis, the first of all others.
Scene first_samples(const Scene& scene, int samples) {
  Scene few = scene;
  for (size_t a = 0; a < few.axes.size(); ++a)
    few.axes[a].shape.samples = a == 0 ? std::min(few.axes[a].shape.samples, samples) : 1;
  return few;
}

// Without the constant share that choosing a reader has.
double counted(const InferenceCostRow& row) { return row.seconds.total() - row.seconds.choose_reader; }

// The slope of log cost over log size.
double exponent_of(const std::vector<InferenceCostRow>& rows, const std::function<double(const InferenceCostRow&)>& size_of) {
  const auto n = static_cast<double>(rows.size());
  double sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (const InferenceCostRow& row : rows) {
    const double x = std::log(size_of(row)), y = std::log(std::max(1e-9, counted(row)));
    sx += x, sy += y, sxx += x * x, sxy += x * y;
  }
  const double spread = n * sxx - sx * sx;
  return spread > 0 ? (n * sxy - sx * sy) / spread : 0;
}

double samples_of(const InferenceCostRow& row) { return static_cast<double>(row.samples); }
double pixels_of(const InferenceCostRow& row) { return static_cast<double>(row.width) * row.height; }

TraceOptions cheap(const Scene& scene) { return {scene.settings.width, scene.settings.height, kCheapPaths, 0, true}; }

void measure_scaling(const Scene& scene, const Scene& frozen, CostMeasurement& measurement, InferenceCost& cost) {
  for (const int samples : kSampleCounts) {
    const Scene few = first_samples(scene, samples);
    if (!cost.by_samples.empty() && few.space().sample_count() == cost.by_samples.back().samples) break;
    measurement.trace(few, cheap(few));
    cost.by_samples.push_back(measurement.infer(few));
  }
  for (const double share : kPixelShares) {
    Scene small = frozen;
    small.settings.width = static_cast<int>(std::lround(std::sqrt(share) * scene.settings.width));
    small.settings.height = static_cast<int>(std::lround(std::sqrt(share) * scene.settings.height));
    measurement.trace(small, cheap(small));
    cost.by_pixels.push_back(measurement.infer(small));
  }
  cost.samples_exponent = exponent_of(cost.by_samples, samples_of);
  cost.pixels_exponent = exponent_of(cost.by_pixels, pixels_of);
}

// One curve in a square of kPlotSize, and the dashed line of proportional cost through its last point.
constexpr double kPlotSize = 300, kPlotMargin = 60;

std::string curve_of(const std::vector<InferenceCostRow>& rows, const std::function<double(const InferenceCostRow&)>& size_of,
                     const char* label, double exponent, double left) {
  if (rows.empty()) return {};
  double low = counted(rows.front()), high = low;
  for (const InferenceCostRow& row : rows) low = std::min(low, counted(row)), high = std::max(high, counted(row));
  const double first = size_of(rows.front()), last = std::max(size_of(rows.back()), 2 * first);
  const double octaves = std::max(std::log2(last / first), std::log2(std::max(high / low, 1.0)));
  const auto x_of = [&](double size) { return left + kPlotMargin + kPlotSize * std::log2(size / first) / octaves; };
  const auto y_of = [&](double seconds) { return kPlotMargin + kPlotSize * (1 - std::log2(seconds / low) / octaves); };
  std::string points, marks;
  for (const InferenceCostRow& row : rows) {
    const double x = x_of(size_of(row)), y = y_of(counted(row));
    points += fmt::format("{:.1f},{:.1f} ", x, y);
    marks += fmt::format(
        "<circle cx='{0:.1f}' cy='{1:.1f}' r='3'/><text x='{0:.1f}' y='{2:.1f}'>{3:.2f} s</text>"
        "<text x='{0:.1f}' y='{4:.1f}' text-anchor='middle'>{5:.0f}</text>\n",
        x, y, y - 8, counted(row), kPlotMargin + kPlotSize + 16, size_of(row));
  }
  return fmt::format(
      "<rect x='{0:.1f}' y='{1:.1f}' width='{2:.1f}' height='{2:.1f}' fill='none' stroke='grey'/>\n"
      "<polyline points='{3}' fill='none' stroke='black'/>\n{4}"
      "<line x1='{5:.1f}' y1='{6:.1f}' x2='{7:.1f}' y2='{8:.1f}' stroke='grey' stroke-dasharray='4'/>\n"
      "<text x='{9:.1f}' y='{10:.1f}' text-anchor='middle'>{11}: processor seconds, exponent {12:.2f}</text>\n",
      left + kPlotMargin, kPlotMargin, kPlotSize, points, marks, x_of(first), y_of(low), x_of(first * std::exp2(octaves)),
      y_of(low * std::exp2(octaves)), left + kPlotMargin + kPlotSize / 2, kPlotMargin + kPlotSize + 40, label, exponent);
}

}  // namespace

InferenceCost measure_inference_cost(const Scene& scene, const TraceOptions& as_compiled, const InferenceCostOptions& options,
                                     const std::filesystem::path& folder, Progress& progress) {
  CostMeasurement measurement(options, folder, progress);
  InferenceCost cost;
  const Scene frozen = frozen_at(scene, middle_position(scene));
  cost.trace_seconds = measurement.trace(frozen, options.trace ? as_compiled : cheap(frozen));
  if (!options.trace) cost.trace_seconds = 0;
  cost.sample = measurement.infer(frozen);
  if (options.scaling) measure_scaling(scene, frozen, measurement, cost);
  if (options.whole_grid) {
    measurement.trace(scene, cheap(scene));
    cost.whole.push_back(measurement.infer(scene));
  }
  cost.peak_bytes = peak_bytes();
  return cost;
}

std::string plot_of(const InferenceCost& cost) {
  const double panel = kPlotSize + 2 * kPlotMargin;
  return fmt::format(
      "<svg xmlns='http://www.w3.org/2000/svg' width='{0:.0f}' height='{1:.0f}' font-family='sans-serif' "
      "font-size='11'>\n<rect width='100%' height='100%' fill='white'/>\n{2}{3}</svg>\n",
      2 * panel, panel, curve_of(cost.by_samples, samples_of, "samples", cost.samples_exponent, 0),
      curve_of(cost.by_pixels, pixels_of, "pixels", cost.pixels_exponent, panel));
}

}  // namespace vitrine
