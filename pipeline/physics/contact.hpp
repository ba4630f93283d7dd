// Contacts of spheres and boxes, and their force. A body has one sphere, several, or is a box. C++17 with Simbody's
// small vectors: only the target that integrates sees it.
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
  Vec3 centre{0};  // in its body's frame
  bool centred = true;
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

/// Pairs of spheres that may touch: hash grids, one for the spheres of about the same size, of cells at least as wide
/// as the greatest of them. A sphere looks into its own grid and those of greater ones, so that small ones never look
/// through a cell full of small ones for a great one's sake. Coordinates of cells are compared, not only their hashes,
/// so the pairs depend on neither hash nor table; they come sorted.
class Grid {
 public:
  /// Replaces `pairs` by all i < j (of two bodies, not both fixed) whose centres are less than radius_i + radius_j +
  /// margin apart.
  void find(const std::vector<Sphere>& spheres, const std::vector<Vec3>& centres, double margin,
            std::vector<std::pair<int, int>>& pairs) {
    pairs.clear();
    const int count = static_cast<int>(spheres.size());
    if (count < 2) return;
    double greatest = 0;
    for (const Sphere& sphere : spheres) greatest = std::max(greatest, sphere.radius);

    std::size_t size = 16;
    while (size < 2 * spheres.size()) size *= 2;
    first_.assign(size, -1);
    next_.resize(spheres.size());
    cells_.resize(spheres.size());
    std::array<bool, kLevels> used{};
    for (int i = count - 1; i >= 0; --i) {
      int level = 0;
      for (double radius = greatest / 2; level + 1 < kLevels && spheres[i].radius <= radius; radius /= 2) ++level;
      used[level] = true;
      cells_[i] = cell(centres[i], level, greatest, margin);
      const std::size_t slot = hash(cells_[i]) & (size - 1);
      next_[i] = first_[slot];
      first_[slot] = i;
    }
    const bool one_level = std::count(used.begin(), used.end(), true) == 1;
    for (int i = 0; i < count; ++i) {
      const std::size_t begin = pairs.size();
      for (int level = 0; level <= cells_[i][3]; ++level) {
        if (!used[level]) continue;
        const bool own = level == cells_[i][3];
        const Cell here = own ? cells_[i] : cell(centres[i], level, greatest, margin);
        for (int x = -1; x <= 1; ++x)
          for (int y = -1; y <= 1; ++y)
            for (int z = -1; z <= 1; ++z) {
              const Cell around{here[0] + x, here[1] + y, here[2] + z, level};
              for (int j = first_[hash(around) & (size - 1)]; j >= 0; j = next_[j]) {
                if ((own && j <= i) || cells_[j] != around || spheres[i].body == spheres[j].body ||
                    (spheres[i].fixed && spheres[j].fixed))
                  continue;
                const double reach = spheres[i].radius + spheres[j].radius + margin;
                if ((centres[j] - centres[i]).normSqr() < reach * reach) pairs.emplace_back(std::minmax(i, j));
              }
            }
      }
      if (one_level) std::sort(pairs.begin() + static_cast<std::ptrdiff_t>(begin), pairs.end());
    }
    if (!one_level) std::sort(pairs.begin(), pairs.end());
  }

 private:
  using Cell = std::array<std::int32_t, 4>;  // x, y, z and the level
  static constexpr double kLimit = 1 << 30;
  static constexpr int kLevels = 8;  // each for radii up to half those of the one before; the last for all smaller ones

  static Cell cell(const Vec3& centre, int level, double greatest, double margin) {
    // A little wider than needed: the quotient below is rounded.
    const double width = (2 * std::ldexp(greatest, -level) + margin) * 1.001;
    Cell out;
    for (int axis = 0; axis < 3; ++axis) {
      // Bodies beyond the limits (2^30 cells) share the outermost cells: slower, but nothing is missed.
      const double coordinate = std::floor(centre[axis] / width);
      out[axis] = static_cast<std::int32_t>(std::max(-kLimit, std::min(kLimit, coordinate)));
    }
    out[3] = level;
    return out;
  }

  static std::size_t hash(const Cell& cell) {
    std::uint64_t h = 0;
    for (const std::int32_t c : cell) h = (h ^ static_cast<std::uint32_t>(c)) * 0x9E3779B97F4A7C15u;
    return static_cast<std::size_t>(h >> 32);
  }

  std::vector<int> first_, next_;
  std::vector<Cell> cells_;
};

/// A sphere with its centre at `s` and box `b`: the closest point of the box decides; a centre inside is pushed out
/// through the nearest face.
inline bool touch(const Box& box, const Kinematics& b, const Sphere& sphere, const Vec3& s, Contact& contact) {
  const Vec3 apart = s - b.position;
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
  contact.point = s - (reach - contact.depth / 2) * contact.normal;
  contact.radius = reach;  // a face is flat; edges and corners take the same
  return contact.depth > 0;
}

