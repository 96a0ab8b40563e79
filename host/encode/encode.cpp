// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/encode/encode.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "host/base/error.h"
#include "host/encode/field_set.h"
#include "host/encode/price_search.h"
#include "host/encode/shape_search.h"

namespace vitrine {
namespace {

constexpr int kFullPasses = 9;
constexpr double kAim = 0.996, kEnough = 0.99;  // of the target

double table_bits_of(const FieldJob& job) { return 64 * job.preview_share(); }

void choose_pyramids(std::vector<FieldJob>& jobs, PyramidKind kind, double price) {
  for (FieldJob& job : jobs) {
    job.set_pyramid(choose_pyramid(job.shape, job.preview_textures(), kind, price, table_bits_of(job)).pyramid);
  }
}

// Bytes at a price as the shape search estimates them, without coding anything.
double estimated_bytes(std::vector<FieldJob>& jobs, PyramidKind kind, double price) {
  double bytes = 0;
  for (FieldJob& job : jobs) {
    const ShapeChoice choice = choose_pyramid(job.shape, job.preview_textures(), kind, price, table_bits_of(job), 4'000'000);
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
      const double cost = jobs[f].source->samples_shown * pass.fields[f].squared_error + price * 8 * pass.fields[f].bytes;
      if (cost < best[f]) best[f] = cost, exponent[f] = candidate;
    }
  }
  for (size_t f = 0; f < jobs.size(); ++f) jobs[f].setting.step_exponent = exponent[f];
}

// Pyramids, exponents and contexts from previews; returns a price that should meet the target.
double prepare(std::vector<FieldJob>& jobs, PyramidKind kind, double price, double target, Progress& progress) {
  PriceSearch search(target);
  choose_pyramids(jobs, kind, price);
  for (int round = 0; round < 3; ++round) {
    const Pass pass = encode_pass(jobs, price, true, progress);
    train_contexts(jobs, pass);
    if (target > 0) price = search.next(price, pass.bytes);
    if (round == 0) choose_pyramids(jobs, kind, price);
    if (round == 1) choose_exponents(jobs, price, progress);
  }
  return price;
}

EncodedField assemble(const FieldJob& job, const FieldPass& pass, double price) {
  EncodedField out;
  out.shape = job.shape;
  const FieldCoder coder(job.shape, job.textures, job.setting, price);
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
  return out;
}

std::vector<EncodedField> assemble_all(const std::vector<FieldJob>& jobs, const Pass& pass, double price) {
  std::vector<EncodedField> out;
  for (size_t f = 0; f < jobs.size(); ++f) out.push_back(assemble(jobs[f], pass.fields[f], price));
  return out;
}

// Whether no lower price would make any steps finer.
bool finest(const std::vector<FieldJob>& jobs, double price) {
  return std::all_of(jobs.begin(), jobs.end(),
                     [&](const FieldJob& job) { return FieldCoder(job.shape, job.textures, job.setting, price).finest(); });
}

int64_t block_count(const std::vector<FieldJob>& jobs) {
  int64_t count = 0;
  for (const FieldJob& job : jobs) count += job.shape.block_count();
  return count;
}

std::vector<EncodedField> encode_to_target(std::vector<FieldJob>& jobs, PyramidKind kind, double target, double floor,
                                           Progress& progress) {
  PartOfStep part(progress);
  double price = std::max(floor, prepare(jobs, kind, std::max(floor, estimated_price(jobs, kind, target)), kAim * target, part));
  double tables = 0;
  for (const FieldJob& job : jobs) tables += table_bytes(job);
  PriceSearch search(kAim * target);
  std::optional<std::vector<EncodedField>> best;
  double best_bytes = -1;
  for (int i = 0; i < kFullPasses || (!best && i < 4 * kFullPasses); ++i) {
    progress.begin("coding textures", block_count(jobs), 0, "blocks");
    const Pass pass = encode_pass(jobs, price, false, progress);
    progress.end();
    if (pass.bytes <= target && pass.bytes > best_bytes) best = assemble_all(jobs, pass, price), best_bytes = pass.bytes;
    if (best_bytes >= kEnough * target || (best && (price <= floor || finest(jobs, price)))) break;
    if (i == 0)
      train_contexts(jobs, pass);
    else if (pass.bytes <= tables && pass.bytes > target)
      break;
    price = std::max(floor, search.next(price, pass.bytes));
  }
  if (!best) {
    throw InputError("storage",
                     "it leaves " + std::to_string(static_cast<int64_t>(target)) +
                         " bytes for textures, but their tables of nodes alone take " +
                         std::to_string(static_cast<int64_t>(tables)),
                     "ask for more storage, or for fewer samples");
  }
  return std::move(*best);
}

}  // namespace

std::vector<EncodedField> encode_fields(const std::vector<FieldSource>& fields, const EncodeOptions& options,
                                        Progress& progress) {
  if (fields.empty()) return {};
  std::vector<FieldJob> jobs = load_fields(fields, progress);
  const auto price_of = [](double quantizer) { return kPricePerStep2 * quantizer * quantizer; };
  if (options.quantizer <= 0) {
    return encode_to_target(jobs, options.pyramid, static_cast<double>(options.target_bytes), price_of(options.finest_quantizer),
                            progress);
  }
  const double price = price_of(options.quantizer);
  PartOfStep part(progress);
  prepare(jobs, options.pyramid, price, 0, part);
  progress.begin("coding textures", block_count(jobs), 0, "blocks");
  const Pass pass = encode_pass(jobs, price, false, progress);
  progress.end();
  return assemble_all(jobs, pass, price);
}

}  // namespace vitrine
