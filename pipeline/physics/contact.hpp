// Contacts of spheres and boxes, and their force. C++17 with Simbody's small vectors: only simulate.cpp includes it.
//
// The law is that of Simbody's CompliantContactSubsystem for Hertz circular contact (its header and the documentation
// of ContactMaterial), so that the two can be compared: tests/pipeline/simulate_simbody_test.cpp does.
#pragma once
#include <SimTKcommon.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "pipeline/physics/simulate.hpp"

namespace pipeline::contact {

using SimTK::Rotation;
using SimTK::Vec3;

struct Sphere {
  int body;
  bool fixed;
  double radius;
};

struct Box {
  int body;
  bool fixed;
  Vec3 half_extents;
};

/// Of one body in ground. Orientations are kept for boxes only.
struct Kinematics {
  Vec3 position{0};
  Rotation orientation;
  Vec3 velocity{0};
  Vec3 angular_velocity{0};
};

struct Contact {
  int a, b;
  Vec3 normal;    // from a to b, unit
  Vec3 point;     // half way between the undeformed surfaces
  double depth;   // > 0
  double radius;  // effective
};

/// Pairs of spheres that may touch: a hash grid of cells at least as wide as the greatest sphere. Coordinates of cells
/// are compared, not only their hashes, so the pairs depend on neither hash nor table; they come sorted.
class Grid {
 public:
  /// Replaces `pairs` by all i < j (not both fixed) whose centres are less than radius_i + radius_j + margin apart.
  void find(const std::vector<Sphere>& spheres, const std::vector<Kinematics>& bodies, double margin,
            std::vector<std::pair<int, int>>& pairs) {
    pairs.clear();
    const int count = static_cast<int>(spheres.size());
    if (count < 2) return;
    double greatest = 0;
    for (const Sphere& sphere : spheres) greatest = std::max(greatest, sphere.radius);
    // A little wider than needed: the quotient below is rounded.
    const double cell = (2 * greatest + margin) * 1.001;

    std::size_t size = 16;
    while (size < 2 * spheres.size()) size *= 2;
    first_.assign(size, -1);
    next_.resize(spheres.size());
    cells_.resize(spheres.size());
    for (int i = count - 1; i >= 0; --i) {
      const Vec3& centre = bodies[spheres[i].body].position;
      for (int axis = 0; axis < 3; ++axis) {
        // Bodies beyond the limits (2^30 cells) share the outermost cells: slower, but nothing is missed.
        const double coordinate = std::floor(centre[axis] / cell);
        cells_[i][axis] = static_cast<std::int32_t>(std::max(-kLimit, std::min(kLimit, coordinate)));
      }
      const std::size_t slot = hash(cells_[i]) & (size - 1);
      next_[i] = first_[slot];
      first_[slot] = i;
    }
    for (int i = 0; i < count; ++i) {
      const std::size_t begin = pairs.size();
      for (int x = -1; x <= 1; ++x)
        for (int y = -1; y <= 1; ++y)
          for (int z = -1; z <= 1; ++z) {
            const Cell around{cells_[i][0] + x, cells_[i][1] + y, cells_[i][2] + z};
            for (int j = first_[hash(around) & (size - 1)]; j >= 0; j = next_[j]) {
              if (j <= i || cells_[j] != around || (spheres[i].fixed && spheres[j].fixed)) continue;
              const double reach = spheres[i].radius + spheres[j].radius + margin;
              const Vec3 between = bodies[spheres[j].body].position - bodies[spheres[i].body].position;
              if (between.normSqr() < reach * reach) pairs.emplace_back(i, j);
            }
          }
      std::sort(pairs.begin() + static_cast<std::ptrdiff_t>(begin), pairs.end());
    }
  }

 private:
  using Cell = std::array<std::int32_t, 3>;
  static constexpr double kLimit = 1 << 30;

  static std::size_t hash(const Cell& cell) {
    std::uint64_t h = 0;
    for (const std::int32_t c : cell) h = (h ^ static_cast<std::uint32_t>(c)) * 0x9E3779B97F4A7C15u;
    return static_cast<std::size_t>(h >> 32);
  }

