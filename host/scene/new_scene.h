// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// `vitrine new`: a working scene folder to start from.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

namespace vitrine {

// Makes the folder `directory` with scene.toml (every setting written out, with a comment), the model and studio.exr.
// `model`: a .glb, or a .gltf, which brings its buffers and pictures along; without one a small model is written. The
// orbit and the lamp are fitted to the model's size. Returns the files that were written. Throws InputError where the
// folder is there and not empty, or the model cannot be read; then nothing is written.
std::vector<std::filesystem::path> new_scene(const std::filesystem::path& directory,
                                             const std::optional<std::filesystem::path>& model);

}  // namespace vitrine
