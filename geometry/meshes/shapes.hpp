// The built-in shapes as meshes: closed, counter-clockwise from outside, without facets of no area.
//
// Sphere, box, torus and torus knot follow the builders of Babylon.js, whose meshes the thesis used: the same vertices
// (up to rounding), the same order of facets and the same first corner of each. They differ in three points: shared
// seams and single poles instead of doubled vertices, no zero-area facets at the poles, and the other two corners
// swapped, because Babylon.js is left-handed. The capsule is a shape of its own, see there.
//
// Parameters are checked by whoever reads them from a user; here their rules are assertions. `shape` holds kind and
// parameters as JSON, keys in the order of the arguments. Lengths are in metres. A test pins each shape by a digest.
#pragma once
#include <cstdint>
#include <string>

#include "geometry/mesh.hpp"

namespace geometry {

/// A sphere about the origin, poles on the y axis. radius > 0, segments >= 1.
///
/// T = segments + 2 bands, 2T columns. Row i, column j: radius (sin a cos f, cos a, -sin a sin f), a = pi i / T,
/// f = pi j / T. Vertices: the pole +y, row 1, ..., row T - 1, the pole -y; 2T (T - 1) + 2 in all.
/// Facets: bands from +y down, columns within a band; with v(i,j) the vertex of row i and column j, first
/// v(i,j) v(i+1,j) v(i,j+1), which the first band lacks, then v(i+1,j) v(i+1,j+1) v(i,j+1), which the last band
/// lacks; 4T (T - 1) in all, 1224 for 16 segments, 4488 for 32.
/// Vertices that lie on an axis plane or mirror each other do so exactly; surface_deviation is the exact greatest
/// depth.
Mesh sphere(const std::string& name, double radius, std::int64_t segments);

/// The box -size/2 <= p <= size/2. Sides >= 0: it may be flat.
///
/// Vertex k: +x if k & 1, +y if k & 2, +z if k & 4. Facets: two for each of +z, -z, +x, -x, +y, -y.
Mesh box(const std::string& name, const Vec3& size);

/// The convex hull of two spheres on the y axis that reaches from -height/2 (radius_bottom) to +height/2 (radius_top);
/// the origin is at half the height. Radii > 0, height - radius_bottom - radius_top > |radius_bottom - radius_top|.
/// segments >= 1.
///
/// Babylon.js's CreateCapsule is the same for equal radii. For unequal ones it puts the origin midway between the
/// centres of the spheres and lets cap and side meet at an angle; the hull is smooth.
///
/// T = segments + 2, 2T columns, rows from +y down: pole, ceil(T/2) bands of equal angle to where the cap meets the
/// side, two bands of side (Babylon.js's preset), ceil(T/2) bands of equal angle, pole. Vertices and facets in the
/// order of the sphere's. surface_deviation is the greatest depth.
Mesh capsule(const std::string& name, double height, double radius_bottom, double radius_top, std::int64_t segments);

/// A torus about the y axis. diameter: of the circle inside the tube; thickness: of the tube. 0 < thickness < diameter,
/// segments >= 3.
///
/// n = segments rings of n vertices, ring by ring: vertex n i + j is (o sin a, -thickness/2 sin b, o cos a) with
/// a = 2 pi i / n, b = 2 pi j / n and o = diameter/2 - thickness/2 cos b. Facets: ring by ring, in it by j:
/// (i,j) (i+1,j) (i,j+1), then (i,j+1) (i+1,j) (i+1,j+1); 2 n n in all.
/// surface_deviation: the greatest distance over a grid of 15 points on each facet.
Mesh torus(const std::string& name, double diameter, double thickness, std::int64_t segments);

/// A tube around the curve radius/2 ((2 + cos v) cos u, (2 + cos v) sin u, sin v), v = u q/p, 0 <= u < 2 pi p: a (p, q)
/// torus knot about the z axis. radius, tube > 0 (tube: radius of the tube); both segments >= 3; p, q >= 1 without
/// common factor. A thick tube may cross itself: that is not checked.
///
/// radial_segments rings of tubular_segments vertices, ring by ring. Ring i lies at u = 2 pi p i / radial_segments in
/// Babylon.js's frame: C = curve(u), D = curve(u + 0.01), t = D - C, s = t x (C + D), n = s x t, the last two at unit
/// length; vertex j is C - tube cos(b) n + tube sin(b) s, b = 2 pi j / tubular_segments. As t is a chord, rings are
/// tilted by about 0.005 rad and surface_deviation contains that. Facets: ring by ring, in it by j: (i,j+1) (i,j)
/// (i+1,j), then (i,j+1) (i+1,j) (i+1,j+1). surface_deviation: the greatest distance over a grid of 15 points on each
/// facet.
Mesh torus_knot(const std::string& name, double radius, double tube, std::int64_t radial_segments,
                std::int64_t tubular_segments, std::int64_t p, std::int64_t q);

}  // namespace geometry
