#include "algorithms/peers/plugins.hpp"

namespace algorithms {
namespace {

constexpr const char* kSurfaces = "surfaces of the meshes";
constexpr const char* kHulls = "convex hulls";

Algorithm peer(const char* name, const char* what, const char* precision, Library library) {
  library.plugin = true;
  return {.name = name,
          .what = what,
          .operations_unit = "pairs of bodies that the library is asked about",
          .scope = Scope::scene,
          .precision = precision,
          .library = std::move(library)};
}

}  // namespace

std::vector<Algorithm> plugin_peers() {
  const Library gimpact{
      .name = "Bullet", .package = "libbullet-dev", .tests = kSurfaces, .licence = "Zlib", .language = "C++"};
  Library hull = gimpact;
  hull.tests = kHulls;
  const Library ode{.name = "ODE",
                    .package = "libode-dev",
                    .tests = kSurfaces,
                    .licence = "LGPL-2.1-or-later or BSD-3-Clause",
                    .language = "C++"};
  const Library ccd{
      .name = "libccd", .package = "libccd-dev", .tests = kHulls, .licence = "BSD-3-Clause", .language = "C"};
  const Library simbody{
      .name = "Simbody", .package = "libsimbody-dev", .tests = kSurfaces, .licence = "Apache-2.0", .language = "C++"};
  const Library embree{
      .name = "Embree", .package = "libembree-dev", .tests = kSurfaces, .licence = "Apache-2.0", .language = "C++"};
  const char* triangles = "Bullet, GImpact: hierarchies of boxes and triangles";
  const char* hulls = "Bullet, convex hulls of the vertices by GJK and EPA";
  return {
      peer("bullet_gimpact", triangles, "single", gimpact),
      peer("bullet_gimpact_double", triangles, "double", gimpact),
      peer("bullet_hull", hulls, "single", hull),
      peer("bullet_hull_double", hulls, "double", hull),
      peer("ode_trimesh", "Open Dynamics Engine: hierarchies of boxes and triangles, one contact asked for", "double",
           ode),
      peer("ccd_mpr", "libccd, convex hulls of the vertices by MPR", "double", ccd),
      peer("ccd_gjk", "libccd, convex hulls of the vertices by GJK", "double", ccd),
      peer("simbody_mesh", "Simbody: hierarchies of oriented boxes and triangles, every crossing sought", "double",
           simbody),
      peer("embree", "Embree: hierarchies refitted at each step find triangles, decided exactly", "double", embree),
  };
}

}  // namespace algorithms
