// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The implementation of stb_rect_pack.h, once.
#define STB_RECT_PACK_IMPLEMENTATION
#include <stb/stb_rect_pack.h>
