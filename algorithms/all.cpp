// The table of algorithms: one line each, the thesis's nine in its order, then those of other sources and what the
// thesis wished for.
#include <algorithm>

#include "algorithms/aabb.hpp"
#include "algorithms/beyond/all_triangles.hpp"
#include "algorithms/beyond/capsule.hpp"
#include "algorithms/beyond/convex_hull.hpp"
#include "algorithms/beyond/facet_gjk.hpp"
#include "algorithms/beyond/facet_surface.hpp"
#include "algorithms/beyond/hulls.hpp"
#include "algorithms/beyond/octree.hpp"
#include "algorithms/beyond/proxy.hpp"
#include "algorithms/beyond/spheres.hpp"
#include "algorithms/cannon_naive.hpp"
#include "algorithms/cannon_sap.hpp"
#include "algorithms/exact.hpp"
#include "algorithms/exact_cold.hpp"
#include "algorithms/peers/fcl_bvh.hpp"
#include "algorithms/peers/plugins.hpp"
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

/// Every row, missing ones too.
std::vector<Algorithm> table() {
  std::vector<Algorithm> out = {
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
      convex_hull(),      //
      spheres(),          //
      capsule(),          //
      hulls(),            //
      proxy(),            //
      octree(),           //
      all_triangles(),    //
      facet_surface(),    //
      facet_gjk(),        //
      fcl_bvh(),          //
  };
  std::ranges::move(plugin_peers(), std::back_inserter(out));
  return out;
}

/// The rows of which this build has the library, or those of which it has not. Any pairwise row that it has may answer
/// before or after another: only the whole table knows them all.
std::vector<Algorithm> rows(bool present) {
  std::vector<Algorithm> out;
  std::vector<std::string> names;
  for (Algorithm& row : table()) {
    if (row.make && row.scope == Scope::pair) names.push_back(row.name);
    if ((row.make != nullptr) == present) out.push_back(std::move(row));
  }
  for (Algorithm& row : out)
    for (Knob& knob : row.knobs)
      if (knob.role == Role::prefilter || knob.role == Role::then)
        knob.choices.insert(knob.choices.end(), names.begin(), names.end());
  return out;
}

const Algorithm* named(const auto& rows, std::string_view name) {
  const auto found = std::ranges::find(rows, name, &Algorithm::name);
  return found == rows.end() ? nullptr : &*found;
}

std::deque<Algorithm>& rows_of_plugins() {
  static std::deque<Algorithm> rows;
  return rows;
}

}  // namespace

const std::vector<Algorithm>& all() {
  static const std::vector<Algorithm> have = rows(true);
  return have;
}

const std::vector<Algorithm>& missing() {
  static const std::vector<Algorithm> lack = rows(false);
  return lack;
}

const std::deque<Algorithm>& added() { return rows_of_plugins(); }

void add(Algorithm row) { rows_of_plugins().push_back(std::move(row)); }

const Algorithm* find(std::string_view name) {
  const Algorithm* own = named(all(), name);
  return own ? own : named(added(), name);
}

const Algorithm* find_missing(std::string_view name) { return named(added(), name) ? nullptr : named(missing(), name); }

}  // namespace algorithms
