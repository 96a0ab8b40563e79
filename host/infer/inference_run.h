// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// One run over all states: reads matrices, solves what the store has not, stores it.
//
// States are taken in batches of a few. Textures that see a single state are solved as soon as its matrix is there; those
// that see many (a stack) gather their right sides. Samples between those of the grid come along with the states beside them,
// whose textures are solved from them as well. Then matrices are read again, for as many stacks at once as memory allows,
// and summed up: reading one takes a moment, keeping those of all states gigabytes. Everything that reaches a texture is added
// in the order of states, whatever the number of threads.
#pragma once

#include <memory>
#include <set>
#include <vector>

#include "host/infer/fields.h"
#include "host/infer/inference.h"
#include "host/infer/observation.h"
#include "host/infer/rows_of_states.h"
#include "host/infer/state_objects.h"

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
  struct StateData;
  struct Stack;  // what groups of one field share that lie alike and see the same states
  // What a state's samples show: a field by one of its maps.
  struct Shown {
    int field = 0;
    uint16_t map = 0;
    double samples = 0;  // how many, by their shares
  };

  void find_shown();
  void make_groups_and_keys();
  StoreKey texture_key(const SolveGroup& group, size_t texture, const StoreKey& base) const;
  StoreKey base_key() const;
  void load_importance();
  bool importance_missing() const;

  float share_of(int state) const { return state < table_.grid_states ? 1 : options_.between_share; }
  bool sees_many(const SolveGroup& group) const;
  std::set<int> needed_states() const;
  size_t batch_size() const;
  std::vector<std::vector<int>> plan_batches(const std::set<int>& needed) const;
  std::vector<Placement> usual_placements() const;
  // `next`: the batch after it.
  void process_batch(std::span<const int> batch, std::span<const int> next, StateObjectReader& reader, Progress& progress);
  void load(std::span<const int> batch, StateObjectReader& reader);
  void process_stacks(std::span<Stack* const> stacks, StateObjectReader& reader, Progress& progress);
  void add_rows(int state, std::span<Stack* const> stacks, StateObjectReader& reader, std::vector<RowsOfStates>& rows) const;
  void load_frames(std::span<const int> batch);
  void read_matrices(std::span<const int> batch, StateObjectReader& reader);
  void build_observations(std::span<const int> batch);
  SolverOptions solver_options() const;
  void make_stacks();
  void gather(std::span<const int> batch);
  void solve_single(std::span<const int> batch, Progress& progress);
  void solve_one(const SolveGroup& group, Progress& progress) const;
  std::vector<std::vector<Stack*>> stacks_side_by_side();
  void release(std::span<const int> batch, std::span<const int> next);
  void finish_importance();

  void add_use(TextureSolver& solver, const SolveGroup& group, const SolveGroup::Use& use) const;
  void store_textures(const SolveGroup& group, const std::vector<std::vector<glm::vec3>>& textures,
                      const std::vector<float>& precision, Progress& progress) const;
  Layer layer_of(const SolveGroup& group) const;
  const Field& field_of(const SolveGroup& group) const { return inference_.fields[static_cast<size_t>(group.field)]; }
  const Pyramid& pyramid_of(const SolveGroup& group) const { return pyramids_[static_cast<size_t>(group.field)]; }
  Placement placement_of(int field, uint16_t map) const;
  const std::shared_ptr<StateObject>& state_object(int state, int field, uint16_t map) const;

  const Scene& scene_;
  const std::vector<StoreKey>& frames_;
  const Store& store_;
  hal::Gpu& gpu_;
  const InferenceOptions& options_;
  const StateTable& table_;
  std::vector<GeometryState> states_;
  Inference& inference_;

  std::vector<Pyramid> pyramids_;                        // per field
  std::vector<std::vector<Shown>> shown_;                // per state
  std::vector<SolveGroup> groups_;                       // only with textures that are missing
  std::vector<std::unique_ptr<TextureSolver>> solvers_;  // per group that sees many states
  std::vector<Stack> stacks_;
  std::vector<std::unique_ptr<StateData>> data_;             // per state, of the batch
  std::vector<uint8_t> gathered_;                            // per state
  std::vector<StoreKey> importance_keys_;                    // per field
  std::vector<std::vector<std::vector<float>>> importance_;  // per field and map, all levels; empty where the store has it
};

}  // namespace vitrine
