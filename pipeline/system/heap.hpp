// How much heap a piece of work takes, by the allocator's own count.
//
// heap.cpp stands before the C library's malloc and its kin, so that what any library takes is counted too, but only in
// the thread that asks for it and while it asks. A block counts as much as malloc gives for it (malloc_usable_size):
// that depends on the C library and, by 16 bytes a block, on what was free at the time. The figures are therefore good
// to about a percent, not to the byte.
#pragma once
#include <cstddef>
#include <cstdint>

namespace pipeline {

/// False in builds with a sanitizer, whose malloc is its own: then every count stays 0.
bool counts_heap();

/// Bytes taken and not given back, and the most that this ever was. Below 0: more was given back.
struct HeapCount {
  std::int64_t held = 0, greatest = 0;
};

/// Adds to a count what this thread takes and gives back while it lives; one within another counts alone.
class CountingHeap {
 public:
  explicit CountingHeap(HeapCount& count);
  ~CountingHeap();
  CountingHeap(const CountingHeap&) = delete;
  CountingHeap& operator=(const CountingHeap&) = delete;

 private:
  HeapCount* outer_;
};

/// What malloc gave for a block; 0 for a null pointer.
std::size_t heap_bytes(const void* block);

}  // namespace pipeline
