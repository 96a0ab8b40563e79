// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/encode/context_training.h"

#include <algorithm>
#include <cmath>

#include "formats/node_coding.h"
#include "host/encode/bit_costs.h"

namespace vitrine {
namespace {

constexpr size_t kMaxSymbols = 40000;  // per context: more would say nothing new
constexpr double kChangeBits = 16;

// One context's symbols, node after node; `ends` are the places where a node ends and its state is lost.
struct ContextHistory {
  std::vector<uint8_t> bits;
  std::vector<size_t> ends;
};

double cost_of(const ContextHistory& history, uint8_t initial) {
  double total = 0;
  size_t at = 0;
  for (const size_t end : history.ends) {
    AdaptiveBit state = adaptive_bit_from_byte(initial);
    float bits = 0;
    for (; at < end; ++at) {
      const bool bit = history.bits[at];
      const uint32_t one = state.probability_of_one();
      bits += bits_of_probability(bit ? one : 32768 - one);
      state.update(bit);
    }
    total += static_cast<double>(bits);
  }
  return total;
}

// The index whose probability is nearest to that of the history.
int nearest_index(const ContextHistory& history) {
  const double ones = static_cast<double>(std::count(history.bits.begin(), history.bits.end(), 1)) + 0.4;
  const double logit = std::log(ones / (static_cast<double>(history.bits.size()) + 0.8 - ones));
  return std::clamp(static_cast<int>(std::lround(logit / 0.24 + 31.5)), 0, kInitialProbabilities - 1);
}

// Walks downhill in the probability for one speed.
void descend(const ContextHistory& history, int speed, int index, double& best_cost, uint8_t& best) {
  const auto byte = [&](int i) { return static_cast<uint8_t>(i << 2 | speed); };
  double cost = cost_of(history, byte(index));
  for (const int direction : {-2, 2, -1, 1}) {
    for (;;) {
      const int next = index + direction;
      if (next < 0 || next >= kInitialProbabilities) break;
      const double next_cost = cost_of(history, byte(next));
      if (next_cost >= cost) break;
      cost = next_cost;
      index = next;
    }
  }
  if (cost < best_cost) best_cost = cost, best = byte(index);
}

uint8_t train(const ContextHistory& history, uint8_t before, double change_bits) {
  if (history.bits.empty()) return before;
  double best_cost = cost_of(history, before) - change_bits;
  uint8_t best = before;
  const int start = nearest_index(history);
  for (int speed = 0; speed < kAdaptationSpeeds; ++speed) descend(history, speed, start, best_cost, best);
  return best;
}

}  // namespace

std::vector<uint8_t> train_contexts(const std::vector<const CodedSymbols*>& nodes, std::span<const uint8_t> before,
                                    double share) {
  std::vector<ContextHistory> histories(before.size());
  for (const CodedSymbols* node : nodes) {
    for (const uint16_t symbol : *node) {
      ContextHistory& history = histories[symbol >> 1];
      if (history.bits.size() < kMaxSymbols) history.bits.push_back(symbol & 1);
    }
    for (ContextHistory& history : histories) {
      if (history.bits.size() > (history.ends.empty() ? 0 : history.ends.back())) history.ends.push_back(history.bits.size());
    }
  }
  std::vector<uint8_t> trained(before.begin(), before.end());
  for (size_t c = 0; c < trained.size(); ++c) trained[c] = train(histories[c], trained[c], kChangeBits * share);
  return trained;
}

}  // namespace vitrine
