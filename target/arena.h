// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The engine's memory: handed over once, cut into pieces at load, never returned piecemeal. Without a block the same code
// counts what it would take, so that the size asked for and the size used cannot differ.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>

namespace vitrine {

class Arena {
 public:
  static constexpr size_t kAlignment = 64;

  Arena() = default;  // counts only: take() returns spans without memory, which must not be touched
  explicit Arena(std::span<std::byte> block) : block_(block.data()), capacity_(block.size()) {}

  // `count` value-initialized objects, or in counting mode (and where the block is too small, see failed()) none.
  // No destructor will run. T: trivially destructible, alignment at most kAlignment.
  template <typename T>
  std::span<T> take(size_t count) {
    static_assert(alignof(T) <= kAlignment);
    std::byte* piece = take_bytes(count, sizeof(T));
    if (!piece) return {};
    T* first = reinterpret_cast<T*>(piece);
    std::uninitialized_value_construct_n(first, count);
    return {first, count};
  }
  // As take, but what the memory holds is left undefined: for large buffers that are written before they are read.
  template <typename T>
  std::span<T> take_uninitialized(size_t count) {
    std::byte* piece = take_bytes(count, sizeof(T));
    return piece ? std::span<T>{reinterpret_cast<T*>(piece), count} : std::span<T>{};
  }

  bool counting() const { return !block_; }
  bool failed() const { return failed_; }
  size_t used() const { return used_; }

 private:
  std::byte* take_bytes(size_t count, size_t size) {
    const size_t room = std::numeric_limits<size_t>::max() / 2 - used_;
    if (count > (room - kAlignment) / size) return failed_ = true, nullptr;
    const size_t begin = used_, bytes = (count * size + kAlignment - 1) / kAlignment * kAlignment;
    used_ += bytes;
    if (!block_) return nullptr;
    if (used_ > capacity_) return failed_ = true, nullptr;
    return block_ + begin;
  }

  std::byte* block_ = nullptr;
  size_t capacity_ = 0, used_ = 0;
  bool failed_ = false;
};

}  // namespace vitrine
