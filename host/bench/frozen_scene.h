// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// A scene that stands still, or of whose grid a part is kept: what benchmarks of a single sample or of a single
// block take.
#pragma once

#include <optional>
#include <span>

#include "host/scene/scene.h"

namespace vitrine {

// The grid sample in the middle of all axes (the lower of two), and the position half a step on along every axis that moves the
// camera; nothing where no axis does.
Position middle_position(const Scene& scene);
int64_t middle_sample(const Scene& scene);  // flat
std::optional<Position> half_step_on(const Scene& scene, const Position& sample);

// The scene as it is at `position`, with one sample along every axis. Throws InputError where an axis deforms an object.
Scene frozen_at(const Scene& scene, const Position& position);

// The scene with samples[a] consecutive samples, or all there are, in the middle of every axis a: where those of the grid are,
// and straight on between them. A part of a periodic axis is linear. Throws InputError where an axis deforms an object.
Scene middle_part(const Scene& scene, std::span<const int> samples);

// As middle_part with `samples` along the first axis that moves nothing but the camera, and one along the others.
Scene middle_run(const Scene& scene, int samples);

}  // namespace vitrine
