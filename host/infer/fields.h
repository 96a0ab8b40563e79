// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Which layers of which objects become fields, on which axes they depend, and which of their textures are solved together.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "formats/parameter_space.h"
#include "host/infer/inference.h"
#include "host/scene/scene.h"

namespace vitrine {

enum class Layer : uint8_t { kDiffuse, kSpecular };
inline constexpr Layer kLayers[] = {Layer::kDiffuse, Layer::kSpecular};
const char* layer_name(Layer layer);

// Axes that move the camera and change nothing else: no object, no light, no switch.
AxisMask only_camera_axes(const Scene& scene);

// A place half-way between two neighbouring grid samples, where the target shows the textures of either.
struct BetweenSample {
  int axis = 0;
  Position position{};
  std::array<int64_t, 2> beside{};  // the grid samples, flat
};
// Along the axes of only_camera_axes, one at a time, in the order of the first grid sample beside them.
std::vector<BetweenSample> between_samples(const Scene& scene);

// Samples that agree on the axes that move camera or objects share one rendering matrix. Samples are numbered: those of the
// grid, flat, and after them those of `between`, which have states of their own.
struct StateTable {
  std::vector<int> state_of_sample;
  std::vector<std::vector<int64_t>> samples_of_state;  // ascending; states of grid samples come first
  int grid_states = 0;                                 // how many those are
  std::vector<BetweenSample> between;

  int64_t grid_samples() const { return static_cast<int64_t>(state_of_sample.size() - between.size()); }
};
StateTable make_states(const ParameterSpace& space, AxisMask geometry_axes);

// specular: all axes. diffuse: all but those that move only the camera; of an object whose materials are all unlit in all
// variants, and of the backdrop, only the axes that switch its own material or emission. Axes with one sample never count.
AxisMask field_axes(const Scene& scene, const Object& object, Layer layer);

// The field's blocks, each with a single node.
FieldShape blocks_of(const Field& field);

// Which of the field's maps its texture `flat` (in its own space) is laid on by.
uint16_t map_number(const Field& field, int64_t flat);
const TextureMap& map_of(const Field& field, int64_t flat);

// The flat number of a grid sample within the space restricted to `axes`.
int64_t field_sample_of(const ParameterSpace& space, AxisMask axes, int64_t grid_sample);

// The grid samples whose textures of a field show at `sample`: it itself, or those beside it where they have textures of their
// own. (Those of a field that does not depend on the axis see all its grid samples, and have no need of what lies between.)
std::vector<int64_t> shown_at(const StateTable& states, const Field& field, int64_t sample);

// Textures of one field that see the same states, to be solved side by side.
struct SolveGroup {
  struct Use {
    int state = 0;
    std::vector<std::vector<int64_t>> samples;  // per texture: samples in this state; their layers are averaged
  };
  int field = 0;
  uint16_t map = 0;               // of Field::maps
  std::vector<int64_t> textures;  // flat numbers in the field's space
  std::vector<Use> uses;          // ascending states
};
// At most `max_textures` to a group. `number`: of the field.
std::vector<SolveGroup> make_groups(const ParameterSpace& space, const Field& field, int number, const StateTable& states,
                                    size_t max_textures);

}  // namespace vitrine
