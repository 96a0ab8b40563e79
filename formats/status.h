// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// How formats, hal and target report that data or a device is bad: a code that tests can match and a static sentence.
// No exceptions, no allocation. The host turns a Status into vitrine::InputError (host/base/error.h).
#pragma once

#include <cstdint>
#include <utility>

namespace vitrine {

enum class StatusCode : uint8_t {
  kOk,
  kTruncated,           // fewer bytes than the data itself promises
  kBadMagic,            // not this kind of file at all
  kUnsupportedVersion,  // a Vitrine image, but of a version that this engine does not read
  kChecksumMismatch,    // damaged
  kMalformed,           // a field is outside its range or contradicts another
  kUnsupported,         // well formed, but needs what this build or device has not
  kOutOfMemory,         // the block handed over is too small
  kDevice,              // GPU, window or input device failed
  kIo,                  // the operating system refused
};

// `detail` is a string literal (or otherwise outlives the Status): one clause, no trailing dot, that says what is wrong.
class [[nodiscard]] Status {
 public:
  constexpr Status() = default;
  constexpr Status(StatusCode code, const char* detail) : code_(code), detail_(detail) {}
  constexpr bool ok() const { return code_ == StatusCode::kOk; }
  constexpr StatusCode code() const { return code_; }
  constexpr const char* detail() const { return detail_; }

 private:
  StatusCode code_ = StatusCode::kOk;
  const char* detail_ = "";
};

// A value, or the Status that says why there is none. `value()` of a failed Result is a bug (checked by the caller).
template <typename T>
class [[nodiscard]] Result {
 public:
  Result(T value) : value_(std::move(value)) {}
  Result(Status status) : status_(status) {}   
  bool ok() const { return status_.ok(); }
  const Status& status() const { return status_; }
  T& value() { return value_; }
  const T& value() const { return value_; }

 private:
  Status status_;
  T value_{};
};

}  // namespace vitrine
