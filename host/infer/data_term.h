// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The data term of the least-squares problem as its gradient needs it, in two forms (Hakura 2001, section 3.5): by the
// matrices A of all states, which costs two products with each (equation 3.4), or by A'A, summed over them beforehand
// (equation 3.5).
#pragma once

#include <cstdint>
#include <vector>

#include "host/infer/filtered_matrix.h"
#include "host/infer/lanes.h"

namespace vitrine {

// One object in one state: which pixels count, and how much.
struct Observation {
  const FilteredMatrix* matrix = nullptr;
  std::vector<float> weight;  // W per pixel of the window, 0 where there is no row
  std::vector<float> scale;   // share (W / c)^2
  int64_t rows = 0;
  float share = 1;  // what a row counts beside one of another observation: a factor in `scale`
};

class DataTerm {
 public:
  virtual ~DataTerm() = default;
  // sum += (sum over states of A' F' scale F A) texels, both over all levels. Does not depend on the number of threads.
  virtual void add_product(const Lanes<1>* texels, Lanes<1>* sum) const = 0;
  virtual void add_product(const Lanes<2>* texels, Lanes<2>* sum) const = 0;
  virtual void add_product(const Lanes<3>* texels, Lanes<3>* sum) const = 0;
};

// The first form. Keeps references.
class ObservedTerm final : public DataTerm {
 public:
  explicit ObservedTerm(size_t texels_of_all_levels) : size_(texels_of_all_levels) {}
  void add(const Observation& observation) { observations_.push_back(&observation); }

  void add_product(const Lanes<1>* texels, Lanes<1>* sum) const override { add_product_of(texels, sum); }
  void add_product(const Lanes<2>* texels, Lanes<2>* sum) const override { add_product_of(texels, sum); }
  void add_product(const Lanes<3>* texels, Lanes<3>* sum) const override { add_product_of(texels, sum); }

 private:
  template <typename T>
  void add_product_of(const T* texels, T* sum) const;

  size_t size_;
  std::vector<const Observation*> observations_;
};

// Whether A'A is the cheaper form: 2 rows >= K texels, K being how much denser A'A is than A. Filtered rows of supersamples are
// not as sparse as the chapter's eight texels a pixel (there K = 4): where textures are about as fine as the picture, A'A takes
// 300 bytes a texel of the pyramid and a row of A 200, so that both take the same at 2 rows = 3 texels; time is about even with
// eight textures solved from the same sums. As matrices that are kept must fit beside A'A when they are summed up, K is 2.
inline constexpr double kRelativeSparsity = 2;
inline bool prefers_normal_matrix(int64_t rows, size_t texels) {
  return 2 * static_cast<double>(rows) >= kRelativeSparsity * static_cast<double>(texels);
}

}  // namespace vitrine
