// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/infer/state_objects.h"

#include <utility>

namespace vitrine {
namespace {

struct Rendering {
  GeometryState geometry;
  std::vector<TextureSize> sizes;
  std::vector<StateObject*> entries;  // per object; null: drawn only for what it hides
};

Rendering rendering_of(const GeometryState& state, const std::vector<Placement>& usual) {
  Rendering rendering{state, {}, std::vector<StateObject*>(usual.size())};
  rendering.geometry.maps.clear();
  for (const Placement& placement : usual) {
    rendering.sizes.push_back(placement.size);
    rendering.geometry.maps.push_back(placement.map);
  }
  return rendering;
}

// Every request into the first rendering of its state that has room for the object.
std::vector<Rendering> plan_renderings(std::span<const StateObjectReader::Request> requests,
                                       const std::vector<Placement>& usual) {
  std::vector<Rendering> renderings;
  std::map<const GeometryState*, std::vector<size_t>> of_state;
  for (const StateObjectReader::Request& request : requests) {
    std::vector<size_t>& own = of_state[request.state];
    size_t round = 0;
    while (round < own.size() && renderings[own[round]].entries[request.object]) ++round;
    if (round == own.size()) {
      own.push_back(renderings.size());
      renderings.push_back(rendering_of(*request.state, usual));
    }
    Rendering& rendering = renderings[own[round]];
    rendering.entries[request.object] = request.entry;
    rendering.sizes[request.object] = request.entry->placement.size;
    rendering.geometry.maps[request.object] = request.entry->placement.map;
  }
  return renderings;
}

}  // namespace

void StateObjectReader::read(std::span<const Request> requests) {
  const std::vector<Rendering> renderings = plan_renderings(requests, usual_);
  std::map<std::vector<TextureSize>, std::vector<const Rendering*>> alike;
  for (const Rendering& rendering : renderings) alike[rendering.sizes].push_back(&rendering);
  for (const auto& [sizes, same] : alike) {
    std::unique_ptr<MatrixReader>& reader = readers_[sizes];
    if (!method_) method_ = choose_matrix_method(renderer_, sizes, same.front()->geometry);
    if (!reader) reader = make_matrix_reader(*method_, renderer_, sizes);
    std::vector<const GeometryState*> geometry;
    for (const Rendering* rendering : same) geometry.push_back(&rendering->geometry);
    std::vector<StateMatrix> matrices = reader->read(geometry);
    for (size_t r = 0; r < same.size(); ++r)
      for (size_t i = 0; i < usual_.size(); ++i)
        if (StateObject* entry = same[r]->entries[i]) entry->matrix = std::move(matrices[r][i]);
  }
}

}  // namespace vitrine
