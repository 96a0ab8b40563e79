// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/infer/pyramid.h"

#include <algorithm>
#include <cmath>

#include "host/infer/lanes.h"

namespace vitrine {

Pyramid::Pyramid(int width, int height) {
  const int count = mip_level_count(width, height);
  for (int level = 0; level < count; ++level) {
    levels_.push_back({width, height, size_});
    size_ += static_cast<size_t>(width) * static_cast<size_t>(height);
    if (level + 1 < count) {
      columns_.push_back(make_dimension(width));
      rows_.push_back(make_dimension(height));
    }
    width = mip_size(width);
    height = mip_size(height);
  }
}

Pyramid::Dimension Pyramid::make_dimension(int size) {
  Dimension dimension;
  const int coarse = mip_size(size);
  for (int x = 0; x < coarse; ++x) dimension.decimation.push_back(mip_taps(size, x));
  for (int x = 0; x < size; ++x) {
    const double at = (x + 0.5) / size * coarse - 0.5;
    const int first = static_cast<int>(std::floor(at));
    dimension.interpolation.push_back(
        {std::clamp(first, 0, coarse - 1), std::clamp(first + 1, 0, coarse - 1), static_cast<float>(at - first)});
  }
  return dimension;
}

template <typename T>
void Pyramid::decimate(T* all) const {
  for (size_t l = 0; l + 1 < levels_.size(); ++l) {
    const Level &fine = levels_[l], &coarse = levels_[l + 1];
    for (int y = 0; y < coarse.height; ++y) {
      const MipTaps& ty = rows_[l].decimation[static_cast<size_t>(y)];
      T* out = all + coarse.offset + static_cast<size_t>(y) * static_cast<size_t>(coarse.width);
      for (int x = 0; x < coarse.width; ++x) {
        const MipTaps& tx = columns_[l].decimation[static_cast<size_t>(x)];
        T sum{};
        for (int j = 0; j < ty.count; ++j) {
          const T* row = all + fine.offset + static_cast<size_t>(ty.first + j) * static_cast<size_t>(fine.width) + tx.first;
          T part = tx.weight[0] * row[0];
          for (int i = 1; i < tx.count; ++i) part += tx.weight[static_cast<size_t>(i)] * row[i];
          sum += ty.weight[static_cast<size_t>(j)] * part;
        }
        out[x] = sum;
      }
    }
  }
}

template <typename T>
void Pyramid::decimate_transposed(T* all) const {
  for (size_t l = levels_.size() - 1; l-- > 0;) {
    const Level &fine = levels_[l], &coarse = levels_[l + 1];
    for (int y = 0; y < coarse.height; ++y) {
      const MipTaps& ty = rows_[l].decimation[static_cast<size_t>(y)];
      const T* in = all + coarse.offset + static_cast<size_t>(y) * static_cast<size_t>(coarse.width);
      for (int x = 0; x < coarse.width; ++x) {
        const MipTaps& tx = columns_[l].decimation[static_cast<size_t>(x)];
        for (int j = 0; j < ty.count; ++j) {
          T* row = all + fine.offset + static_cast<size_t>(ty.first + j) * static_cast<size_t>(fine.width) + tx.first;
          const T part = ty.weight[static_cast<size_t>(j)] * in[x];
          for (int i = 0; i < tx.count; ++i) row[i] += tx.weight[static_cast<size_t>(i)] * part;
        }
      }
    }
  }
}

template <typename T>
T Pyramid::interpolate(const T* all, size_t level, int x, int y) const {
  const Level& coarse = levels_[level + 1];
  const Mix &mx = columns_[level].interpolation[static_cast<size_t>(x)], &my = rows_[level].interpolation[static_cast<size_t>(y)];
  const T* top = all + coarse.offset + static_cast<size_t>(my.first) * static_cast<size_t>(coarse.width);
  const T* bottom = all + coarse.offset + static_cast<size_t>(my.second) * static_cast<size_t>(coarse.width);
  return (1 - my.weight) * ((1 - mx.weight) * top[mx.first] + mx.weight * top[mx.second]) +
         my.weight * ((1 - mx.weight) * bottom[mx.first] + mx.weight * bottom[mx.second]);
}

template <typename T>
void Pyramid::add_gamma_gradient(const T* all, float strength, T* out) const {
  for (size_t l = 0; l + 1 < levels_.size(); ++l) {
    const Level &fine = levels_[l], &coarse = levels_[l + 1];
    for (int y = 0; y < fine.height; ++y) {
      const Mix& my = rows_[l].interpolation[static_cast<size_t>(y)];
      const size_t row = fine.offset + static_cast<size_t>(y) * static_cast<size_t>(fine.width);
      T* top = out + coarse.offset + static_cast<size_t>(my.first) * static_cast<size_t>(coarse.width);
      T* bottom = out + coarse.offset + static_cast<size_t>(my.second) * static_cast<size_t>(coarse.width);
      for (int x = 0; x < fine.width; ++x) {
        const Mix& mx = columns_[l].interpolation[static_cast<size_t>(x)];
        const T difference = strength * (all[row + static_cast<size_t>(x)] - interpolate(all, l, x, y));
        out[row + static_cast<size_t>(x)] += difference;
        const T upper = (1 - my.weight) * difference, lower = my.weight * difference;
        top[mx.first] -= (1 - mx.weight) * upper;
        top[mx.second] -= mx.weight * upper;
        bottom[mx.first] -= (1 - mx.weight) * lower;
        bottom[mx.second] -= mx.weight * lower;
      }
    }
  }
}

#define VITRINE_INSTANTIATE(T)                                             \
  template void Pyramid::decimate<T>(T*) const;                            \
  template void Pyramid::decimate_transposed<T>(T*) const;                 \
  template void Pyramid::add_gamma_gradient<T>(const T*, float, T*) const; \
  template T Pyramid::interpolate<T>(const T*, size_t, int, int) const;
VITRINE_INSTANTIATE(float)
VITRINE_INSTANTIATE(Lanes<1>)
VITRINE_INSTANTIATE(Lanes<2>)
VITRINE_INSTANTIATE(Lanes<3>)
#undef VITRINE_INSTANTIATE

}  // namespace vitrine
