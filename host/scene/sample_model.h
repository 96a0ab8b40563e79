// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// A model for those who have none yet: a ball and a cube on a plinth, as a .glb.
#pragma once

#include <string>

namespace vitrine {

// The bytes of the file; the same on every call.
std::string sample_model_glb();

}  // namespace vitrine
