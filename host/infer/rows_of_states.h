// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The data term of textures that see one state or many, in the form that suits their number (host/infer/data_term.h).
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "host/infer/normal_matrix.h"
#include "host/infer/pyramid.h"

namespace vitrine {

class RowsOfStates {
 public:
  explicit RowsOfStates(const Pyramid& pyramid) : pyramid_(pyramid), observed_(pyramid.size()) {}

  // Kept by itself while rows are few, then summed up (data_term.h).
  void add(std::shared_ptr<const Observation> observation) {
    rows_ += observation->rows;
    kept_.push_back(std::move(observation));
    if (!normal_ && !prefers_normal_matrix(rows_, pyramid_.size())) return;
    if (!normal_) normal_ = std::make_unique<NormalMatrix>(pyramid_);
    for (auto& kept : kept_) {
      normal_->add(*kept);
      kept.reset();
    }
    kept_.clear();
  }
  const DataTerm& finish() {
    for (const auto& kept : kept_) observed_.add(*kept);
    if (!normal_) return observed_;
    normal_->finish();
    return *normal_;
  }

 private:
  const Pyramid& pyramid_;
  int64_t rows_ = 0;
  std::vector<std::shared_ptr<const Observation>> kept_;
  ObservedTerm observed_;
  std::unique_ptr<NormalMatrix> normal_;
};

}  // namespace vitrine
