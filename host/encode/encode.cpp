// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/encode/encode.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "host/base/error.h"
#include "host/encode/field_set.h"
#include "host/encode/object_balance.h"
#include "host/encode/price_search.h"
#include "host/encode/shape_search.h"

namespace vitrine {
namespace {

constexpr int kFullPasses = 9;
constexpr double kAim = 0.996, kEnough = 0.99;  // of the target

double table_bits_of(const FieldJob& job) { return 8 * kNodeTableBytes * job.preview_share(); }

void choose_pyramids(std::vector<FieldJob>& jobs, PyramidKind kind, double price) {
  for (FieldJob& job : jobs) {
    job.set_pyramid(choose_pyramid(job.shape, job.preview_textures(), kind, job.own(price), table_bits_of(job)).pyramid);
  }
}

// Bytes at a price as the shape search estimates them, without coding anything.
double estimated_bytes(std::vector<FieldJob>& jobs, PyramidKind kind, double price) {
  double bytes = 0;
  for (FieldJob& job : jobs) {
    const ShapeChoice choice =
        choose_pyramid(job.shape, job.preview_textures(), kind, job.own(price), table_bits_of(job), 4'000'000);
    job.set_pyramid(choice.pyramid);
    bytes += choice.bits / 8 / job.preview_share() + table_bytes(job);
  }
  return bytes;
}

double estimated_price(std::vector<FieldJob>& jobs, PyramidKind kind, double target) {
  double low = std::log(1e-2), high = std::log(1e9);
  for (int i = 0; i < 10; ++i) {
    const double middle = (low + high) / 2;
    (estimated_bytes(jobs, kind, std::exp(middle)) > target ? low : high) = middle;
  }
  return std::exp(high);
}

// Keeps, per field, the exponent of its steps that gives the least error at the price of its bits.
void choose_exponents(std::vector<FieldJob>& jobs, double price, Progress& progress) {
  std::vector<double> best(jobs.size(), INFINITY), exponent(jobs.size(), 1);
  for (const double candidate : {1.0, 0.8, 0.6}) {
    for (FieldJob& job : jobs) job.setting.step_exponent = candidate;
    const Pass pass = encode_pass(jobs, price, true, progress);
    for (size_t f = 0; f < jobs.size(); ++f) {
      const double cost =
          jobs[f].source->samples_shown * pass.fields[f].squared_error + jobs[f].own(price) * 8 * pass.fields[f].bytes;
      if (cost < best[f]) best[f] = cost, exponent[f] = candidate;
    }
  }
  for (size_t f = 0; f < jobs.size(); ++f) jobs[f].setting.step_exponent = exponent[f];
}

EncodedField assemble(const FieldJob& job, const FieldPass& pass, double price) {
  EncodedField out;
  out.shape = job.shape;
  out.coder = job.setting.coder;
  const FieldCoder coder(job.shape, job.textures, job.setting, job.own(price));
  for (int level = 0; level < job.shape.pyramid.level_count; ++level) {
    out.level_steps.insert(out.level_steps.end(), coder.steps(level).begin(), coder.steps(level).end());
    const auto& contexts = job.setting.contexts[static_cast<size_t>(level)];
    out.contexts.insert(out.contexts.end(), contexts.begin(), contexts.end());
  }
  for (const CodedBlock& block : pass.blocks) {
    for (size_t n = 0; n < block.nodes.size(); ++n) {
      out.nodes.insert(out.nodes.end(), block.nodes[n].begin(), block.nodes[n].end());
      out.node_bytes.push_back(static_cast<uint32_t>(block.nodes[n].size()));
      out.node_units.push_back(block.units[n]);
    }
  }
  out.squared_error = pass.squared_error;
  out.table_bytes = static_cast<uint64_t>(std::llround(table_bytes(job)));
  return out;
}

std::vector<EncodedField> assemble_all(const std::vector<FieldJob>& jobs, const Pass& pass, double price) {
  std::vector<EncodedField> out;
  for (size_t f = 0; f < jobs.size(); ++f) out.push_back(assemble(jobs[f], pass.fields[f], price));
  return out;
}

// Whether no lower price would make any steps finer.
bool finest(const std::vector<FieldJob>& jobs, double price) {
  return std::all_of(jobs.begin(), jobs.end(), [&](const FieldJob& job) {
    return FieldCoder(job.shape, job.textures, job.setting, job.own(price)).finest();
  });
}

int64_t block_count(const std::vector<FieldJob>& jobs) {
  int64_t count = 0;
  for (const FieldJob& job : jobs) count += job.shape.block_count();
  return count;
}

// Finds how to code all fields for a price or a target.
class Encoding {
 public:
  Encoding(std::vector<FieldJob>& jobs, const EncodeOptions& options, Progress& progress)
      : jobs_(jobs), options_(options), balance_(jobs, options.worst_object), progress_(progress) {}

