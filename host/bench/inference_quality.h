// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Three ways to make textures that reproduce a traced picture (Hakura 2001, section 3.6), drawn through each filter of the target
// and compared with ground truth: at the view whose picture they were made from, between views, and at other resolutions.
//
// What is compared are objects' own pictures (host/bench/object_pictures.h).
#pragma once

#include <string>
#include <vector>

#include "host/base/progress.h"
#include "host/bench/matrix_costs.h"
#include "host/frames/store.h"
#include "host/scene/scene.h"
#include "host/verify/verify.h"
#include "target/draw/surface_filter.h"

namespace vitrine {

// "least_squares": infer_textures() through the filter. "forward": map_forward(). "traced": TextureTracer.
enum class TextureMethod : uint8_t { kLeastSquares, kForward, kTraced };
inline constexpr TextureMethod kTextureMethods[] = {TextureMethod::kLeastSquares, TextureMethod::kForward,
                                                    TextureMethod::kTraced};
const char* method_name(TextureMethod method);
const char* filter_name(SurfaceFilter filter);  // "bilinear", "trilinear", "aniso2", "aniso4"

struct InferenceQualityOptions {
  int samples_per_pixel = 256;  // of pictures, evenly; rays of a texel where textures are traced
  std::string object;           // the only one to measure; empty: all that are drawn
  bool matrices = true;         // also measure every way to read rendering matrices
  std::vector<SurfaceFilter> filters = {SurfaceFilter::kBilinear, SurfaceFilter::kTrilinear, SurfaceFilter::kAnisotropic2,
                                        SurfaceFilter::kAnisotropic4};
};

// Textures of one object, made at the sample, drawn somewhere.
struct QualityRow {
  TextureMethod method;
  SurfaceFilter filter;
  // "at" the sample, "other_seed" there, "between" two, "scale_0.75", "scale_1.5": the sample with other picture sizes.
  std::string where;
  std::string object;
  double psnr_db = 0;  // 8-bit sRGB
};

// An object at the sample, cut out of the picture; grey where it does not count.
struct ObjectPictures {
  std::string object;
  double noise_db = 0;  // PSNR between two traced pictures of it with different seeds
  Picture truth;
  struct Drawn {
    TextureMethod method;
    SurfaceFilter filter;
    Picture picture;
  };
  std::vector<Drawn> drawn;  // filter by filter
};

// An inferred texture, rows v = 1 first.
struct TexturePictures {
  std::string object, layer;
  Picture determined;  // pink where no pixel says anything of a texel
  Picture whole;       // as regularization fills it
};

struct InferenceQuality {
  std::vector<QualityRow> rows;  // filter by filter, in each method by method, in each place by place
  std::vector<ObjectPictures> objects;
  std::vector<TexturePictures> textures;  // through the trilinear filter, where it is measured
  struct Matrix {
    SurfaceFilter filter;
    std::vector<MatrixCost> costs;  // a method each
  };
  std::vector<Matrix> matrices;
};

// At the scene's middle sample, in pictures of the scene's size. Frames and textures go to `store`. Throws InputError where the
// object is not there or not seen, or an axis deforms one.
InferenceQuality measure_inference(const Scene& scene, const InferenceQualityOptions& options, const Store& store,
                                   Progress& progress);

}  // namespace vitrine
