#include "algorithms/beyond/octree.hpp"

#include <algorithm>
#include <array>

#include "algorithms/contract/pairwise.hpp"
#include "geometry/decision/broad_phase.hpp"

namespace algorithms {
namespace {

using geometry::Box;
using geometry::Vec3;

constexpr char kDepth[] = "depth", kCapacity[] = "capacity", kThen[] = "then";
constexpr std::size_t kThinned = 4;  // children that hold more than this many times the bodies of a cell gain nothing

/// Which halves of a cell a body touches: bits 0 to 2 the lower along x, y, z; bits 3 to 5 the upper. What cannot be
/// compared touches both.
std::uint8_t halves(const Box& body, const Vec3& middle) {
  unsigned out = 0;
  for (int k = 0; k < 3; ++k)
    out |= unsigned{!(body.min[k] > middle[k])} << k | unsigned{!(body.max[k] < middle[k])} << (3 + k);
  return static_cast<std::uint8_t>(out);
}

/// The halves that child c is made of.
constexpr std::uint8_t halves_of(unsigned c) {
  unsigned out = 0;
  for (unsigned k = 0; k < 3; ++k) out |= 1u << (c >> k & 1 ? 3 + k : k);
  return static_cast<std::uint8_t>(out);
}

/// How many of the eight children that are.
unsigned children(std::uint8_t halves) {
  unsigned out = 1;
  for (int k = 0; k < 3; ++k) out *= (halves >> k & 1u) + (halves >> (3 + k) & 1u);
  return out;
}

const Algorithm& then_row(const Knobs& knobs) { return *find(value_of<std::string>(knobs, kThen)); }

class Octree final : public Method {
 public:
  Octree(const Bodies& bodies, const Knobs& knobs)
      : bodies_(bodies),
        depth_(static_cast<int>(value_of<std::int64_t>(knobs, kDepth))),
        capacity_(static_cast<std::size_t>(value_of<std::int64_t>(knobs, kCapacity))),
        then_(then_row(knobs).make(bodies, presets(then_row(knobs)))),
        boxes_(bodies.size()),
        first_leaf_(bodies.size() + 1),
        seen_(bodies.size()) {
    for (const geometry::Mesh& mesh : bodies.meshes) enclosures_.push_back(geometry::enclosure(mesh));
    for (auto* places : {&open_, &places_, &leaves_}) places->reserve(kPlaces * bodies.size());
    masks_.reserve(kPlaces * bodies.size());
    near_.reserve(kPlaces * bodies.size());
    first_place_.reserve(kPlaces * bodies.size());
  }

  static Memory memory(const Bodies& bodies, const Knobs& knobs) {
    constexpr std::size_t kPlace = 4 * sizeof(std::uint32_t) + 1 + sizeof(PairRun);
    const Memory then = algorithms::memory(then_row(knobs), bodies, presets(then_row(knobs)));
    const std::uint64_t own =
        bodies.meshes.size() * sizeof(geometry::Enclosure) +
        bodies.size() * (sizeof(Box) + sizeof(std::size_t) + 2 * sizeof(std::uint32_t) + kPlaces * kPlace);
    return {then.held + own, std::max(then.greatest, then.held + own)};
  }

  void prepare(std::span<const Pose> poses, double enlarge) override {
    then_->prepare(poses, enlarge);
    scene_ = {};
    open_.clear();
    for (std::uint32_t body = 0; body < poses.size(); ++body) {
      if (!geometry::is_born(poses[body])) continue;
      const geometry::Enclosure& around = enclosures_[bodies_.mesh[body]];
      const geometry::Placement at = geometry::placement(around, poses[body]);
      Box& box = boxes_[body] = geometry::world_box(around, at);
      if (enlarge > 0) {
        const double grow = enlarge * (around.reach + at.length);
        box.min.array() -= grow;
        box.max.array() += grow;
      }
      scene_.add(box);
      open_.push_back(body);
    }
  }

  void answer(std::span<const PairRun> runs, std::vector<Pair>& hits) override {
    NoCount none;
    share_leaves(runs, none);
    then_->answer(near_, hits);
  }

  std::uint64_t count(std::span<const PairRun> runs, std::vector<Pair>& hits) override {
    Counter counter;
    share_leaves(runs, counter);
    return counter.total + then_->count(near_, hits);
  }

 private:
  static constexpr std::size_t kPlaces = 16;  // in leaves, of a body, for which memory is taken beforehand

