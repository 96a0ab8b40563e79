// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <xxhash.h>

#include <bit>
#include <cmath>
#include <new>

#include "host/frames/store.h"

static_assert(std::endian::native == std::endian::little, "keys are hashes of little-endian bytes");

namespace vitrine {
namespace {

// Every append says what it is, so that no two sequences of appends hash alike.
enum class Tag : uint8_t { kBytes = 1, kText, kNumber, kInteger };

}  // namespace

std::string StoreKey::hex() const { return fmt::format("{:016x}{:016x}", high, low); }

struct KeyBuilder::Impl {
  XXH3_state_t* state = XXH3_createState();
  Impl() {
    if (!state) throw std::bad_alloc();
  }
  ~Impl() { XXH3_freeState(state); }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
  void append(Tag tag, const void* data, size_t size) {
    const uint64_t length = size;
    XXH3_128bits_update(state, &tag, sizeof tag);
    XXH3_128bits_update(state, &length, sizeof length);
    if (size) XXH3_128bits_update(state, data, size);
  }
};

KeyBuilder::KeyBuilder() : impl_(std::make_unique<Impl>()) { XXH3_128bits_reset(impl_->state); }
KeyBuilder::~KeyBuilder() = default;
KeyBuilder::KeyBuilder(const KeyBuilder& other) : impl_(std::make_unique<Impl>()) {
  XXH3_copyState(impl_->state, other.impl_->state);
}

void KeyBuilder::bytes(const void* data, size_t size) { impl_->append(Tag::kBytes, data, size); }
void KeyBuilder::text(const std::string& text) { impl_->append(Tag::kText, text.data(), text.size()); }
void KeyBuilder::integer(int64_t value) { impl_->append(Tag::kInteger, &value, sizeof value); }
void KeyBuilder::number(double value) {
  // One pattern for both zeros and for all NaNs.
  const double canonical = value == 0 ? 0.0 : std::isnan(value) ? std::nan("") : value;
  impl_->append(Tag::kNumber, &canonical, sizeof canonical);
}

StoreKey KeyBuilder::finish() const {
  const XXH128_hash_t hash = XXH3_128bits_digest(impl_->state);
  return {hash.high64, hash.low64};
}

}  // namespace vitrine
