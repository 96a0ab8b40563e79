// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/infer/inference_run.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <set>
#include <utility>

#include "host/infer/light_survey.h"
#include "host/infer/normal_matrix.h"

namespace vitrine {
namespace {

constexpr int kInferenceVersion = 6;  // changes whenever the same input would give other textures
constexpr size_t kBatch = 8;          // states read at once, if what they take stays below
constexpr size_t kBatchBytes = size_t{256} << 20;
constexpr size_t kFramePixelBytes = 40;             // of a loaded frame: the picture, and layers of about one object a pixel
constexpr size_t kSupersampleBytes = 64;            // of a matrix: what the device tells, four texels mostly, and the place
constexpr size_t kStackTexelBytes = 300;            // of the matrices of a stack, summed up: measured
constexpr size_t kStackBytes = size_t{600} << 20;   // stacks whose matrices are summed up side by side
constexpr size_t kSolverTexelBytes = 270;           // of a solver of four textures at work
constexpr size_t kSolverBytes = size_t{600} << 20;  // solvers at work side by side, unless one alone takes more
constexpr float kLargestHalf = 65504;

void append(KeyBuilder& key, const StoreKey& part) {
  key.integer(static_cast<int64_t>(part.high));
  key.integer(static_cast<int64_t>(part.low));
}

// The data term of textures that see one state or many.
class RowsOfStates {
 public:
  explicit RowsOfStates(const Pyramid& pyramid) : pyramid_(pyramid), observed_(pyramid.size()) {}

  // Kept by itself while rows are few, then summed up (data_term.h).
  void add(std::shared_ptr<const Observation> observation) {
    rows_ += observation->rows;
    kept_.push_back(std::move(observation));
    if (!normal_ && !prefers_normal_matrix(rows_, pyramid_.size())) return;
    if (!normal_) normal_ = std::make_unique<NormalMatrix>(pyramid_);
    for (auto& kept : kept_) {
      normal_->add(*kept);
      kept.reset();
    }
    kept_.clear();
  }
  const DataTerm& finish() {
    for (const auto& kept : kept_) observed_.add(*kept);
    if (!normal_) return observed_;
    normal_->finish();
    return *normal_;
  }

