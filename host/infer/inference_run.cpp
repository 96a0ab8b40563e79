// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/infer/inference_run.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <map>
#include <set>
#include <stdexcept>

#include "host/infer/light_survey.h"

namespace vitrine {
namespace {

constexpr int kInferenceVersion = 6;  // changes whenever the same input would give other textures
constexpr size_t kBatch = 8;          // states read at once, if their frames stay below
constexpr size_t kBatchFrameBytes = size_t{1} << 30;
constexpr size_t kFramePixelBytes = 40;  // of a loaded frame: the picture, and layers of about one object a pixel
constexpr float kLargestHalf = 65504;

void append(KeyBuilder& key, const StoreKey& part) {
  key.integer(static_cast<int64_t>(part.high));
  key.integer(static_cast<int64_t>(part.low));
}

void append_map(KeyBuilder& key, const TextureMap& map) {
  const auto values = map.values();
  key.bytes(values.data(), sizeof values);
}

void append_field(KeyBuilder& key, const Inference& inference, const Field& field) {
  const DrawnObject& object = inference.objects[static_cast<size_t>(field.drawn_object)];
  key.text(field.layer);
  for (const int value : {object.object, field.texture_width, field.texture_height}) key.integer(value);
  key.bytes(object.vertices.data(), object.vertices.size() * sizeof(MeshVertex));
}

}  // namespace

struct InferenceRun::StateObject {
  Placement placement;
  ObjectMatrix matrix;
  FilteredMatrix filtered;
  Observation observation;
};

struct InferenceRun::StateData {
  std::vector<Frame> frames;                                       // as table_.samples_of_state
  std::vector<std::vector<std::unique_ptr<StateObject>>> objects;  // per drawn object, one for every way it is laid out
};

struct InferenceRun::Device {
  TestRenderer renderer;
  std::map<std::vector<TextureSize>, std::unique_ptr<MatrixReader>> readers;  // by the sizes of all objects' textures

  MatrixReader& reader_of(const std::vector<TextureSize>& sizes, const GeometryState& state) {
    std::unique_ptr<MatrixReader>& reader = readers[sizes];
    if (!reader) reader = make_matrix_reader(renderer, sizes, state);
    return *reader;
  }
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
  for (const Field& field : inference_.fields) pyramids_.emplace_back(field.texture_width, field.texture_height);
  find_shown();
  make_groups_and_keys();
}

InferenceRun::~InferenceRun() = default;

void InferenceRun::find_shown() {
  shown_.resize(states_.size());
  for (size_t s = 0; s < states_.size(); ++s) {
    std::map<std::pair<int, uint16_t>, int64_t> counts;
    for (const int64_t sample : table_.samples_of_state[s])
      for (int f = 0; f < static_cast<int>(inference_.fields.size()); ++f) {
        const Field& field = inference_.fields[static_cast<size_t>(f)];
        ++counts[{f, map_number(field, field_sample_of(scene_.space(), field.axes, sample))}];
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
         make_groups(scene_.space(), field, static_cast<int>(f), table_, TextureSolver::kMaxTextures, stride_)) {
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
    for (const StoreKey& frame : frames_) append(key, frame);
    importance_keys_.push_back(key.finish());
  }
}

Layer InferenceRun::layer_of(const SolveGroup& group) const {
  return inference_.fields[static_cast<size_t>(group.field)].layer == layer_name(Layer::kDiffuse) ? Layer::kDiffuse
                                                                                                  : Layer::kSpecular;
}

InferenceRun::StateObject& InferenceRun::state_object(int state, int field, uint16_t map) const {
  const Placement placement = placement_of(field, map);
  const auto object = static_cast<size_t>(inference_.fields[static_cast<size_t>(field)].drawn_object);
  for (const auto& candidate : data_[static_cast<size_t>(state)]->objects[object])
    if (candidate->placement == placement) return *candidate;
  throw std::logic_error("a texture is solved for that its state does not show");
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
        stacks_[g] = std::make_unique<TextureSolver>(pyramids_[static_cast<size_t>(groups_[g].field)], groups_[g].textures.size(),
                                                     SolverOptions{options_.regularization, options_.iterations});
      }
    {
      Device device{TestRenderer(gpu_, options_, inference_.objects), {}};
      const size_t batch = batch_size();
      for (size_t begin = 0; begin < states.size(); begin += batch)
        process_batch(std::span(states).subspan(begin, std::min(batch, states.size() - begin)), device, progress);
    }
    solve_stacks(progress);
    finish_importance();
  }
  progress.end();
}

void InferenceRun::process_batch(std::span<const int> batch, Device& device, Progress& progress) {
  progress.advance(0);
  load_frames(batch);
  read_matrices(batch, device);
  build_observations(batch);
  gather(batch);
  solve_single(batch, progress);
  release(batch);
}

