// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/bench/matrix_costs.h"

#include "host/bench/processor_time.h"
#include "host/infer/coordinate_reader.h"
#include "host/infer/identifier_reader.h"

namespace vitrine {
namespace {

StateMatrix read_timed(MatrixReader& reader, const GeometryState& state, ReaderCost& cost) {
  const GeometryState* const states[] = {&state};
  reader.read(states);
  const int64_t before = reader.renderings();
  const double start = wall_seconds();
  std::vector<StateMatrix> matrices = reader.read(states);
  cost.milliseconds = 1000 * (wall_seconds() - start);
  cost.renderings = reader.renderings() - before;
  return std::move(matrices.front());
}

}  // namespace

MatrixCosts measure_matrix_costs(hal::Gpu& gpu, const InferenceOptions& options, std::span<const DrawnObject> objects,
                                 std::span<const TextureSize> sizes, const GeometryState& state) {
  MatrixCosts costs;
  TestRenderer renderer(gpu, options, objects);
  IdentifierReader identifiers(renderer, sizes);
  CoordinateReader coordinates(renderer, sizes);
  const StateMatrix a = read_timed(identifiers, state, costs.identifiers);
  const StateMatrix b = read_timed(coordinates, state, costs.coordinates);
  costs.largest_difference = largest_difference(a, b);
  return costs;
}

}  // namespace vitrine