/// Spheres with their centres at `a` and `b`.
inline bool touch(const Sphere& sphere_a, const Vec3& a, const Sphere& sphere_b, const Vec3& b, Contact& contact) {
  const Vec3 apart = b - a;
  const double reach = sphere_a.radius + sphere_b.radius;
  const double distance_squared = apart.normSqr();
  if (distance_squared >= reach * reach) return false;
  const double distance = std::sqrt(distance_squared);
  contact.a = sphere_a.body;
  contact.b = sphere_b.body;
  contact.depth = reach - distance;
  // Coincident centres have no direction; any one parts them.
  contact.normal = distance > 0 ? Vec3(apart / distance) : Vec3(0, 1, 0);
  contact.point = a + (sphere_a.radius - contact.depth / 2) * contact.normal;
  contact.radius = sphere_a.radius * sphere_b.radius / reach;
  return contact.depth > 0;
}

/// Pairs that may touch, found anew only when something has moved: those closer than a margin, while no sphere has come
/// further than half of it. Which pairs touch does not depend on when that was, so neither does the force.
class Neighbours {
 public:
  Neighbours() = default;
  Neighbours(std::vector<Sphere> spheres, std::vector<Box> boxes)
      : spheres_(std::move(spheres)), boxes_(std::move(boxes)), centres_(spheres_.size()), beside_(boxes_.size()) {
    double sum = 0, moving = 0;
    for (const Sphere& sphere : spheres_) {
      if (sphere.fixed) continue;
      sum += sphere.radius;
      moving += 1;
    }
    if (moving > 0) margin_ = kMargin * (sum / moving);
  }

  /// Replaces `contacts` by what touches. In a defined order, since sums of doubles depend on it: spheres by their
  /// numbers, then each box's spheres.
  void find(const std::vector<Kinematics>& bodies, std::vector<Contact>& contacts) {
    contacts.clear();
    for (std::size_t i = 0; i < spheres_.size(); ++i) {
      const Sphere& sphere = spheres_[i];
      if (sphere.fixed && !searched_.empty()) continue;
      const Kinematics& body = bodies[sphere.body];
      centres_[i] = sphere.centred ? body.position : body.position + body.orientation * sphere.centre;
    }
    if (moved()) search(bodies);
    Contact contact;
    for (const auto& [i, j] : pairs_) {
      const Sphere& a = spheres_[i];
      const Sphere& b = spheres_[j];
      const double reach = a.radius + b.radius;
      if ((centres_[j] - centres_[i]).normSqr() < reach * reach && touch(a, centres_[i], b, centres_[j], contact))
        contacts.push_back(contact);
    }
    for (std::size_t k = 0; k < boxes_.size(); ++k)
      for (const int i : beside_[k])
        if (touch(boxes_[k], bodies[boxes_[k].body], spheres_[i], centres_[i], contact)) contacts.push_back(contact);
  }

 private:
  // Of the radius, on average, of those that move. Falling spheres would be 2 % faster with 1, those at rest slower;
  // below 0.2 both are slower.
  static constexpr double kMargin = 0.4;

  bool moved() const {
    if (searched_.size() != centres_.size()) return true;
    const double most = 0.49 * margin_;  // rounding is far below the rest
    for (std::size_t i = 0; i < centres_.size(); ++i)
      if (!((centres_[i] - searched_[i]).normSqr() <= most * most)) return true;
    return false;
  }

  void search(const std::vector<Kinematics>& bodies) {
    searched_ = centres_;
    grid_.find(spheres_, centres_, margin_, pairs_);
    for (std::size_t k = 0; k < boxes_.size(); ++k) {
      beside_[k].clear();
      for (std::size_t i = 0; i < spheres_.size(); ++i)
        if (may_touch(boxes_[k], bodies[boxes_[k].body], i)) beside_[k].push_back(static_cast<int>(i));
    }
  }

  /// A box that moves may turn, so all spheres are its neighbours.
  bool may_touch(const Box& box, const Kinematics& b, std::size_t i) const {
    if (!box.fixed) return spheres_[i].body != box.body;
    if (spheres_[i].fixed) return false;
    const Vec3 centre = ~b.orientation * (centres_[i] - b.position);
    const double reach = spheres_[i].radius + margin_;
    for (int axis = 0; axis < 3; ++axis)
      if (std::fabs(centre[axis]) >= box.half_extents[axis] + reach) return false;
    return true;
  }

  std::vector<Sphere> spheres_;
  std::vector<Box> boxes_;
  std::vector<Vec3> centres_, searched_;    // of the spheres, now and when they were searched
  std::vector<std::vector<int>> beside_;    // of each box: spheres near it
  std::vector<std::pair<int, int>> pairs_;  // of spheres near each other
  Grid grid_;
  double margin_ = 0;
};

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