// A rendering shows every object with one texture, so a state is rendered as often as its objects have ways to be laid out.
void InferenceRun::read_matrices(std::span<const int> batch, Device& device) {
  struct Rendering {
    int state = 0;
    GeometryState geometry;
    std::vector<StateObject*> objects;  // null: drawn only for what it hides
  };
  std::map<std::vector<TextureSize>, std::vector<Rendering>> renderings;
  for (const int s : batch) {
    StateData& data = *data_[static_cast<size_t>(s)];
    data.objects.resize(inference_.objects.size());
    for (const Shown& shown : shown_[static_cast<size_t>(s)]) {
      const Placement placement = placement_of(shown.field, shown.map);
      auto& own = data.objects[static_cast<size_t>(inference_.fields[static_cast<size_t>(shown.field)].drawn_object)];
      if (std::any_of(own.begin(), own.end(), [&](const auto& o) { return o->placement == placement; })) continue;
      own.push_back(std::make_unique<StateObject>());
      own.back()->placement = placement;
    }
    size_t rounds = 0;
    for (const auto& own : data.objects) rounds = std::max(rounds, own.size());
    for (size_t round = 0; round < rounds; ++round) {
      Rendering rendering{s, states_[static_cast<size_t>(s)], {}};
      std::vector<TextureSize> sizes;
      for (const auto& own : data.objects) {
        const Placement placement = own.empty() ? Placement{{1, 1}, {}} : own[std::min(round, own.size() - 1)]->placement;
        sizes.push_back(placement.size);
        rendering.geometry.maps.push_back(placement.map);
        rendering.objects.push_back(round < own.size() ? own[round].get() : nullptr);
      }
      renderings[sizes].push_back(std::move(rendering));
    }
  }
  for (auto& [sizes, same] : renderings) {
    std::vector<const GeometryState*> geometry;
    for (const Rendering& rendering : same) geometry.push_back(&rendering.geometry);
    std::vector<StateMatrix> matrices = device.reader_of(sizes, same.front().geometry).read(geometry);
    for (size_t r = 0; r < same.size(); ++r)
      for (size_t i = 0; i < same[r].objects.size(); ++i)
        if (same[r].objects[i]) same[r].objects[i]->matrix = std::move(matrices[r][i]);
  }
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
    const StateData* data;
    int object;
    StateObject* entry;
  };
  std::vector<Job> jobs;
  for (const int s : batch) {
    const StateData& data = *data_[static_cast<size_t>(s)];
    for (size_t i = 0; i < data.objects.size(); ++i)
      for (const auto& entry : data.objects[i]) jobs.push_back({&data, inference_.objects[i].object, entry.get()});
  }
  tbb::parallel_for(size_t{0}, jobs.size(), [&](size_t j) {
    std::vector<const Frame*> frames;
    for (const Frame& frame : jobs[j].data->frames) frames.push_back(&frame);
    StateObject& entry = *jobs[j].entry;
    entry.filtered = FilteredMatrix(entry.matrix, options_.supersampling, options_.width, options_.height);
    entry.observation = make_observation(entry.filtered, jobs[j].object, frames);
  });
}

void InferenceRun::add_use(TextureSolver& solver, const SolveGroup& group, const SolveGroup::Use& use) {
  const StateData& data = *data_[static_cast<size_t>(use.state)];
  const auto object = static_cast<size_t>(field_of(group).drawn_object);
  const Observation& observation = state_object(use.state, group.field, group.map).observation;
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
  tbb::parallel_for(size_t{0}, importance_.size(), [&](size_t field) {
    if (importance_[field].empty()) return;
    for (const int s : batch)
      for (const Shown& shown : shown_[static_cast<size_t>(s)]) {
        if (static_cast<size_t>(shown.field) != field) continue;
        const float share = static_cast<float>(shown.samples) / static_cast<float>(frames_.size());
        add_importance(state_object(s, shown.field, shown.map).observation, share, importance_[field]);
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
    TextureSolver solver(pyramids_[static_cast<size_t>(group.field)], group.textures.size(),
                         {options_.regularization, options_.iterations});
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
    std::set<const StateObject*> needed;
    for (size_t g = 0; g < groups_.size(); ++g)
      for (const SolveGroup::Use& use : groups_[g].uses)
        if (stacks_[g] && use.state == s) needed.insert(&state_object(s, groups_[g].field, groups_[g].map));
    for (auto& own : data.objects)
      std::erase_if(own, [&](const auto& entry) { return needed.find(entry.get()) == needed.end(); });
  }
}

void InferenceRun::store_textures(const SolveGroup& group, const std::vector<std::vector<glm::vec3>>& textures,
                                  Progress& progress) const {
  const Field& field = field_of(group);
  for (size_t t = 0; t < textures.size(); ++t) {
    LayeredImage image{field.texture_width, field.texture_height, {{"B", {}}, {"G", {}}, {"R", {}}}};
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
  importance_.resize(inference_.fields.size());
  for (size_t f = 0; f < inference_.fields.size(); ++f) {
    const auto image = store_.load_planes(importance_keys_[f]);
    const bool found = image && image->planes.size() == 1 && image->planes[0].values.size() == pyramids_[f].finest_size();
    importance_[f].assign(found ? 0 : pyramids_[f].size(), 0.0f);
    if (found) inference_.fields[f].importance = image->planes[0].values;
  }
}

void InferenceRun::finish_importance() {
  for (size_t i = 0; i < importance_.size(); ++i) {
    if (importance_[i].empty()) continue;
    pyramids_[i].decimate_transposed(importance_[i].data());
    importance_[i].resize(pyramids_[i].finest_size());
    for (float& value : importance_[i]) value = std::min(value, kLargestHalf);
    const Field& field = inference_.fields[i];
    store_.save_planes(importance_keys_[i], {field.texture_width, field.texture_height, {{"importance", importance_[i]}}});
  }
  load_importance();  // as rounded by the store, so that a resumed run goes on alike
}

}  // namespace vitrine
