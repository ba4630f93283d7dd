#include "pipeline/system/heap.hpp"

#include <malloc.h>

#include <algorithm>
#include <cerrno>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define HEAP_IS_NOT_OURS
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || __has_feature(memory_sanitizer)
#define HEAP_IS_NOT_OURS
#endif
#endif

namespace pipeline {
namespace {

thread_local HeapCount* counting = nullptr;

}  // namespace

CountingHeap::CountingHeap(HeapCount& count) : outer_(counting) { counting = &count; }

CountingHeap::~CountingHeap() { counting = outer_; }

std::size_t heap_bytes(const void* block) { return malloc_usable_size(const_cast<void*>(block)); }

}  // namespace pipeline

#ifdef HEAP_IS_NOT_OURS

bool pipeline::counts_heap() { return false; }

#else

bool pipeline::counts_heap() { return true; }

// glibc's own functions by their other names: what stands before malloc may call nothing that calls malloc.
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* block, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
void __libc_free(void* block);
}

namespace {

using pipeline::counting;

void* taken(void* block) {
  if (counting && block) {
    counting->held += std::int64_t(malloc_usable_size(block));
    counting->greatest = std::max(counting->greatest, counting->held);
  }
  return block;
}

bool is_power_of_two(std::size_t number) { return number != 0 && (number & (number - 1)) == 0; }

}  // namespace

extern "C" {

void* malloc(std::size_t size) noexcept { return taken(__libc_malloc(size)); }

void* calloc(std::size_t count, std::size_t size) noexcept { return taken(__libc_calloc(count, size)); }

void* realloc(void* block, std::size_t size) noexcept {
  if (!counting) return __libc_realloc(block, size);
  const auto before = std::int64_t(malloc_usable_size(block));
  void* const moved = __libc_realloc(block, size);
  if (moved || size == 0) counting->held -= before;  // else the block stays as it is
  return taken(moved);
}

void* memalign(std::size_t alignment, std::size_t size) noexcept { return taken(__libc_memalign(alignment, size)); }

void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
  return taken(__libc_memalign(alignment, size));
}

int posix_memalign(void** block, std::size_t alignment, std::size_t size) noexcept {
  if (!is_power_of_two(alignment) || alignment % sizeof(void*) != 0) return EINVAL;
  void* const found = taken(__libc_memalign(alignment, size));
  if (!found) return ENOMEM;
  *block = found;
  return 0;
}

void free(void* block) noexcept {
  if (counting && block) counting->held -= std::int64_t(malloc_usable_size(block));
  __libc_free(block);
}

}  // extern "C"

#endif
