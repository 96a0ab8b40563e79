// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/infer/data_term.h"

#include <tbb/parallel_for.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <array>

namespace vitrine {
namespace {

// States are summed in this many partial sums, whatever the number of threads.
constexpr size_t kPartialSums = 4;

template <typename T>
void add_product_with(const Observation& observation, const T* texels, std::vector<T>& pixels, T* sum) {
  pixels.resize(observation.matrix->pixel_count());
  observation.matrix->apply(texels, pixels.data());
  for (size_t p = 0; p < pixels.size(); ++p) pixels[p] = observation.scale[p] * pixels[p];
  observation.matrix->add_transposed(pixels.data(), sum);
}

}  // namespace

template <typename T>
void ObservedTerm::add_product_of(const T* texels, T* sum) const {
  const size_t parts = std::clamp<size_t>(observations_.size(), 1, kPartialSums);
  std::array<std::vector<T>, kPartialSums> others;
  // A context of its own: an interruption of the work around this would leave the sums undone without a word.
  tbb::task_group_context context(tbb::task_group_context::isolated);
  tbb::parallel_for(
      size_t{0}, parts,
      [&](size_t part) {
        if (part > 0) others[part].assign(size_, T{});
        std::vector<T> pixels;
        for (size_t s = part; s < observations_.size(); s += parts)
          add_product_with(*observations_[s], texels, pixels, part > 0 ? others[part].data() : sum);
      },
      context);
  for (size_t part = 1; part < parts; ++part)
    for (size_t i = 0; i < size_; ++i) sum[i] += others[part][i];
}

template void ObservedTerm::add_product_of<Lanes<1>>(const Lanes<1>*, Lanes<1>*) const;
template void ObservedTerm::add_product_of<Lanes<2>>(const Lanes<2>*, Lanes<2>*) const;
template void ObservedTerm::add_product_of<Lanes<3>>(const Lanes<3>*, Lanes<3>*) const;

}  // namespace vitrine
