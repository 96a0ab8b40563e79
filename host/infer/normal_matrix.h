// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The normal equations of one object over many states: N = sum over states of A' F' scale F A (Hakura 2001, equation 3.5),
// over the texels of all levels. States are added one by one and can be forgotten then: what it takes does not grow with views
// but with texels that meet in one pixel.
//
// N is kept in blocks of 2 x 2 by 2 x 2 texels of one level each, and of two blocks that mirror each other only the one above
// the diagonal. A pixel's filtered row touches about three by three blocks of a level.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "host/infer/data_term.h"
#include "host/infer/pyramid.h"

namespace vitrine {

class NormalMatrix final : public DataTerm {
 public:
  explicit NormalMatrix(const Pyramid& pyramid);
  ~NormalMatrix() override;

  // The order of calls matters for the last bits; the number of threads does not.
  void add(const Observation& observation);
  // When all are added: sorts, so that products walk through memory in order.
  void finish();
  size_t bytes() const;
  size_t block_count() const;  // above the diagonal and on it

  void add_product(const Lanes<1>* texels, Lanes<1>* sum) const override { add_product_of(texels, sum); }
  void add_product(const Lanes<2>* texels, Lanes<2>* sum) const override { add_product_of(texels, sum); }
  void add_product(const Lanes<3>* texels, Lanes<3>* sum) const override { add_product_of(texels, sum); }

 private:
  struct Entry;
  struct Rows;  // filtered rows of one observation
  class Band;   // some of the matrix' block rows
  struct Place {
    uint32_t texel[4];  // of a block, row by row; at the far edge of an odd level some appear twice, and never with a weight
  };
  Rows filtered_rows(const Observation& observation) const;
  void index_transposed();
  template <typename T>
  void add_product_of(const T* texels, T* sum) const;

  std::vector<uint32_t> block_of_texel_;  // 4 * block + place in it
  std::vector<Place> places_;
  std::vector<std::unique_ptr<Band>> bands_;
  uint32_t band_blocks_ = 0;
};

}  // namespace vitrine