 private:
  const Pyramid& pyramid_;
  int64_t rows_ = 0;
  std::vector<std::shared_ptr<const Observation>> kept_;
  ObservedTerm observed_;
  std::unique_ptr<NormalMatrix> normal_;
};

}  // namespace

struct InferenceRun::StateObject {
  StateObject(ObjectMatrix read, const InferenceOptions& options)
      : matrix(std::move(read)), filtered(matrix, options.supersampling, options.width, options.height) {}
  ObjectMatrix matrix;
  FilteredMatrix filtered;
  Observation observation;
};

struct InferenceRun::Stack {
  size_t object = 0;
  std::vector<int> states;  // ascending
  std::vector<size_t> groups;
  std::vector<std::vector<float>> weights;  // of the observations of `states`
};

struct InferenceRun::StateData {
  std::vector<Frame> frames;  // as table_.samples_of_state
  std::vector<std::shared_ptr<StateObject>> objects;
};

InferenceRun::InferenceRun(const Scene& scene, const std::vector<StoreKey>& frames, const Store& store, hal::Gpu& gpu,
                           const InferenceOptions& options, const StateTable& table, std::vector<GeometryState> states,
                           Inference& inference)
    : scene_(scene),
      frames_(frames),
      store_(store),
      gpu_(gpu),
      options_(options),
      table_(table),
      states_(std::move(states)),
      inference_(inference),
      data_(states_.size()) {
  for (const DrawnObject& object : inference_.objects) pyramids_.emplace_back(object.texture_width, object.texture_height);
  make_groups_and_keys();
}

InferenceRun::~InferenceRun() = default;

// What every texture depends on: the device, the options, and the shapes of all objects, which hide each other.
StoreKey InferenceRun::base_key() const {
  KeyBuilder key;
  key.text("vitrine inference");
  key.integer(kInferenceVersion);
  key.text(gpu_.info().renderer);
  for (const int value :
       {options_.width, options_.height, options_.supersampling, static_cast<int>(options_.filter), options_.iterations})
    key.integer(value);
  key.number(static_cast<double>(options_.regularization));
  key.number(static_cast<double>(options_.range_regularization));
  key.number(static_cast<double>(scene_.settings.exposure));
  for (const DrawnObject& object : inference_.objects) {
    key.integer(object.culled_index_count);
    key.bytes(object.indices.data(), object.indices.size() * sizeof(uint32_t));
    for (const MeshVertex& vertex : object.vertices) key.bytes(&vertex, 3 * sizeof(float));
  }
  for (const GeometryState& state : states_)
    key.bytes(state.clip_from_object.data(), state.clip_from_object.size() * sizeof(glm::mat4));
  return key.finish();
}

StoreKey InferenceRun::texture_key(const SolveGroup& group, size_t texture, const StoreKey& base) const {
  KeyBuilder key;
  append(key, base);
  const DrawnObject& object = object_of(group);
  key.text(inference_.fields[static_cast<size_t>(group.field)].layer);
  key.integer(object.object);
  key.integer(object.texture_width);
  key.integer(object.texture_height);
  key.bytes(object.vertices.data(), object.vertices.size() * sizeof(MeshVertex));
  for (const SolveGroup::Use& use : group.uses) {
    key.integer(use.state);
    for (const int64_t sample : table_.samples_of_state[static_cast<size_t>(use.state)])
      append(key, frames_[static_cast<size_t>(sample)]);
    for (const int64_t sample : use.samples[texture]) key.integer(sample);
  }
  return key.finish();
}

void InferenceRun::make_groups_and_keys() {
  const StoreKey base = base_key();
  for (size_t f = 0; f < inference_.fields.size(); ++f) {
    Field& field = inference_.fields[f];
    field.textures.resize(static_cast<size_t>(field.space.sample_count()));
    for (SolveGroup& group : make_groups(scene_.space(), field.axes, table_, static_cast<int>(f), TextureSolver::kMaxTextures)) {
      std::vector<size_t> missing;
      for (size_t t = 0; t < group.textures.size(); ++t) {
        StoreKey& key = field.textures[static_cast<size_t>(group.textures[t])];
        key = texture_key(group, t, base);
        if (!store_.has_planes(key)) missing.push_back(t);
      }
      if (missing.empty()) continue;
      SolveGroup rest{group.field, {}, {}};
      for (const size_t t : missing) rest.textures.push_back(group.textures[t]);
      for (const SolveGroup::Use& use : group.uses) {
        rest.uses.push_back({use.state, {}});
        for (const size_t t : missing) rest.uses.back().samples.push_back(use.samples[t]);
      }
      groups_.push_back(std::move(rest));
    }
  }
  for (size_t i = 0; i < inference_.objects.size(); ++i) {
    KeyBuilder key;
    key.text("importance");
    append(key, base);
    const DrawnObject& object = inference_.objects[i];
    for (const int value : {object.object, object.texture_width, object.texture_height}) key.integer(value);
    key.bytes(object.vertices.data(), object.vertices.size() * sizeof(MeshVertex));
    for (const StoreKey& frame : frames_) append(key, frame);
    importance_keys_.push_back(key.finish());
  }
}

Layer InferenceRun::layer_of(const SolveGroup& group) const {
  return inference_.fields[static_cast<size_t>(group.field)].layer == layer_name(Layer::kDiffuse) ? Layer::kDiffuse
                                                                                                  : Layer::kSpecular;
}

const DrawnObject& InferenceRun::object_of(const SolveGroup& group) const {
  return inference_.objects[static_cast<size_t>(inference_.fields[static_cast<size_t>(group.field)].drawn_object)];
}

std::vector<int> InferenceRun::needed_states() const {
  std::set<int> needed;
  for (const SolveGroup& group : groups_)
    for (const SolveGroup::Use& use : group.uses) needed.insert(use.state);
  if (importance_missing())
    for (size_t s = 0; s < states_.size(); ++s) needed.insert(static_cast<int>(s));
  return {needed.begin(), needed.end()};
}

size_t InferenceRun::batch_size() const {
  const size_t frames = (frames_.size() + states_.size() - 1) / states_.size();
  const size_t supersamples = static_cast<size_t>(options_.supersampling * options_.supersampling);
  const size_t bytes = static_cast<size_t>(options_.width) * static_cast<size_t>(options_.height) *
                       (frames * kFramePixelBytes + supersamples * kSupersampleBytes);
  return std::clamp<size_t>(kBatchBytes / std::max<size_t>(1, bytes), 1, kBatch);
}

void InferenceRun::solve_missing(Progress& progress) {
  load_importance();
  int64_t total = 0, missing = 0;
  for (const Field& field : inference_.fields) total += static_cast<int64_t>(field.textures.size());
  for (const SolveGroup& group : groups_) missing += static_cast<int64_t>(group.textures.size());
  progress.begin("inference", total, total - missing, "textures");
  const std::vector<int> states = needed_states();
  if (!states.empty()) {
    make_stacks();
    {
      TestRenderer renderer(gpu_, options_, inference_.objects);
      const auto reader = make_matrix_reader(renderer, inference_.objects, states_[static_cast<size_t>(states.front())]);
      const size_t batch = batch_size();
      for (size_t begin = 0; begin < states.size(); begin += batch)
        process_batch(std::span(states).subspan(begin, std::min(batch, states.size() - begin)), *reader, progress);
      finish_importance();
      for (const auto& stacks : stacks_side_by_side()) process_stacks(stacks, *reader, progress);
    }
  }
  progress.end();
}

SolverOptions InferenceRun::solver_options() const {
  SolverOptions options;
  options.regularization = options_.regularization;
  options.iterations = options_.iterations;
  options.range_regularization = options_.range_regularization;
  options.white = 1 / scene_.settings.exposure;
  return options;
}

void InferenceRun::make_stacks() {
  solvers_.resize(groups_.size());
  for (size_t g = 0; g < groups_.size(); ++g) {
    if (groups_[g].uses.size() < 2) continue;
    const size_t object = object_number(groups_[g]);
    solvers_[g] = std::make_unique<TextureSolver>(pyramids_[object], groups_[g].textures.size(), solver_options());
    std::vector<int> states;
    for (const SolveGroup::Use& use : groups_[g].uses) states.push_back(use.state);
    const auto same = [&](const Stack& stack) { return stack.object == object && stack.states == states; };
    auto stack = std::find_if(stacks_.begin(), stacks_.end(), same);
    if (stack == stacks_.end()) stack = stacks_.insert(stacks_.end(), Stack{object, std::move(states), {}, {}});
    stack->groups.push_back(g);
  }
}

void InferenceRun::process_batch(std::span<const int> batch, MatrixReader& reader, Progress& progress) {
  progress.advance(0);
  load_frames(batch);
  std::vector<const GeometryState*> geometry;
  for (const int s : batch) geometry.push_back(&states_[static_cast<size_t>(s)]);
  build_observations(batch, reader.read(geometry));
  gather(batch);
  solve_single(batch, progress);
  release(batch);
}

void InferenceRun::load_frames(std::span<const int> batch) {
  struct Job {
    Frame* frame;
    int64_t sample;
  };
  std::vector<Job> jobs;
  for (const int s : batch) {
    auto& data = data_[static_cast<size_t>(s)];
    data = std::make_unique<StateData>();
    const auto& samples = table_.samples_of_state[static_cast<size_t>(s)];
    data->frames.resize(samples.size());
    for (size_t i = 0; i < samples.size(); ++i) jobs.push_back({&data->frames[i], samples[i]});
  }
  tbb::parallel_for(size_t{0}, jobs.size(), [&](size_t j) {
    *jobs[j].frame = load_frame_or_throw(store_, frames_[static_cast<size_t>(jobs[j].sample)], scene_);
  });
}

void InferenceRun::build_observations(std::span<const int> batch, std::vector<StateMatrix> matrices) {
  const size_t objects = inference_.objects.size();
  for (const int s : batch) data_[static_cast<size_t>(s)]->objects.resize(objects);
  tbb::parallel_for(size_t{0}, batch.size() * objects, [&](size_t job) {
    StateData& data = *data_[static_cast<size_t>(batch[job / objects])];
    std::vector<const Frame*> frames;
    for (const Frame& frame : data.frames) frames.push_back(&frame);
    auto entry = std::make_shared<StateObject>(std::move(matrices[job / objects][job % objects]), options_);
    entry->observation = make_observation(entry->filtered, inference_.objects[job % objects].object, frames);
    data.objects[job % objects] = std::move(entry);
  });
}

size_t InferenceRun::object_number(const SolveGroup& group) const {
  return static_cast<size_t>(inference_.fields[static_cast<size_t>(group.field)].drawn_object);
}

void InferenceRun::add_use(TextureSolver& solver, const SolveGroup& group, const SolveGroup::Use& use) const {
  const StateData& data = *data_[static_cast<size_t>(use.state)];
  const size_t object = object_number(group);
  const Observation& observation = data.objects[object]->observation;
  const auto& samples = table_.samples_of_state[static_cast<size_t>(use.state)];
  std::vector<std::vector<glm::vec3>> layers;
  for (const auto& own : use.samples) {
    std::vector<const Frame*> frames;
    for (const int64_t sample : own)
      frames.push_back(
          &data.frames[static_cast<size_t>(std::lower_bound(samples.begin(), samples.end(), sample) - samples.begin())]);
    layers.push_back(layer_in_window(observation.matrix->window(), inference_.objects[object].object, layer_of(group), frames,
                                     1 / scene_.settings.exposure));
  }
  solver.add(observation, layers);
}

// Right sides and weights of stacks, and importance: each object by itself, states in order.
void InferenceRun::gather(std::span<const int> batch) {
  tbb::parallel_for(size_t{0}, groups_.size(), [&](size_t g) {
    if (!solvers_[g]) return;
    for (const SolveGroup::Use& use : groups_[g].uses)
      if (std::find(batch.begin(), batch.end(), use.state) != batch.end()) add_use(*solvers_[g], groups_[g], use);
  });
  for (Stack& stack : stacks_)
    for (const int s : batch)
      if (std::binary_search(stack.states.begin(), stack.states.end(), s))
        stack.weights.push_back(data_[static_cast<size_t>(s)]->objects[stack.object]->observation.weight);
  tbb::parallel_for(size_t{0}, importance_.size(), [&](size_t object) {
    if (importance_[object].empty()) return;
    for (const int s : batch) {
      const auto state = static_cast<size_t>(s);
      const float share = static_cast<float>(table_.samples_of_state[state].size()) / static_cast<float>(frames_.size());
      add_importance(data_[state]->objects[object]->observation, share, importance_[object]);
    }
  });
}

void InferenceRun::solve_single(std::span<const int> batch, Progress& progress) {
  std::vector<const SolveGroup*> jobs;
  const auto texels_of = [&](const SolveGroup* group) { return pyramids_[object_number(*group)].finest_size(); };
  for (size_t g = 0; g < groups_.size(); ++g)
    if (!solvers_[g] && std::find(batch.begin(), batch.end(), groups_[g].uses.front().state) != batch.end())
      jobs.push_back(&groups_[g]);
  std::stable_sort(jobs.begin(), jobs.end(),
                   [&](const SolveGroup* a, const SolveGroup* b) { return texels_of(a) > texels_of(b); });
  for (size_t begin = 0, end = 0; begin < jobs.size(); begin = end) {
    for (size_t bytes = 0; end < jobs.size(); ++end) {
      bytes += kSolverTexelBytes * texels_of(jobs[end]);
      if (end > begin && bytes > kSolverBytes) break;
    }
    tbb::parallel_for(begin, end, [&](size_t j) { solve_one(*jobs[j], progress); });
  }
}

void InferenceRun::solve_one(const SolveGroup& group, Progress& progress) const {
  const size_t object = object_number(group);
  TextureSolver solver(pyramids_[object], group.textures.size(), solver_options());
  add_use(solver, group, group.uses.front());
  RowsOfStates rows(pyramids_[object]);
  const std::shared_ptr<StateObject>& seen = data_[static_cast<size_t>(group.uses.front().state)]->objects[object];
  rows.add({seen, &seen->observation});
  store_textures(group, solver.solve(rows.finish()), progress);
}

std::vector<std::vector<InferenceRun::Stack*>> InferenceRun::stacks_side_by_side() {
  std::vector<std::vector<Stack*>> result;
  size_t bytes = 0;
  for (Stack& stack : stacks_) {
    const size_t own = kStackTexelBytes * pyramids_[stack.object].size();
    if (result.empty() || bytes + own > kStackBytes) result.emplace_back(), bytes = 0;
    result.back().push_back(&stack);
    bytes += own;
  }
  return result;
}

void InferenceRun::process_stacks(std::span<Stack* const> stacks, MatrixReader& reader, Progress& progress) {
  std::vector<RowsOfStates> rows;
  for (const Stack* stack : stacks) rows.emplace_back(pyramids_[stack->object]);
  for (size_t s = 0; s < states_.size(); ++s) {
    progress.advance(0);
    const auto sees = [&](const Stack* stack) {
      return std::binary_search(stack->states.begin(), stack->states.end(), static_cast<int>(s));
    };
    if (std::none_of(stacks.begin(), stacks.end(), sees)) continue;
    const GeometryState* const states[] = {&states_[s]};
    StateMatrix matrix = std::move(reader.read(states).front());
    for (size_t i = 0; i < stacks.size(); ++i) {
      if (!sees(stacks[i])) continue;
      const auto at = std::lower_bound(stacks[i]->states.begin(), stacks[i]->states.end(), static_cast<int>(s));
      const auto object = std::make_shared<StateObject>(ObjectMatrix(matrix[stacks[i]->object]), options_);
      object->observation =
          make_observation(object->filtered, std::move(stacks[i]->weights[static_cast<size_t>(at - stacks[i]->states.begin())]));
      rows[i].add({object, &object->observation});
    }
  }
  for (size_t i = 0; i < stacks.size(); ++i) {
    const DataTerm& data = rows[i].finish();
    tbb::parallel_for(size_t{0}, stacks[i]->groups.size(), [&](size_t j) {
      const size_t g = stacks[i]->groups[j];
      store_textures(groups_[g], solvers_[g]->solve(data), progress);
      solvers_[g].reset();
    });
  }
}

void InferenceRun::release(std::span<const int> batch) {
  for (const int s : batch) data_[static_cast<size_t>(s)].reset();
}

void InferenceRun::store_textures(const SolveGroup& group, const std::vector<std::vector<glm::vec3>>& textures,
                                  Progress& progress) const {
  const DrawnObject& object = object_of(group);
  const Field& field = inference_.fields[static_cast<size_t>(group.field)];
  for (size_t t = 0; t < textures.size(); ++t) {
    LayeredImage image{object.texture_width, object.texture_height, {{"B", {}}, {"G", {}}, {"R", {}}}};
    for (const glm::vec3& texel : textures[t])
      for (int k = 0; k < 3; ++k) image.planes[static_cast<size_t>(2 - k)].values.push_back(std::min(texel[k], kLargestHalf));
    store_.save_planes(field.textures[static_cast<size_t>(group.textures[t])], image);
    progress.advance(1);
  }
}

bool InferenceRun::importance_missing() const {
  return std::any_of(importance_.begin(), importance_.end(), [](const auto& values) { return !values.empty(); });
}

// From the store where it is there; otherwise a vector of zeros to add to.
void InferenceRun::load_importance() {
  importance_.resize(inference_.objects.size());
  for (size_t i = 0; i < inference_.objects.size(); ++i) {
    const auto image = store_.load_planes(importance_keys_[i]);
    const bool found = image && image->planes.size() == 1 && image->planes[0].values.size() == pyramids_[i].finest_size();
    importance_[i].assign(found ? 0 : pyramids_[i].size(), 0.0f);
    if (!found) continue;
    for (Field& field : inference_.fields)
      if (static_cast<size_t>(field.drawn_object) == i) field.importance = image->planes[0].values;
  }
}

void InferenceRun::finish_importance() {
  for (size_t i = 0; i < importance_.size(); ++i) {
    if (importance_[i].empty()) continue;
    pyramids_[i].decimate_transposed(importance_[i].data());
    importance_[i].resize(pyramids_[i].finest_size());
    for (float& value : importance_[i]) value = std::min(value, kLargestHalf);
    store_.save_planes(
        importance_keys_[i],
        {inference_.objects[i].texture_width, inference_.objects[i].texture_height, {{"importance", importance_[i]}}});
  }
  load_importance();  // as rounded by the store, so that a resumed run goes on alike
}

}  // namespace vitrine