  /// The asked pairs that share a leaf, each once, into near_.
  template <class Count>
  void share_leaves(std::span<const PairRun> runs, Count& count) {
    places_.clear();
    first_place_.assign(1, 0);
    const std::size_t born = open_.size();
    if (born > 0) cut(0, scene_, depth_, count);
    open_.resize(born);  // as prepare left it

    // The leaves of each body.
    std::fill(first_leaf_.begin(), first_leaf_.end(), 0u);
    for (const std::uint32_t body : places_) ++first_leaf_[body + 1];
    for (std::size_t body = 0; body < bodies_.size(); ++body) first_leaf_[body + 1] += first_leaf_[body];
    leaves_.resize(places_.size());
    for (std::uint32_t leaf = 0; leaf + 1 < first_place_.size(); ++leaf)
      for (std::uint32_t i = first_place_[leaf]; i < first_place_[leaf + 1]; ++i)
        leaves_[first_leaf_[places_[i]]++] = leaf;
    // Each start has become the next body's.

    near_.clear();
    std::fill(seen_.begin(), seen_.end(), 0u);
    std::size_t run = 0;
    for (std::uint32_t a = 0; a < bodies_.size(); ++a) {
      const std::size_t first = run;
      while (run < runs.size() && runs[run].a == a) ++run;
      if (first == run) continue;
      const std::uint32_t start = a ? first_leaf_[a - 1] : 0;
      for (std::uint32_t k = start; k < first_leaf_[a]; ++k)
        for (std::uint32_t i = first_place_[leaves_[k]]; i < first_place_[leaves_[k] + 1]; ++i) {
          const std::uint32_t b = places_[i];
          if (b <= a) continue;
          count += 1;
          if (seen_[b] == a + 1) continue;
          seen_[b] = a + 1;
          if (asked(runs.subspan(first, run - first), b)) near_.push_back({a, b, b + 1});
        }
    }
  }

  static bool asked(std::span<const PairRun> runs_of_a, std::uint32_t b) {
    for (const PairRun& run : runs_of_a)
      if (b < run.last) return run.first <= b;
    return false;
  }

  /// The cell of the bodies open_[first], ... to the end: leaves of it go into places_.
  template <class Count>
  void cut(std::size_t first, const Box& cell, int depth, Count& count) {
    const std::size_t last = open_.size(), size = last - first;
    if (size > capacity_ && depth > 0) {
      const Vec3 middle = 0.5 * cell.min + 0.5 * cell.max;
      count += size;
      masks_.resize(last);
      std::size_t together = 0;
      for (std::size_t i = first; i < last; ++i) together += children(masks_[i] = halves(boxes_[open_[i]], middle));
      if (together < kThinned * size) {
        for (unsigned c = 0; c < 8; ++c) {
          const std::uint8_t wanted = halves_of(c);
          for (std::size_t i = first; i < last; ++i)
            if ((masks_[i] & wanted) == wanted) open_.push_back(open_[i]);
          if (open_.size() == last) continue;
          Box child = cell;
          for (int k = 0; k < 3; ++k) (c >> k & 1 ? child.min : child.max)[k] = middle[k];
          cut(last, child, depth - 1, count);
          open_.resize(last);
        }
        return;
      }
    }
    if (size < 2) return;  // alone with nobody
    places_.insert(places_.end(), open_.begin() + static_cast<std::ptrdiff_t>(first), open_.end());
    first_place_.push_back(static_cast<std::uint32_t>(places_.size()));
  }

  const Bodies& bodies_;
  int depth_;
  std::size_t capacity_;
  std::unique_ptr<Method> then_;
  std::vector<geometry::Enclosure> enclosures_;  // #meshes
  // Of the step:
  Box scene_;
  std::vector<Box> boxes_;                  // #bodies
  std::vector<std::uint32_t> open_;         // born bodies, and on top of them those of the cells that are being cut
  std::vector<std::uint8_t> masks_;         // #open: halves of the cell
  std::vector<std::uint32_t> places_;       // bodies, leaf by leaf, ascending in each
  std::vector<std::uint32_t> first_place_;  // #leaves + 1
  std::vector<PairRun> near_;               // runs of one pair each
  std::vector<std::uint32_t> first_leaf_;   // #bodies + 1, into leaves_
  std::vector<std::uint32_t> leaves_;       // body by body
  std::vector<std::uint32_t> seen_;         // #bodies: 1 + the last body with which it was paired
};

}  // namespace

Algorithm octree() {
  return {.name = "octree",
          .what = "pairs that share a leaf of a tree of cells go to another method",
          .operations_unit = "bodies in cut cells, pairs in leaves, and the operations of `then`",
          .promise = Promise::conservative,
          .scope = Scope::scene,
          .knobs = {{.name = kDepth,
                     .preset = std::int64_t{6},
                     .unit = "1",
                     .what = "a cell is cut at most this many times",
                     .least = 0,
                     .most = 20},
                    {.name = kCapacity,
                     .preset = std::int64_t{8},
                     .unit = "1",
                     .what = "cells of more bodies are cut",
                     .least = 1,
                     .most = 1e6},
                    {.name = kThen,
                     .preset = "aabb",
                     .unit = "1",
                     .what = "the pairwise method that answers pairs of a leaf, with its presets; its promise is kept",
                     .role = Role::then}},
          .make = [](const Bodies& bodies, const Knobs& knobs) -> std::unique_ptr<Method> {
            return std::make_unique<Octree>(bodies, knobs);
          },
          .memory = Octree::memory};
}

}  // namespace algorithms
