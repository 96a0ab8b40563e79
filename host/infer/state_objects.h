// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// What inference knows of an object in a geometry state, drawn with one texture: its rendering matrix, filtered, and which pixels
// count.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "host/infer/data_term.h"
#include "host/infer/rendering_matrix.h"
#include "host/infer/test_renderer.h"

namespace vitrine {

struct StateObject {
  explicit StateObject(const Placement& p) : placement(p) {}
  StateObject(const StateObject&) = delete;
  StateObject& operator=(const StateObject&) = delete;
  void filter(const InferenceOptions& options) {
    filtered = FilteredMatrix(matrix, options.supersampling, options.width, options.height);
  }

  Placement placement;
  ObjectMatrix matrix;
  FilteredMatrix filtered;
  Observation observation;
};

// Reads matrices of objects with any of their textures. Keeps references.
class StateObjectReader {
 public:
  // `usual`: per object, the placement that it is drawn with where none of its own is asked for.
  StateObjectReader(hal::Gpu& gpu, const InferenceOptions& options, std::span<const DrawnObject> objects,
                    std::vector<Placement> usual)
      : renderer_(gpu, options, objects), usual_(std::move(usual)) {}

  struct Request {
    const GeometryState* state = nullptr;
    size_t object = 0;
    StateObject* entry = nullptr;  // its matrix is filled
  };
  // A rendering shows every object with one texture, so a state is rendered as often as one of its objects is asked for.
  void read(std::span<const Request> requests);

 private:
  TestRenderer renderer_;
  std::vector<Placement> usual_;
  std::optional<MatrixMethod> method_;                                         // chosen by the first rendering
  std::map<std::vector<TextureSize>, std::unique_ptr<MatrixReader>> readers_;  // by the sizes of all objects' textures
};

}  // namespace vitrine