  std::vector<EncodedField> at_price(double price) {
    PartOfStep part(progress_);
    prepare(price, 0, part);
    return assemble_all(jobs_, full_pass(price), price);
  }

  std::vector<EncodedField> to_target(double target, double floor) {
    PartOfStep part(progress_);
    double price = std::max(floor, estimated_price(jobs_, options_.pyramid, target));
    price = std::max(floor, prepare(price, kAim * target, part));
    PriceSearch search(kAim * target);
    for (int i = 0; i < kFullPasses || (!best_ && i < 4 * kFullPasses); ++i) {
      const Pass pass = full_pass(price);
      const bool holds = balance_.holds(jobs_, pass);
      if (pass.bytes <= target) keep(pass, price, holds);
      if (best_ && best_holds_ && (best_bytes_ >= kEnough * target || price <= floor || finest(jobs_, price))) break;
      if (pass.bytes > target && pass.bytes <= tables()) break;
      if (i == 0) train_contexts(jobs_, pass);
      if (holds) {
        price = std::max(floor, search.next(price, pass.bytes));
        continue;
      }
      // Other weights, another search: what was met so far says nothing about slopes.
      balance_.correct(jobs_, pass);
      price = std::max(floor, PriceSearch(kAim * target).next(price, pass.bytes));
      search = PriceSearch(kAim * target);
    }
    if (!best_) refuse(target);
    return std::move(*best_);
  }

 private:
  // Pyramids, exponents, contexts and weights from previews; returns a price that should meet the target.
  double prepare(double price, double target, Progress& progress) {
    choose_pyramids(jobs_, options_.pyramid, price);
    const int rounds = options_.worst_object > 0 ? 7 : 3;
    for (int round = 0; round < rounds; ++round) {
      const Pass pass = encode_pass(jobs_, price, true, progress);
      train_contexts(jobs_, pass);
      balance_.correct(jobs_, pass);
      // The weights move what there is to search for: each round begins anew.
      if (target > 0) price = PriceSearch(target).next(price, pass.bytes);
      if (round == 0) choose_pyramids(jobs_, options_.pyramid, price);
      if (round == 1) choose_exponents(jobs_, price, progress);
    }
    return price;
  }

  Pass full_pass(double price) {
    progress_.begin("coding textures", block_count(jobs_), 0, "blocks");
    Pass pass = encode_pass(jobs_, price, false, progress_);
    progress_.end();
    return pass;
  }

  // Prefers what keeps the constraint, then what uses more of the storage.
  void keep(const Pass& pass, double price, bool holds) {
    if (best_ && (best_holds_ > holds || (best_holds_ == holds && best_bytes_ >= pass.bytes))) return;
    best_ = assemble_all(jobs_, pass, price);
    best_bytes_ = pass.bytes;
    best_holds_ = holds;
  }

  double tables() const {
    double bytes = 0;
    for (const FieldJob& job : jobs_) bytes += table_bytes(job);
    return bytes;
  }

  [[noreturn]] void refuse(double target) const {
    throw InputError("storage",
                     "it leaves " + std::to_string(static_cast<int64_t>(target)) +
                         " bytes for textures, but their tables of nodes alone take " +
                         std::to_string(static_cast<int64_t>(tables())),
                     "ask for more storage, or for fewer samples");
  }

  std::vector<FieldJob>& jobs_;
  const EncodeOptions& options_;
  ObjectBalance balance_;
  Progress& progress_;
  std::optional<std::vector<EncodedField>> best_;
  double best_bytes_ = 0;
  bool best_holds_ = false;
};

}  // namespace

std::vector<EncodedField> encode_fields(const std::vector<FieldSource>& fields, const EncodeOptions& options,
                                        Progress& progress) {
  if (fields.empty()) return {};
  std::vector<FieldJob> jobs = load_fields(fields, progress);
  for (FieldJob& job : jobs) job.setting.coder = options.coder;
  Encoding encoding(jobs, options, progress);
  const auto price_of = [](double quantizer) { return kPricePerStep2 * quantizer * quantizer; };
  if (options.quantizer > 0) return encoding.at_price(price_of(options.quantizer));
  return encoding.to_target(static_cast<double>(options.target_bytes), price_of(options.finest_quantizer));
}

}  // namespace vitrine
