// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/infer/inference_run.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <set>

#include "host/infer/light_survey.h"

namespace vitrine {
namespace {

constexpr int kInferenceVersion = 5;  // changes whenever the same input would give other textures
constexpr size_t kBatch = 8;          // states read at once, if their frames stay below
constexpr size_t kBatchFrameBytes = size_t{1} << 30;
constexpr size_t kFramePixelBytes = 40;  // of a loaded frame: the picture, and layers of about one object a pixel
constexpr float kLargestHalf = 65504;

void append(KeyBuilder& key, const StoreKey& part) {
  key.integer(static_cast<int64_t>(part.high));
  key.integer(static_cast<int64_t>(part.low));
}

}  // namespace

struct InferenceRun::StateObject {
  ObjectMatrix matrix;
  FilteredMatrix filtered;
  Observation observation;
};

struct InferenceRun::StateData {
  std::vector<Frame> frames;  // as table_.samples_of_state
  std::vector<std::unique_ptr<StateObject>> objects;
};

InferenceRun::InferenceRun(const Scene& scene, const std::vector<StoreKey>& frames, const Store& store, hal::Gpu& gpu,
                           const InferenceOptions& options, const StateTable& table, std::vector<GeometryState> states,
                           size_t stride, Inference& inference)
    : scene_(scene),
      frames_(frames),
      store_(store),
      gpu_(gpu),
      options_(options),
      table_(table),
      states_(std::move(states)),
      stride_(stride),
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
    for (SolveGroup& group :
         make_groups(scene_.space(), field.axes, table_, static_cast<int>(f), TextureSolver::kMaxTextures, stride_)) {
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
  const size_t bytes = frames * static_cast<size_t>(options_.width) * static_cast<size_t>(options_.height) * kFramePixelBytes;
  return std::clamp<size_t>(kBatchFrameBytes / std::max<size_t>(1, bytes), 1, kBatch);
}

void InferenceRun::solve_missing(Progress& progress) {
  load_importance();
  int64_t total = 0, missing = 0;
  for (const Field& field : inference_.fields) total += static_cast<int64_t>(field.textures.size());
  for (const SolveGroup& group : groups_) missing += static_cast<int64_t>(group.textures.size());
  progress.begin("inference", total, total - missing, "textures");
  const std::vector<int> states = needed_states();
  if (!states.empty()) {
    stacks_.resize(groups_.size());
    for (size_t g = 0; g < groups_.size(); ++g)
      if (groups_[g].uses.size() > 1) {
        const auto object = static_cast<size_t>(inference_.fields[static_cast<size_t>(groups_[g].field)].drawn_object);
        stacks_[g] = std::make_unique<TextureSolver>(pyramids_[object], groups_[g].textures.size(),
                                                     SolverOptions{options_.regularization, options_.iterations});
      }
    {
      TestRenderer renderer(gpu_, options_, inference_.objects);
      const auto reader = make_matrix_reader(renderer, inference_.objects, states_[static_cast<size_t>(states.front())]);
      const size_t batch = batch_size();
      for (size_t begin = 0; begin < states.size(); begin += batch)
        process_batch(std::span(states).subspan(begin, std::min(batch, states.size() - begin)), *reader, progress);
    }
    solve_stacks(progress);
    finish_importance();
  }
  progress.end();
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
    auto entry = std::make_unique<StateObject>();
    entry->matrix = std::move(matrices[job / objects][job % objects]);
    entry->filtered = FilteredMatrix(entry->matrix, options_.supersampling, options_.width, options_.height);
    entry->observation = make_observation(entry->filtered, inference_.objects[job % objects].object, frames);
    data.objects[job % objects] = std::move(entry);
  });
}

void InferenceRun::add_use(TextureSolver& solver, const SolveGroup& group, const SolveGroup::Use& use) {
  const StateData& data = *data_[static_cast<size_t>(use.state)];
  const auto object = static_cast<size_t>(inference_.fields[static_cast<size_t>(group.field)].drawn_object);
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

// Right sides of stacks, and importance: each object by itself, states in order.
void InferenceRun::gather(std::span<const int> batch) {
  tbb::parallel_for(size_t{0}, groups_.size(), [&](size_t g) {
    if (!stacks_[g]) return;
    for (const SolveGroup::Use& use : groups_[g].uses)
      if (std::find(batch.begin(), batch.end(), use.state) != batch.end()) add_use(*stacks_[g], groups_[g], use);
  });
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
  for (size_t g = 0; g < groups_.size(); ++g)
    if (!stacks_[g] && std::find(batch.begin(), batch.end(), groups_[g].uses.front().state) != batch.end())
      jobs.push_back(&groups_[g]);
  tbb::parallel_for(size_t{0}, jobs.size(), [&](size_t j) {
    const SolveGroup& group = *jobs[j];
    const auto object = static_cast<size_t>(inference_.fields[static_cast<size_t>(group.field)].drawn_object);
    TextureSolver solver(pyramids_[object], group.textures.size(), {options_.regularization, options_.iterations});
    add_use(solver, group, group.uses.front());
    store_textures(group, solver.solve(), progress);
  });
}

void InferenceRun::solve_stacks(Progress& progress) {
  std::vector<size_t> jobs;
  for (size_t g = 0; g < groups_.size(); ++g)
    if (stacks_[g]) jobs.push_back(g);
  tbb::parallel_for(size_t{0}, jobs.size(), [&](size_t j) {
    store_textures(groups_[jobs[j]], stacks_[jobs[j]]->solve(), progress);
    stacks_[jobs[j]].reset();
  });
}

// Keeps of a batch only matrices that stacks still need.
void InferenceRun::release(std::span<const int> batch) {
  for (const int s : batch) {
    StateData& data = *data_[static_cast<size_t>(s)];
    data.frames.clear();
    data.frames.shrink_to_fit();
    std::vector<bool> needed(data.objects.size());
    for (size_t g = 0; g < groups_.size(); ++g)
      for (const SolveGroup::Use& use : groups_[g].uses)
        if (stacks_[g] && use.state == s)
          needed[static_cast<size_t>(inference_.fields[static_cast<size_t>(groups_[g].field)].drawn_object)] = true;
    for (size_t object = 0; object < data.objects.size(); ++object)
      if (!needed[object]) data.objects[object].reset();
  }
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
