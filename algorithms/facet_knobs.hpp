// The knobs that the methods on sampled facets share (thesis 4.1).
#pragma once
#include "algorithms/algorithm.hpp"

namespace algorithms {

inline Knob stride_knob() {
  return {.name = "stride",
          .preset = std::int64_t{20},  // thesis 4.1: every twentieth facet
          .unit = "1",
          .what = "every stride-th facet is sampled",
          .least = 1,
          .most = 1e9};
}

inline Knob inflate_knob() {
  return {.name = "inflate",
          .preset = 1.1,
          .unit = "1",
          .what = "factor on the sampled points, about the body's origin",
          .least = 1e-3,
          .most = 1e3};
}

inline Knob triangles_knob() {
  return {.name = "triangles",
          .preset = std::string("disjoint"),
          .unit = "1",
          .what = "triangles of consecutive points: (0,1,2), (3,4,5), ... or (0,1,2), (1,2,3), ...",
          .choices = {"disjoint", "strip"}};
}

/// Off: the mesh's own facets, as published. On: as many as facet_distance has by its presets.
inline Knob densify_knob() {
  return {.name = "densify",
          .preset = false,
          .unit = "1",
          .what = "cut the facets of a mesh that has fewer than 8 per m^2 of its box"};
}

}  // namespace algorithms
