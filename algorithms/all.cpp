// The table of algorithms: one line each, the thesis's nine in its order, then those of other sources.
#include "algorithms/aabb.hpp"
#include "algorithms/cannon_naive.hpp"
#include "algorithms/cannon_sap.hpp"
#include "algorithms/exact.hpp"
#include "algorithms/exact_cold.hpp"
#include "algorithms/peers/fcl_bvh.hpp"
#include "algorithms/thesis/bounding_sphere.hpp"
#include "algorithms/thesis/facet_distance.hpp"
#include "algorithms/thesis/facet_rotations.hpp"
#include "algorithms/thesis/facet_triangles.hpp"
#include "algorithms/thesis/facet_vectors.hpp"
#include "algorithms/thesis/obb_corners.hpp"
#include "algorithms/thesis/obb_sat.hpp"
#include "algorithms/thesis/obb_triangles.hpp"
#include "algorithms/thesis/rotated_aabb.hpp"

namespace algorithms {
namespace {

/// Any pairwise row may be a prefilter: only the whole table knows them all.
std::vector<Algorithm> with_prefilters(std::vector<Algorithm> table) {
  std::vector<std::string> names = {"none"};
  for (const Algorithm& algorithm : table)
    if (algorithm.scope == Scope::pair) names.push_back(algorithm.name);
  for (Algorithm& algorithm : table)
    for (Knob& knob : algorithm.knobs)
      if (knob.name == "prefilter") knob.choices = names;
  return table;
}

std::deque<Algorithm>& those_of_others() {
  static std::deque<Algorithm> rows;
  return rows;
}

}  // namespace

const std::vector<Algorithm>& all() {
  static const std::vector<Algorithm> table = with_prefilters({
      obb_sat(),          //
      bounding_sphere(),  //
      rotated_aabb(),     //
      facet_distance(),   //
      obb_corners(),      //
      facet_vectors(),    //
      obb_triangles(),    //
      facet_triangles(),  //
      facet_rotations(),  //
      aabb(),             //
      cannon_naive(),     //
      cannon_sap(),       //
      exact(),            //
      exact_cold(),       //
      fcl_bvh(),          //
  });
  return table;
}

const std::deque<Algorithm>& added() { return those_of_others(); }

void add(Algorithm row) { those_of_others().push_back(std::move(row)); }

const Algorithm* find(std::string_view name) {
  for (const Algorithm& algorithm : all())
    if (algorithm.name == name) return &algorithm;
  for (const Algorithm& algorithm : added())
    if (algorithm.name == name) return &algorithm;
  return nullptr;
}

}  // namespace algorithms
