// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The constraint that no object looks much worse than the rest: its mean squared error may be at most `worst` times that of
// all objects together (Hakura 2001, section 4.5, where it is alpha and whole curves are cut off). Here the errors of objects
// that exceed it count for more, until they do not: what minimizes the weighted sum with such weights minimizes the plain sum
// under the constraint.
#pragma once

#include <vector>

#include "host/encode/field_set.h"

namespace vitrine {

// Mean squared error per pixel that shows the object, of codes, by FieldSource::object; its layers' errors add up.
std::vector<double> object_errors(const std::vector<FieldJob>& jobs, const Pass& pass);

class ObjectBalance {
 public:
  // `worst`: at least 1; 0: no constraint.
  ObjectBalance(const std::vector<FieldJob>& jobs, double worst);
  // Whether all objects of a pass keep the constraint, or cannot do better.
  bool holds(const std::vector<FieldJob>& jobs, const Pass& pass) const;
  // Corrects the weights of `jobs` after a pass.
  void correct(std::vector<FieldJob>& jobs, const Pass& pass);

 private:
  double bound(const std::vector<double>& errors) const;

  double worst_;
  std::vector<double> pixels_;   // by object
  std::vector<double> factors_;  // by object: what the constraint makes of its weight
};

}  // namespace vitrine
