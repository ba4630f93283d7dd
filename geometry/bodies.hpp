// The bodies of a run as columns, and the pairs of bodies that a step asks about.
#pragma once
#include <compare>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "geometry/mesh.hpp"

namespace geometry {

/// Where nothing else is said: eight steps of a float at the mesh's greatest coordinate, about the last of six decimal
/// digits. Exporters that compute a corner twice differ by roundings of doubles (2^-50 of the size, 1e-34 m where a
/// sine should be 0) or, in binary STL, by those of floats; details that a mesh means are larger.
inline constexpr double kClosedWithin = 0x1p-20;

/// Everything about the bodies that does not change from step to step. Columns have one entry per body.
struct Bodies {
  std::vector<Mesh> meshes;          // distinct meshes, shared by bodies
  std::vector<std::string> name;     // unique
  std::vector<std::uint32_t> mesh;   // index into `meshes`
  std::vector<std::uint8_t> fixed;   // 1: never moves
  std::vector<std::uint8_t> chosen;  // empty: all pairs count; else a pair counts when one of its bodies has 1 here
  double closed_within =
      kClosedWithin;  // of a mesh's size: corners that count as one (geometry/decision/contain.hpp); 0: none

  std::size_t size() const { return mesh.size(); }
  /// One more body, of the mesh `meshes[of]`.
  void add(std::string called, std::uint32_t of, bool never_moves = false) {
    name.push_back(std::move(called));
    mesh.push_back(of);
    fixed.push_back(never_moves);
  }
  const Mesh& mesh_of(std::uint32_t body) const { return meshes[mesh[body]]; }
};

/// Two bodies, a < b.
struct Pair {
  std::uint32_t a = 0, b = 0;
  auto operator<=>(const Pair&) const = default;
};

/// A pair of which one body lies wholly inside the other (geometry/decision/contain.hpp).
struct Contained {
  Pair pair;
  std::uint32_t inside = 0;  // the body that is: one of the two
};

/// The pairs (a, b) with first <= b < last; a < first. A step's pairs as runs take memory by the body, not by the pair.
struct PairRun {
  std::uint32_t a = 0, first = 0, last = 0;
};

/// The pairs that count at a step: both born (`poses` has one pose per body), not both fixed, and one of them chosen.
/// Sorted by a, then by b; runs are as long as possible and never empty.
std::vector<PairRun> pair_runs(const Bodies& bodies, std::span<const Pose> poses);

/// How many pairs the runs hold.
std::uint64_t pair_count(std::span<const PairRun> runs);

}  // namespace geometry
