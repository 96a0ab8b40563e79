// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// malloc of this program: glibc's, counted. operator new comes down to it.
#include "tests/target/allocations.h"

#include <atomic>
#include <cstddef>

namespace vitrine::test {
namespace {
std::atomic<int64_t> count{0};
}
int64_t allocations() { return count; }
}  // namespace vitrine::test

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
extern "C" {
void* __libc_malloc(size_t);
void* __libc_calloc(size_t, size_t);
void* __libc_realloc(void*, size_t);
void* __libc_memalign(size_t, size_t);
void* malloc(size_t bytes) { return ++vitrine::test::count, __libc_malloc(bytes); }
void* calloc(size_t n, size_t bytes) { return ++vitrine::test::count, __libc_calloc(n, bytes); }
void* realloc(void* memory, size_t bytes) { return ++vitrine::test::count, __libc_realloc(memory, bytes); }
void* memalign(size_t alignment, size_t bytes) { return ++vitrine::test::count, __libc_memalign(alignment, bytes); }
void* aligned_alloc(size_t alignment, size_t bytes) { return ++vitrine::test::count, __libc_memalign(alignment, bytes); }
}
#endif
