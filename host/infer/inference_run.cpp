// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/infer/inference_run.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <map>
#include <stdexcept>
#include <utility>

#include "host/infer/light_survey.h"
#include "host/infer/rows_of_states.h"
#include "host/infer/state_objects.h"
#include "host/infer/texture_store.h"

namespace vitrine {
namespace {

constexpr int kInferenceVersion = 10;  // changes whenever the same input would give other textures
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

void append_map(KeyBuilder& key, const TextureMap& map) {
  for (size_t patch = 0; patch < static_cast<size_t>(map.patch_count); ++patch) {
    const auto values = map.patches[patch].values();
    key.bytes(values.data(), sizeof values);
  }
}

void append_field(KeyBuilder& key, const Inference& inference, const Field& field) {
  const DrawnObject& object = inference.objects[static_cast<size_t>(field.drawn_object)];
  key.text(field.layer);
  for (const int value : {object.object, field.texture_width, field.texture_height}) key.integer(value);
  key.bytes(object.vertices.data(), object.vertices.size() * sizeof(MeshVertex));
}

}  // namespace

struct InferenceRun::Stack {
  int field = 0;
  uint16_t map = 0;
  std::vector<int> states;  // ascending
  std::vector<size_t> groups;
  std::vector<std::vector<float>> weights;  // of the observations of `states`
};

struct InferenceRun::StateData {
  std::vector<Frame> frames;                                       // as table_.samples_of_state
  std::vector<std::vector<std::shared_ptr<StateObject>>> objects;  // per drawn object, one for every way it is laid out
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
      data_(states_.size()),
      gathered_(states_.size()) {
  for (const Field& field : inference_.fields) pyramids_.emplace_back(field.texture_width, field.texture_height);
  find_shown();
  make_groups_and_keys();
}

InferenceRun::~InferenceRun() = default;

void InferenceRun::find_shown() {
  shown_.resize(states_.size());
  for (size_t s = 0; s < states_.size(); ++s) {
    std::map<std::pair<int, uint16_t>, double> counts;
    for (const int64_t sample : table_.samples_of_state[s])
      for (int f = 0; f < static_cast<int>(inference_.fields.size()); ++f) {
        const Field& field = inference_.fields[static_cast<size_t>(f)];
        for (const int64_t shown : shown_at(table_, field, sample))
          counts[{f, map_number(field, field_sample_of(scene_.space(), field.axes, shown))}] +=
              static_cast<double>(share_of(static_cast<int>(s)));
      }
    for (const auto& [which, count] : counts) shown_[s].push_back({which.first, which.second, count});
  }
}

Placement InferenceRun::placement_of(int field, uint16_t map) const {
  const Field& f = inference_.fields[static_cast<size_t>(field)];
  return {f.size(), f.maps[map]};
}

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
  append_field(key, inference_, field_of(group));
  append_map(key, field_of(group).maps[group.map]);
  for (const SolveGroup::Use& use : group.uses) {
    key.integer(use.state);
    key.number(static_cast<double>(share_of(use.state)));
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
    for (SolveGroup& group : make_groups(scene_.space(), field, static_cast<int>(f), table_, TextureSolver::kMaxTextures)) {
      std::vector<size_t> missing;
      for (size_t t = 0; t < group.textures.size(); ++t) {
        StoreKey& key = field.textures[static_cast<size_t>(group.textures[t])];
        key = texture_key(group, t, base);
        if (!store_.has_planes(key)) missing.push_back(t);
      }
      if (missing.empty()) continue;
      SolveGroup rest{group.field, group.map, {}, {}};
      for (const size_t t : missing) rest.textures.push_back(group.textures[t]);
      for (const SolveGroup::Use& use : group.uses) {
        rest.uses.push_back({use.state, {}});
        for (const size_t t : missing) rest.uses.back().samples.push_back(use.samples[t]);
      }
      groups_.push_back(std::move(rest));
    }
  }
  for (const Field& field : inference_.fields) {
    KeyBuilder key;
    key.text("importance");
    append(key, base);
    append_field(key, inference_, field);
    for (const TextureMap& map : field.maps) append_map(key, map);
    for (const uint16_t map : field.block_maps) key.integer(map);
    key.number(static_cast<double>(options_.between_share));
    for (const StoreKey& frame : frames_) append(key, frame);
    importance_keys_.push_back(key.finish());
  }
}

Layer InferenceRun::layer_of(const SolveGroup& group) const {
  return inference_.fields[static_cast<size_t>(group.field)].layer == layer_name(Layer::kDiffuse) ? Layer::kDiffuse
                                                                                                  : Layer::kSpecular;
}

const std::shared_ptr<StateObject>& InferenceRun::state_object(int state, int field, uint16_t map) const {
  const Placement placement = placement_of(field, map);
  const auto object = static_cast<size_t>(inference_.fields[static_cast<size_t>(field)].drawn_object);
  for (const auto& candidate : data_[static_cast<size_t>(state)]->objects[object])
    if (candidate->placement == placement) return candidate;
  throw std::logic_error("a texture is solved for that its state does not show");
}

// Several states of the grid. Those of samples between come along with the one that they are beside, and need no stack.
bool InferenceRun::sees_many(const SolveGroup& group) const {
  return group.uses.size() > 1 && group.uses[1].state < table_.grid_states;
}

std::set<int> InferenceRun::needed_states() const {
  std::set<int> needed;
  for (const SolveGroup& group : groups_)
    for (const SolveGroup::Use& use : group.uses) needed.insert(use.state);
  if (importance_missing())
    for (size_t s = 0; s < states_.size(); ++s) needed.insert(static_cast<int>(s));
  return needed;
}

// Grid states in their order, each with those between that are beside it.
std::vector<std::vector<int>> InferenceRun::plan_batches(const std::set<int>& needed) const {
  std::map<int, std::set<int>> beside;
  for (size_t b = 0; b < table_.between.size(); ++b) {
    const int state = table_.state_of_sample[static_cast<size_t>(table_.grid_samples()) + b];
    for (const int64_t sample : table_.between[b].beside)
      if (needed.count(state)) beside[table_.state_of_sample[static_cast<size_t>(sample)]].insert(state);
  }
  std::vector<std::vector<int>> batches;
  const size_t size = batch_size();
  const auto end = needed.lower_bound(table_.grid_states);
  for (auto at = needed.begin(); at != end;) {
    std::set<int> batch;
    for (size_t i = 0; i < size && at != end; ++i, ++at) {
      batch.insert(*at);
      batch.insert(beside[*at].begin(), beside[*at].end());
    }
    batches.emplace_back(batch.begin(), batch.end());
  }
  return batches;
}

// In grid states.
size_t InferenceRun::batch_size() const {
  const size_t frames = (frames_.size() + states_.size() - 1) / states_.size();
  const size_t supersamples = static_cast<size_t>(options_.supersampling * options_.supersampling);
  const size_t bytes = static_cast<size_t>(options_.width) * static_cast<size_t>(options_.height) *
                       (frames * kFramePixelBytes + supersamples * kSupersampleBytes);
  const size_t with_those_between =
      (states_.size() + static_cast<size_t>(table_.grid_states) - 1) / static_cast<size_t>(table_.grid_states);
  return std::max<size_t>(1, std::min(kBatchBytes / std::max<size_t>(1, bytes), kBatch) / with_those_between);
}

void InferenceRun::solve_missing(Progress& progress) {
  load_importance();
  int64_t total = 0, missing = 0;
  for (const Field& field : inference_.fields) total += static_cast<int64_t>(field.textures.size());
  for (const SolveGroup& group : groups_) missing += static_cast<int64_t>(group.textures.size());
  progress.begin("inference", total, total - missing, "textures");
  const std::vector<std::vector<int>> batches = plan_batches(needed_states());
  if (!batches.empty()) {
    make_stacks();
    {
      StateObjectReader reader(gpu_, options_, inference_.objects, usual_placements());
      for (size_t b = 0; b < batches.size(); ++b)
        process_batch(batches[b], b + 1 < batches.size() ? batches[b + 1] : std::vector<int>{}, reader, progress);
      finish_importance();
      for (const auto& stacks : stacks_side_by_side()) process_stacks(stacks, reader, progress);
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

// A rendering that asks for one texture of an object only takes its first one otherwise: fewer combinations of sizes.
std::vector<Placement> InferenceRun::usual_placements() const {
  std::vector<Placement> usual(inference_.objects.size(), {{1, 1}, {}});
  for (size_t f = inference_.fields.size(); f-- > 0;)
    usual[static_cast<size_t>(inference_.fields[f].drawn_object)] = placement_of(static_cast<int>(f), 0);
  return usual;
}

void InferenceRun::make_stacks() {
  solvers_.resize(groups_.size());
  for (size_t g = 0; g < groups_.size(); ++g) {
    if (!sees_many(groups_[g])) continue;
    const SolveGroup& group = groups_[g];
    solvers_[g] = std::make_unique<TextureSolver>(pyramid_of(group), group.textures.size(), solver_options());
    std::vector<int> states;
    for (const SolveGroup::Use& use : group.uses) states.push_back(use.state);
    const auto same = [&](const Stack& stack) {
      return stack.field == group.field && stack.map == group.map && stack.states == states;
    };
    auto stack = std::find_if(stacks_.begin(), stacks_.end(), same);
    if (stack == stacks_.end()) {
      const size_t count = states.size();
      stack = stacks_.insert(stacks_.end(), Stack{group.field, group.map, std::move(states), {}, {}});
      stack->weights.resize(count);
    }
    stack->groups.push_back(g);
  }
}

void InferenceRun::process_batch(std::span<const int> batch, std::span<const int> next, StateObjectReader& reader,
                                 Progress& progress) {
  progress.advance(0);
  load(batch, reader);
  gather(batch);
  solve_single(batch, progress);
  release(batch, next);
}

// What the batch before has not left.
void InferenceRun::load(std::span<const int> batch, StateObjectReader& reader) {
  std::vector<int> lacking;
  for (const int s : batch)
    if (!data_[static_cast<size_t>(s)]) lacking.push_back(s);
  load_frames(lacking);
  read_matrices(lacking, reader);
  build_observations(lacking);
}

void InferenceRun::read_matrices(std::span<const int> batch, StateObjectReader& reader) {
  std::vector<StateObjectReader::Request> requests;
  for (const int s : batch) {
    StateData& data = *data_[static_cast<size_t>(s)];
    data.objects.resize(inference_.objects.size());
    for (const Shown& shown : shown_[static_cast<size_t>(s)]) {
      const Placement placement = placement_of(shown.field, shown.map);
      const auto object = static_cast<size_t>(inference_.fields[static_cast<size_t>(shown.field)].drawn_object);
      auto& own = data.objects[object];
      if (std::any_of(own.begin(), own.end(), [&](const auto& o) { return o->placement == placement; })) continue;
      own.push_back(std::make_shared<StateObject>(placement));
      requests.push_back({&states_[static_cast<size_t>(s)], object, own.back().get()});
    }
  }
  reader.read(requests);
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

void InferenceRun::build_observations(std::span<const int> batch) {
  struct Job {
    int state;
    int object;
    StateObject* entry;
  };
  std::vector<Job> jobs;
  for (const int s : batch) {
    const StateData& data = *data_[static_cast<size_t>(s)];
    for (size_t i = 0; i < data.objects.size(); ++i)
      for (const auto& entry : data.objects[i]) jobs.push_back({s, inference_.objects[i].object, entry.get()});
  }
  tbb::parallel_for(size_t{0}, jobs.size(), [&](size_t j) {
    std::vector<const Frame*> frames;
    for (const Frame& frame : data_[static_cast<size_t>(jobs[j].state)]->frames) frames.push_back(&frame);
    StateObject& entry = *jobs[j].entry;
    entry.filter(options_);
    entry.observation = make_observation(entry.filtered, jobs[j].object, frames, share_of(jobs[j].state));
  });
}

void InferenceRun::add_use(TextureSolver& solver, const SolveGroup& group, const SolveGroup::Use& use) const {
  const StateData& data = *data_[static_cast<size_t>(use.state)];
  const auto object = static_cast<size_t>(field_of(group).drawn_object);
  const Observation& observation = state_object(use.state, group.field, group.map)->observation;
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

// Right sides and weights of stacks, and importance, of states that no batch before held: each object by itself, states in order.
void InferenceRun::gather(std::span<const int> whole_batch) {
  std::vector<int> batch;
  for (const int s : whole_batch)
    if (!std::exchange(gathered_[static_cast<size_t>(s)], 1)) batch.push_back(s);
  tbb::parallel_for(size_t{0}, groups_.size(), [&](size_t g) {
    if (!solvers_[g]) return;
    for (const SolveGroup::Use& use : groups_[g].uses)
      if (std::find(batch.begin(), batch.end(), use.state) != batch.end()) add_use(*solvers_[g], groups_[g], use);
  });
  for (Stack& stack : stacks_)
    for (const int s : batch)
      if (const auto at = std::lower_bound(stack.states.begin(), stack.states.end(), s); at != stack.states.end() && *at == s)
        stack.weights[static_cast<size_t>(at - stack.states.begin())] =
            state_object(s, stack.field, stack.map)->observation.weight;
  tbb::parallel_for(size_t{0}, importance_.size(), [&](size_t field) {
    for (const int s : batch)
      for (const Shown& shown : shown_[static_cast<size_t>(s)]) {
        if (static_cast<size_t>(shown.field) != field || importance_[field].empty()) continue;
        add_importance(state_object(s, shown.field, shown.map)->observation, static_cast<float>(shown.samples),
                       importance_[field][shown.map]);
      }
  });
}

void InferenceRun::solve_single(std::span<const int> batch, Progress& progress) {
  std::vector<const SolveGroup*> jobs;
  const auto texels_of = [&](const SolveGroup* group) { return pyramid_of(*group).finest_size(); };
  const auto bytes_of = [&](const SolveGroup* group) {
    return (kSolverTexelBytes + (group->uses.size() > 1 ? kStackTexelBytes : 0)) * texels_of(group);
  };
  for (size_t g = 0; g < groups_.size(); ++g)
    if (!sees_many(groups_[g]) && std::find(batch.begin(), batch.end(), groups_[g].uses.front().state) != batch.end())
      jobs.push_back(&groups_[g]);
  std::stable_sort(jobs.begin(), jobs.end(),
                   [&](const SolveGroup* a, const SolveGroup* b) { return texels_of(a) > texels_of(b); });
  for (size_t begin = 0, end = 0; begin < jobs.size(); begin = end) {
    for (size_t bytes = 0; end < jobs.size(); ++end) {
      bytes += bytes_of(jobs[end]);
      if (end > begin && bytes > kSolverBytes) break;
    }
    tbb::parallel_for(begin, end, [&](size_t j) { solve_one(*jobs[j], progress); });
  }
}

void InferenceRun::solve_one(const SolveGroup& group, Progress& progress) const {
  TextureSolver solver(pyramid_of(group), group.textures.size(), solver_options());
  RowsOfStates rows(pyramid_of(group));
  for (const SolveGroup::Use& use : group.uses) {
    add_use(solver, group, use);
    const std::shared_ptr<StateObject>& seen = state_object(use.state, group.field, group.map);
    rows.add({seen, &seen->observation});
  }
  store_textures(group, solver.solve(rows.finish()), solver.precision(), progress);
}

std::vector<std::vector<InferenceRun::Stack*>> InferenceRun::stacks_side_by_side() {
  std::vector<std::vector<Stack*>> result;
  size_t bytes = 0;
  for (Stack& stack : stacks_) {
    const size_t own = kStackTexelBytes * pyramids_[static_cast<size_t>(stack.field)].size();
    if (result.empty() || bytes + own > kStackBytes) result.emplace_back(), bytes = 0;
    result.back().push_back(&stack);
    bytes += own;
  }
  return result;
}

void InferenceRun::process_stacks(std::span<Stack* const> stacks, StateObjectReader& reader, Progress& progress) {
  std::vector<RowsOfStates> rows;
  for (const Stack* stack : stacks) rows.emplace_back(pyramids_[static_cast<size_t>(stack->field)]);
  for (int s = 0; s < static_cast<int>(states_.size()); ++s) {
    progress.advance(0);
    add_rows(s, stacks, reader, rows);
  }
  for (size_t i = 0; i < stacks.size(); ++i) {
    const DataTerm& data = rows[i].finish();
    tbb::parallel_for(size_t{0}, stacks[i]->groups.size(), [&](size_t j) {
      const size_t g = stacks[i]->groups[j];
      const auto textures = solvers_[g]->solve(data);
      store_textures(groups_[g], textures, solvers_[g]->precision(), progress);
      solvers_[g].reset();
    });
  }
}

// To rows[i] what stacks[i] sees in a state.
void InferenceRun::add_rows(int state, std::span<Stack* const> stacks, StateObjectReader& reader,
                            std::vector<RowsOfStates>& rows) const {
  std::vector<std::shared_ptr<StateObject>> entries(stacks.size());
  std::vector<StateObjectReader::Request> requests;
  for (size_t i = 0; i < stacks.size(); ++i) {
    if (!std::binary_search(stacks[i]->states.begin(), stacks[i]->states.end(), state)) continue;
    entries[i] = std::make_shared<StateObject>(placement_of(stacks[i]->field, stacks[i]->map));
    const Field& field = inference_.fields[static_cast<size_t>(stacks[i]->field)];
    requests.push_back({&states_[static_cast<size_t>(state)], static_cast<size_t>(field.drawn_object), entries[i].get()});
  }
  reader.read(requests);
  for (size_t i = 0; i < stacks.size(); ++i) {
    if (!entries[i]) continue;
    const auto at = std::lower_bound(stacks[i]->states.begin(), stacks[i]->states.end(), state);
    entries[i]->filter(options_);
    entries[i]->observation =
        make_observation(entries[i]->filtered, std::move(stacks[i]->weights[static_cast<size_t>(at - stacks[i]->states.begin())]),
                         share_of(state));
    rows[i].add({entries[i], &entries[i]->observation});
  }
}

void InferenceRun::release(std::span<const int> batch, std::span<const int> next) {
  for (const int s : batch)
    if (std::find(next.begin(), next.end(), s) == next.end()) data_[static_cast<size_t>(s)].reset();
}

void InferenceRun::store_textures(const SolveGroup& group, const std::vector<std::vector<glm::vec3>>& textures,
                                  const std::vector<float>& precision, Progress& progress) const {
  const Field& field = field_of(group);
  for (size_t t = 0; t < textures.size(); ++t) {
    save_solved_texture(store_, field.textures[static_cast<size_t>(group.textures[t])], field.size(), {textures[t], precision});
    progress.advance(1);
  }
}

bool InferenceRun::importance_missing() const {
  return std::any_of(importance_.begin(), importance_.end(), [](const auto& values) { return !values.empty(); });
}

// From the store where it is there; otherwise zeros to add to.
void InferenceRun::load_importance() {
  importance_.assign(inference_.fields.size(), {});
  for (size_t f = 0; f < inference_.fields.size(); ++f) {
    Field& field = inference_.fields[f];
    const auto image = store_.load_planes(importance_keys_[f]);
    if (!image || image->planes.size() != field.maps.size()) {
      importance_[f].assign(field.maps.size(), std::vector<float>(pyramids_[f].size()));
      continue;
    }
    field.importance.clear();
    for (const LayeredImage::Plane& plane : image->planes) field.importance.push_back(plane.values);
  }
}

void InferenceRun::finish_importance() {
  for (size_t f = 0; f < importance_.size(); ++f) {
    if (importance_[f].empty()) continue;
    const Field& field = inference_.fields[f];
    LayeredImage image{field.texture_width, field.texture_height, {}};
    for (size_t m = 0; m < field.maps.size(); ++m) {
      std::vector<float>& own = importance_[f][m];
      double frames = 0;
      for (const auto& state : shown_)
        for (const Shown& shown : state)
          if (shown.field == static_cast<int>(f) && shown.map == m) frames += shown.samples;
      pyramids_[f].decimate_transposed(own.data());
      own.resize(pyramids_[f].finest_size());
      for (float& value : own) value = std::min(value / static_cast<float>(std::max(1.0, frames)), kLargestHalf);
      image.planes.push_back({fmt::format("map{:05}", m), std::move(own)});
    }
    store_.save_planes(importance_keys_[f], image);
  }
  load_importance();  // as rounded by the store, so that a resumed run goes on alike
}

}  // namespace vitrine
