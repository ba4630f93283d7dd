// A box about a body's position whose corners are turned about x, then y, then z, as the thesis does it.
//
// Source: Příbyl 2022, sections 2.2 and 4.1. The angles are Babylon.js's, whose own order is z, x, y: the box is that
// of the body for turns about one axis, and another one for some others. Published so, and kept.
#pragma once
#include <array>

#include "geometry/pose.hpp"

namespace geometry {

/// Sines and cosines of the turns about the three axes.
struct TurnXyz {
  double sin_x, cos_x, sin_y, cos_y, sin_z, cos_z;
};

/// Same bits on every machine.
TurnXyz turn_xyz(const EulerAngles& angles);

/// The turn by the negated angles, in the same order x, y, z: its inverse only for turns about one axis.
inline TurnXyz negated(const TurnXyz& turn) {
  return {-turn.sin_x, turn.cos_x, -turn.sin_y, turn.cos_y, -turn.sin_z, turn.cos_z};
}

/// Turns (x, y, z) about the x, then the y, then the z axis.
inline void apply(const TurnXyz& turn, double& x, double& y, double& z) {
  const double y1 = y * turn.cos_x - z * turn.sin_x, z1 = z * turn.cos_x + y * turn.sin_x;
  const double x2 = x * turn.cos_y + z1 * turn.sin_y;
  z = z1 * turn.cos_y - x * turn.sin_y;
  x = x2 * turn.cos_z - y1 * turn.sin_z;
  y = y1 * turn.cos_z + x2 * turn.sin_z;
}

/// The eight corners (+-h.x, +-h.y, +-h.z), turned, relative to the centre. Bits 0, 1, 2 of the index: plus on x, y, z.
std::array<Vec3, 8> turned_corners(const Vec3& half, const TurnXyz& turn);

/// The 12 outer triangles of a box by those indices, counter-clockwise seen from outside; 2 f and 2 f + 1 are a face.
inline constexpr std::array<std::array<int, 3>, 12> kBoxTriangles = {{{0, 4, 6},
                                                                      {0, 6, 2},
                                                                      {1, 3, 7},
                                                                      {1, 7, 5},
                                                                      {0, 1, 5},
                                                                      {0, 5, 4},
                                                                      {2, 6, 7},
                                                                      {2, 7, 3},
                                                                      {0, 2, 3},
                                                                      {0, 3, 1},
                                                                      {4, 5, 7},
                                                                      {4, 7, 6}}};

}  // namespace geometry
