// The other end of the conversation, for methods that are C++: what a child of ours does until its stdin ends.
#pragma once
#include <cstddef>
#include <functional>

#include "pipeline/foreign/foreign_method.hpp"
#include "pipeline/system/heap.hpp"

namespace pipeline {

/// Answers frames from `in` on `out` with the method that `make` makes at the hello, until `in` ends. What the method
/// throws is sent as FAIL. `heap` counts what it takes; the lists of hits that are sent are not the method's.
void serve(const std::function<Hosted()>& make, std::size_t bodies, int in, int out, HeapCount& heap);

}  // namespace pipeline