  std::vector<int> first_, next_;
  std::vector<Cell> cells_;
};

/// Sphere `s` and box `b`: the closest point of the box decides; a centre inside is pushed out through the nearest
/// face.
inline bool touch(const Box& box, const Kinematics& b, const Sphere& sphere, const Kinematics& s, Contact& contact) {
  const Vec3 apart = s.position - b.position;
  const Vec3& half = box.half_extents;
  const double reach = sphere.radius;
  const Vec3 centre = ~b.orientation * apart;
  Vec3 closest;
  for (int axis = 0; axis < 3; ++axis) {
    if (std::fabs(centre[axis]) >= half[axis] + reach) return false;
    closest[axis] = std::max(-half[axis], std::min(half[axis], centre[axis]));
  }
  const Vec3 out = centre - closest;
  const double distance_squared = out.normSqr();
  if (distance_squared >= reach * reach) return false;

  double distance = std::sqrt(distance_squared);  // negative when the centre is inside
  Vec3 normal(0);
  if (distance > 0) {
    normal = out / distance;
  } else {
    int face = 0;
    for (int axis = 1; axis < 3; ++axis)
      if (half[axis] - std::fabs(centre[axis]) < half[face] - std::fabs(centre[face])) face = axis;
    distance = std::fabs(centre[face]) - half[face];
    normal[face] = centre[face] < 0 ? -1 : 1;
  }
  contact.a = box.body;
  contact.b = sphere.body;
  contact.depth = reach - distance;
  contact.normal = b.orientation * normal;
  contact.point = s.position - (reach - contact.depth / 2) * contact.normal;
  contact.radius = reach;  // a face is flat; edges and corners take the same
  return contact.depth > 0;
}

inline bool touch(const Sphere& sphere_a, const Kinematics& a, const Sphere& sphere_b, const Kinematics& b,
                  Contact& contact) {
  const Vec3 apart = b.position - a.position;
  const double reach = sphere_a.radius + sphere_b.radius;
  const double distance_squared = apart.normSqr();
  if (distance_squared >= reach * reach) return false;
  const double distance = std::sqrt(distance_squared);
  contact.a = sphere_a.body;
  contact.b = sphere_b.body;
  contact.depth = reach - distance;
  // Coincident centres have no direction; any one parts them.
  contact.normal = distance > 0 ? Vec3(apart / distance) : Vec3(0, 1, 0);
  contact.point = a.position + (sphere_a.radius - contact.depth / 2) * contact.normal;
  contact.radius = sphere_a.radius * sphere_b.radius / reach;
  return contact.depth > 0;
}

class Law {
 public:
  explicit Law(const Material& material) : material_(material) {
    // Simbody combines two materials by k = k1 k2 / (k1 + k2) of their stiffnesses to the power 2/3; these are equal.
    k_ = std::pow(material.stiffness, 2. / 3.) / 2;
  }

  /// N, of Hertz: 4/3 E* sqrt(R) x^(3/2) with E* = k^(3/2).
  double elastic_force(const Contact& c) const { return 4. / 3. * k_ * c.depth * std::sqrt(c.radius * k_ * c.depth); }

  /// J, the integral of the elastic force over depth.
  double elastic_energy(const Contact& c) const { return 2. / 5. * elastic_force(c) * c.depth; }

  /// N, on b at the point of contact; `velocity` m/s is that of b seen from a there. Never pulls.
  Vec3 force(const Contact& c, const Vec3& velocity) const {
    const double approach = -~velocity * c.normal;
    const double normal_force = elastic_force(c) * (1 + 1.5 * material_.dissipation * approach);
    if (!(normal_force > 0)) return Vec3(0);
    const Vec3 slip = velocity + approach * c.normal;
    const double speed_squared = slip.normSqr();
    if (speed_squared <= SimTK::square(SimTK::SignificantReal)) return normal_force * c.normal;
    const double speed = std::sqrt(speed_squared);
    return normal_force * c.normal - (normal_force * friction(speed) / speed) * slip;
  }

 private:
  /// Coefficient of friction at a slip of `speed` m/s: 0 at rest, static at the transition velocity v, dynamic from 3 v
  /// on, joined by quintics with flat ends; viscous friction is added.
  double friction(double speed) const {
    const auto smooth = [](double x) { return x * x * x * (10 + x * (6 * x - 15)); };
    const double v = speed / material_.transition_velocity;
    const double at_rest = material_.static_friction, sliding = material_.dynamic_friction;
    double dry = sliding;
    if (v < 1)
      dry = at_rest * smooth(v);
    else if (v < 3)
      dry = at_rest - (at_rest - sliding) * smooth((v - 1) / 2);
    return dry + material_.viscous_friction * speed;
  }

  Material material_;
  double k_;
};

}  // namespace pipeline::contact
