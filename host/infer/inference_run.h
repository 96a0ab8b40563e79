// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// One run over all states: reads matrices, solves what the store has not, stores it.
//
// States are taken in batches of a few. Textures that see a single state are solved as soon as its matrix is there; those
// that see many (a stack) gather their right sides. Then matrices are read again, for as many stacks at once as memory allows,
// and summed up: reading one takes a moment, keeping those of all states gigabytes. Everything that reaches a texture is added
// in the order of states, whatever the number of threads.
#pragma once

#include <memory>
#include <vector>

#include "host/infer/fields.h"
#include "host/infer/inference.h"
#include "host/infer/observation.h"
#include "host/infer/rendering_matrix.h"

namespace vitrine {

class InferenceRun {
 public:
  // Fills keys of the textures of all fields of `inference`, which must stay. `states`: as numbered by `table`, for
  // inference.objects.
  InferenceRun(const Scene& scene, const std::vector<StoreKey>& frames, const Store& store, hal::Gpu& gpu,
               const InferenceOptions& options, const StateTable& table, std::vector<GeometryState> states, Inference& inference);
  ~InferenceRun();

  // Solves and stores what is missing, then fills the fields' importance.
  void solve_missing(Progress& progress);

 private:
  struct StateObject;  // matrix, filter and weights of one object in one state
  struct StateData;
  struct Stack;  // what groups of one object share that see the same states

  void make_groups_and_keys();
  StoreKey texture_key(const SolveGroup& group, size_t texture, const StoreKey& base) const;
  StoreKey base_key() const;
  void load_importance();
  bool importance_missing() const;

  std::vector<int> needed_states() const;
  size_t batch_size() const;
  void process_batch(std::span<const int> batch, MatrixReader& reader, Progress& progress);
  void process_stacks(std::span<Stack* const> stacks, MatrixReader& reader, Progress& progress);
  void load_frames(std::span<const int> batch);
  void build_observations(std::span<const int> batch, std::vector<StateMatrix> matrices);
  SolverOptions solver_options() const;
  void make_stacks();
  void gather(std::span<const int> batch);
  void solve_single(std::span<const int> batch, Progress& progress);
  void solve_one(const SolveGroup& group, Progress& progress) const;
  std::vector<std::vector<Stack*>> stacks_side_by_side();
  void release(std::span<const int> batch);
  void finish_importance();

  size_t object_number(const SolveGroup& group) const;
  void add_use(TextureSolver& solver, const SolveGroup& group, const SolveGroup::Use& use) const;
  void store_textures(const SolveGroup& group, const std::vector<std::vector<glm::vec3>>& textures, Progress& progress) const;
  Layer layer_of(const SolveGroup& group) const;
  const DrawnObject& object_of(const SolveGroup& group) const;

  const Scene& scene_;
  const std::vector<StoreKey>& frames_;
  const Store& store_;
  hal::Gpu& gpu_;
  const InferenceOptions& options_;
  const StateTable& table_;
  std::vector<GeometryState> states_;
  Inference& inference_;

  std::vector<Pyramid> pyramids_;                        // per drawn object
  std::vector<SolveGroup> groups_;                       // only with textures that are missing
  std::vector<std::unique_ptr<TextureSolver>> solvers_;  // per group that sees many states
  std::vector<Stack> stacks_;
  std::vector<std::unique_ptr<StateData>> data_;  // per state, of the batch
  std::vector<StoreKey> importance_keys_;         // per drawn object
  std::vector<std::vector<float>> importance_;    // per drawn object, all levels; empty where the store has it
};

}  // namespace vitrine
