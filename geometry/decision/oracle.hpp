// The oracle: the truth once more, by other means, to check the decision with (`pipeline verify` and the tests).
//
// It shares no code and no method with the decision (geometry/decision/exact.hpp, geometry/decision/meet.hpp,
// geometry/decision/contain.hpp): every triangle is asked about every other by separating axes in exact numbers,
// containment by exact rays against all facets, and world vertices are computed from the definition written out again.
// The only short cut is the comparison of coordinates, which is exact for doubles. It is slow, some 10 us a pair of
// triangles, and meant to be.
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "geometry/bodies.hpp"
#include "geometry/decision/exact.hpp"

namespace geometry::brute_force {

/// True when the closed triangles share a point, exactly; degenerate ones too. Coordinates are finite.
bool triangles_meet(const Triangle& s, const Triangle& t);

/// True when the corners lie exactly on one line (or in one point).
bool degenerate(const Triangle& t);

/// True when a coordinate axis separates the triangles: then they do not meet.
bool apart_along_an_axis(const Triangle& a, const Triangle& b);

/// The world vertex ((r0 x + r1 y) + r2 z) + t, R being made from the quaternion as it stands.
Vec3 world_vertex(const Pose& pose, const Vec3& v);

/// The facets of a mesh in the world, in its order.
std::vector<Triangle> world_triangles(const Mesh& mesh, const Pose& pose);

/// The least and greatest coordinates of some points.
struct Extent {
  Vec3 min, max;
};

/// Of the mesh's vertices in the world. Not finite when one of them is not; min > max without vertices.
Extent world_extent(const Mesh& mesh, const Pose& pose);
bool is_finite(const Extent& extent);

/// Whether the extents share a point, and whether `inner` lies in `outer`; touching counts in both.
bool touch(const Extent& a, const Extent& b);
bool nested(const Extent& inner, const Extent& outer);

/// True when some triangle of `a` meets some triangle of `b`.
bool meet(std::span<const Triangle> a, std::span<const Triangle> b);

/// The closed surface of a mesh by the definition of geometry/decision/contain.hpp: the mesh itself where it is closed
/// by its coordinates, else with corners of open edges joined that lie within `closed_within` of its size; nothing when
/// it is open all the same.
std::optional<Mesh> closed_surface(const Mesh& mesh, double closed_within);

/// True when every corner of `inner` is inside `outer` by the parity rule, for surfaces that do not meet: then nothing
/// of `inner` is elsewhere. `outer` is a closed surface. Without triangles nothing is contained.
bool contained(std::span<const Triangle> inner, std::span<const Triangle> outer);

/// The pairs among `runs` that meet, sorted.
std::vector<Pair> hits(const Bodies& bodies, std::span<const Pose> poses, std::span<const PairRun> runs);

}  // namespace geometry::brute_force
