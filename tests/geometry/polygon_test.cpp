#include "geometry/decision/polygon.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "geometry/meshes/mesh_file.hpp"

namespace {

using geometry::cut_polygon;
using geometry::Facet;
using geometry::Mesh;
using geometry::PolygonFacts;
using geometry::Vec3;

using Flat = std::vector<std::pair<double, double>>;

/// Twice the signed area.
double shoelace(const Flat& p) {
  double sum = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const auto& [x, y] = p[i];
    const auto& [u, v] = p[(i + 1) % p.size()];
    sum += x * v - u * y;
  }
  return sum;
}

/// How often the outline goes around a point that is not on it.
int winding(const Flat& p, double x, double y) {
  int turns = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const auto& [ax, ay] = p[i];
    const auto& [bx, by] = p[(i + 1) % p.size()];
    if ((ay > y) == (by > y)) continue;
    if (ax + (y - ay) * (bx - ax) / (by - ay) > x) turns += by > ay ? 1 : -1;
  }
  return turns;
}

struct Cut {
  std::vector<Facet> triangles;
  PolygonFacts facts;
};

Cut cut(const Flat& p, const std::function<Vec3(double, double)>& place) {
  std::vector<Vec3> vertices;
  std::vector<std::uint32_t> corners(p.size());
  for (const auto& [x, y] : p) vertices.push_back(place(x, y));
  std::iota(corners.begin(), corners.end(), 0u);
  Cut out;
  out.triangles.resize(p.size() - 2);
  out.facts = cut_polygon(corners, vertices, out.triangles);
  return out;
}

Vec3 upright(double x, double y) { return {x, y, 0.25}; }

/// The triangles cover the polygon: all turn as it does, their areas add up to its, and the middle of each is inside.
/// `p` is drawn counter-clockwise or clockwise.
void expect_covered(const Flat& p, const std::vector<Facet>& triangles, const std::string& what) {
  const double area = shoelace(p), sign = area < 0 ? -1 : 1;
  double sum = 0, least = 0;
  int outside = 0;
  for (const auto& [a, b, c] : triangles) {
    const double twice = sign * shoelace({p[a], p[b], p[c]});
    sum += std::fabs(twice);
    least = std::min(least, twice);
    if (twice > 1e-12 * std::fabs(area)) {
      const double x = (p[a].first + p[b].first + p[c].first) / 3, y = (p[a].second + p[b].second + p[c].second) / 3;
      outside += winding(p, x, y) == 0;
    }
  }
  EXPECT_EQ(triangles.size() + 2, p.size()) << what;
  EXPECT_EQ(outside, 0) << what;
  EXPECT_GE(least, -1e-14 * std::fabs(area)) << what;
  EXPECT_NEAR(sum, std::fabs(area), 1e-12 * std::fabs(area)) << what;
}

Flat turned(const Flat& p, std::size_t first, bool backwards) {
  Flat out;
  for (std::size_t i = 0; i < p.size(); ++i) out.push_back(p[(first + (backwards ? p.size() - i : i)) % p.size()]);
  return out;
}

const Flat kL{{0, 0}, {4, 0}, {4, 1}, {1, 1}, {1, 4}, {0, 4}};
const Flat kArrow{{0, 0}, {3, 5}, {0, 1}, {-3, 5}};

Flat comb(int teeth) {
  Flat p{{0, 0}, {2.0 * teeth - 1, 0}};
  for (int i = teeth - 1; i >= 0; --i) {
    p.insert(p.end(), {{2 * i + 1, 5}, {2 * i, 5}});
    if (i > 0) p.insert(p.end(), {{2 * i, 1}, {2 * i - 1, 1}});
  }
  return p;
}

/// A corridor of width 1 between walls of an Archimedean spiral.
Flat spiral(int corners, double turns) {
  Flat p;
  const auto at = [&](double angle, double inward) {
    const double r = 1 + angle / M_PI - inward;
    p.emplace_back(r * std::cos(angle), r * std::sin(angle));
  };
  for (int i = 0; i < corners; ++i) at(2 * M_PI * turns * i / (corners - 1), 0);
  for (int i = corners - 1; i >= 0; --i) at(2 * M_PI * turns * i / (corners - 1), 0.75);
  return p;
}

/// A square of side 10 with square holes of side 1 in a row, each joined to the one before by a bridge that is walked
/// twice. Area 100 - holes.
Flat keyholes(int holes) {
  Flat p{{0, 0}, {10, 0}, {10, 10}, {0, 10}, {0, 5}};
  for (int i = 0; i < holes; ++i) {
    const double x = 0.5 + 9.0 * i / holes;
    p.insert(p.end(), {{x, 5}, {x, 5.5}, {x + 1, 5.5}, {x + 1, 5}});
  }
  for (int i = holes - 1; i >= 0; --i) {
    const double x = 0.5 + 9.0 * i / holes;
    if (i + 1 < holes) p.push_back({x + 1, 5});
    p.insert(p.end(), {{x + 1, 4.5}, {x, 4.5}, {x, 5}});
  }
  p.push_back({0, 5});
  return p;
}

const std::map<std::string, std::pair<Flat, double>> kShapes{
    // With areas that need no shoelace.
    {"L", {kL, 7}},
    {"arrow", {kArrow, 3}},
    {"comb", {comb(6), 11 + 6 * 4}},
    {"keyhole", {keyholes(1), 99}},
    {"three keyholes", {keyholes(3), 97}},
    {"convex with corners on its edges", {{{0, 0}, {1, 0}, {2, 0}, {2, 1}, {2, 2}, {1, 2}, {0, 2}, {0, 1}}, 4}},
    {"L with corners on its edges",
     {{{0, 0}, {2, 0}, {4, 0}, {4, 1}, {2, 1}, {1, 1}, {1, 2}, {1, 4}, {0, 4}, {0, 2}}, 7}},
    {"L with repeated corners", {{{0, 0}, {4, 0}, {4, 0}, {4, 1}, {1, 1}, {1, 1}, {1, 1}, {1, 4}, {0, 4}, {0, 4}}, 7}},
    // Two squares that share the point (1, 1), which is a corner of both.
    {"pinched", {{{0, 0}, {1, 0}, {1, 1}, {2, 1}, {2, 2}, {1, 2}, {1, 1}, {0, 1}}, 2}},
    // The hole touches the corner (0, 0) of the square from inside, and is walked from there.
    {"hole at a corner", {{{0, 0}, {4, 0}, {4, 4}, {0, 4}, {0, 0}, {1, 2}, {2, 1}}, 14.5}},
    // The same hole, joined at (2, 1) to the edge below: at (0, 0) the outline only touches itself.
    {"hole touches a corner and has a bridge",
     {{{0, 0}, {2, 0}, {2, 1}, {0, 0}, {1, 2}, {2, 1}, {2, 0}, {4, 0}, {4, 4}, {0, 4}}, 14.5}},
    // A tooth whose tip touches the opposite edge.
    {"tip on an edge", {{{0, 0}, {4, 0}, {4, 4}, {3, 4}, {2, 0}, {1, 4}, {0, 4}}, 12}},
    // Runs out and back, outside and inside.
    {"needle outside", {{{0, 0}, {4, 0}, {4, 2}, {7, 3}, {4, 2}, {4, 4}, {1, 4}, {1, 1}, {0, 1}}, 4 + 9}},
    {"slit", {{{0, 0}, {2, 0}, {2, 3}, {2, 0}, {4, 0}, {4, 4}, {2, 3.5}, {0, 4}}, 15}},
    // Two squares and a bent way of no width between them, which is walked both ways.
    {"dumbbell",
     {{{0, 0}, {2, 0}, {2, 1}, {5, 4}, {6, 1}, {8, 1}, {8, 3}, {6, 3}, {6, 1}, {5, 4}, {2, 1}, {2, 2}, {0, 2}}, 4 + 4}},
    {"dumbbell bent downwards",
     {{{0, 0}, {2, 0}, {2, 1}, {5, -4}, {6, 1}, {8, 1}, {8, 3}, {6, 3}, {6, 1}, {5, -4}, {2, 1}, {2, 2}, {0, 2}},
      4 + 4}},
};

}  // namespace

TEST(Polygon, IsCoveredFromEveryCornerInBothDirections) {
  for (const auto& [name, shape] : kShapes) {
    const auto& [points, area] = shape;
    ASSERT_NEAR(shoelace(points), 2 * area, 1e-12) << name;
    for (std::size_t first = 0; first < points.size(); ++first)
      for (const bool backwards : {false, true}) {
        const Flat p = turned(points, first, backwards);
        const Cut result = cut(p, upright);
        const std::string what = name + " from " + std::to_string(first) + (backwards ? " backwards" : "");
        EXPECT_FALSE(result.facts.crosses_itself) << what;
        EXPECT_EQ(result.facts.off_plane, 0) << what;
        expect_covered(p, result.triangles, what);
      }
  }
}

// On a line no triangle needs to be flat, unless the outline itself runs back.
TEST(Polygon, CornersOnALineMakeNoFlatTrianglesWhereEarsAreCut) {
  const Flat p = kShapes.at("L with corners on its edges").first;
  for (std::size_t first = 0; first < p.size(); ++first) {
    const Flat q = turned(p, first, false);
    // From two of its corners the fan stays inside and is kept, flat triangles and all.
    if (q[0] == p[0] || q[0] == p[5]) continue;
    for (const auto& [a, b, c] : cut(q, upright).triangles) EXPECT_GT(shoelace({q[a], q[b], q[c]}), 0.1) << first;
  }
}

TEST(Polygon, ConvexOnesAndFansThatStayInsideAreFans) {
  const Flat hexagon{{2, 0}, {4, 1}, {4, 3}, {2, 4}, {0, 3}, {0, 1}};
  for (const Flat& p : {hexagon, turned(hexagon, 2, true), turned(kL, 0, false), turned(kArrow, 2, true)}) {
    const std::vector<Facet> triangles = cut(p, upright).triangles;
    for (std::uint32_t k = 0; k < triangles.size(); ++k) EXPECT_EQ(triangles[k], (Facet{0, k + 1, k + 2}));
  }
}

// The L from its corner (4, 0), from which a fan would leave it. Third sides by hand: those of (4, 1) and of (1, 4) are
// the shortest, sqrt(10); of two that are equal the first corner goes first. Then (4, 0) has one of sqrt(2).
TEST(Polygon, TheEarWithTheShortestThirdSideIsCutFirst) {
  const std::vector<Facet> expected{{0, 1, 2}, {5, 0, 2}, {2, 3, 4}, {5, 2, 4}};
  EXPECT_EQ(cut(turned(kL, 1, false), upright).triangles, expected);
}

TEST(Polygon, IsCutInAnyPlaneAndSize) {
  for (const auto& [name, shape] : kShapes) {
    const Flat& p = shape.first;
    // Axes that double products of small integers turn exactly, and one that is not exact.
    const std::function<Vec3(double, double)> planes[] = {
        [](double x, double y) { return Vec3(3, x, y); },
        [](double x, double y) { return Vec3(y, -2, x); },
        [](double x, double y) { return Vec3(x, 0.5 * x + y, 2 * y); },
        [](double x, double y) { return Vec3(1e-160 * x, 1e-160 * y, 0); },
        [](double x, double y) { return Vec3(1e14 * x, 0, 1e14 * y); },
        [](double x, double y) { return Vec3(0.6 * x + 0.1 * y + 1e6, 0.8 * x - 0.3 * y, 0.7 * y); }};
    for (std::size_t k = 0; k < std::size(planes); ++k) {
      const Cut result = cut(p, planes[k]);
      // At 1e6 from the origin rounding moves corners by 1e-10: what touches there may cross.
      if (k == 5 && name != "L" && name != "arrow" && name != "comb") continue;
      EXPECT_FALSE(result.facts.crosses_itself) << name << " in plane " << k;
      expect_covered(p, result.triangles, name + " in plane " + std::to_string(k));
      EXPECT_LT(result.facts.off_plane, 1e-9 * result.facts.extent) << name << " in plane " << k;
    }
  }
}

TEST(Polygon, SpiralsAreCoveredFromEveryCorner) {
  const Flat points = spiral(40, 3);
  for (std::size_t first = 0; first < points.size(); ++first) {
    const Flat p = turned(points, first, first % 2);
    const Cut result = cut(p, upright);
    EXPECT_FALSE(result.facts.crosses_itself);
    expect_covered(p, result.triangles, "spiral from " + std::to_string(first));
  }
}

TEST(Polygon, ThatCrossesItselfIsAFanAndNamed) {
  Flat ring;  // more than once around, its ends over each other: winds twice there, never turns back
  for (int i = 0; i <= 10; ++i) ring.emplace_back(4 * std::cos(0.7 * i), 4 * std::sin(0.7 * i));
  for (int i = 10; i >= 0; --i) ring.emplace_back(3 * std::cos(0.7 * i), 3 * std::sin(0.7 * i));
  const std::map<std::string, Flat> crossing{
      {"bow tie", {{0, 0}, {1, 1}, {1, 0}, {0, 1}}},
      {"uneven bow tie", {{0, 0}, {3, 3}, {3, 0}, {0, 1}}},
      {"pentagram", {{0, 3}, {1.8, -2.4}, {-2.9, 0.9}, {2.9, 0.9}, {-1.8, -2.4}}},
      {"ring over itself", ring},
      {"through a corner", {{0, 0}, {1, 1}, {2, 2}, {2, 0}, {1, 1}, {0, 2}}}};
  for (const auto& [name, p] : crossing)
    for (std::size_t first = 0; first < p.size(); ++first)
      for (const bool backwards : {false, true}) {
        const Cut result = cut(turned(p, first, backwards), upright);
        EXPECT_TRUE(result.facts.crosses_itself) << name << " from " << first;
        for (std::uint32_t k = 0; k < result.triangles.size(); ++k)
          EXPECT_EQ(result.triangles[k], (Facet{0, k + 1, k + 2}));
      }
}

TEST(Polygon, SaysHowFarFromFlatItIs) {
  // One corner of a square of side 2 lifted by h: the plane through the mean cuts the heights to h / 4 for all.
  const std::vector<Vec3> square{{0, 0, 0}, {2, 0, 0}, {2, 2, 0.4}, {0, 2, 0}};
  std::vector<Facet> out(2);
  const PolygonFacts facts = cut_polygon(std::vector<std::uint32_t>{0, 1, 2, 3}, square, out);
  EXPECT_EQ(facts.extent, 2);
  // Its area vector is (-0.4, -0.4, 4) / 2 ..., so 0.1 along z is this much along it.
  EXPECT_NEAR(facts.off_plane, 0.1 * 4 / std::sqrt(16 + 2 * 0.4 * 0.4), 1e-12);
  EXPECT_FALSE(facts.crosses_itself);
}

TEST(Polygon, WithoutAreaIsReadToo) {
  for (const Flat& p : {Flat{{0, 0}, {1, 1}, {2, 2}, {3, 3}}, Flat{{1, 1}, {1, 1}, {1, 1}, {1, 1}, {1, 1}},
                        Flat{{0, 0}, {2, 0}, {1, 0}, {3, 0}, {1, 0}}, Flat{{0, 0}, {1, 0}, {1, 1}, {1, 0}}}) {
    const Cut result = cut(p, upright);
    EXPECT_EQ(result.triangles.size(), p.size() - 2);
    for (const Facet& f : result.triangles) EXPECT_EQ(shoelace({p[f[0]], p[f[1]], p[f[2]]}), 0);
  }
}

namespace {

/// The outline of a random tree of corridors, half a unit wide, between size x size cells: a simple polygon that winds
/// through all of the square, with a corner at every half unit. Cells and corridors are squares of side 1/2.
Flat maze(int size, std::mt19937_64& random) {
  const int side = 2 * size;
  std::vector<char> filled(std::size_t(side * side), 0);
  const auto cell = [&](int x, int y) -> char& { return filled[std::size_t(y * side + x)]; };
  std::vector<std::pair<int, int>> way{{0, 0}};
  cell(0, 0) = 1;
  while (!way.empty()) {
    const auto [x, y] = way.back();
    std::vector<std::pair<int, int>> free;
    for (const auto& [dx, dy] : {std::pair(1, 0), std::pair(-1, 0), std::pair(0, 1), std::pair(0, -1)}) {
      const int u = x + 2 * dx, v = y + 2 * dy;
      if (u >= 0 && v >= 0 && u < side && v < side && !cell(u, v)) free.emplace_back(dx, dy);
    }
    if (free.empty()) {
      way.pop_back();
      continue;
    }
    const auto [dx, dy] = free[random() % free.size()];
    cell(x + dx, y + dy) = cell(x + 2 * dx, y + 2 * dy) = 1;
    way.emplace_back(x + 2 * dx, y + 2 * dy);
  }
  // Follow the boundary, the filled squares to the left.
  const auto is_filled = [&](int x, int y) { return x >= 0 && y >= 0 && x < side && y < side && cell(x, y); };
  Flat p;
  int x = 0, y = 0, dx = 1, dy = 0;
  do {
    p.emplace_back(0.5 * x, 0.5 * y);
    x += dx;
    y += dy;
    // The squares ahead to the left and to the right.
    const auto ahead = [&](int side_x, int side_y) {
      return is_filled(x + (dx + side_x - 1) / 2, y + (dy + side_y - 1) / 2);
    };
    if (ahead(dy, -dx)) {
      std::swap(dx, dy);
      dy = -dy;
    } else if (!ahead(-dy, dx)) {
      std::swap(dx, dy);
      dx = -dx;
    }
  } while (x != 0 || y != 0);
  return p;
}

}  // namespace

TEST(Polygon, RandomMazesAreCovered) {
  const std::uint64_t seed = std::random_device{}();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937_64 random(seed);
  for (int k = 0; k < 6; ++k) {
    const int size = 5 + 4 * k;
    const Flat straight = maze(size, random);
    ASSERT_EQ(shoelace(straight) / 2, 0.25 * (2 * size * size - 1));  // that many squares are filled
    // Sheared by exact numbers, from a random corner.
    Flat p = turned(straight, random() % straight.size(), k % 2);
    for (auto& [x, y] : p) x += 0.375 * y, y += 0.25 * x;
    const Cut result = cut(p, upright);
    EXPECT_FALSE(result.facts.crosses_itself);
    expect_covered(p, result.triangles, "maze of " + std::to_string(size));
  }
}

namespace {

/// A maze some of whose corridors and walls have no width, others one: its outline touches itself in corners and along
/// whole edges, and is walked over and over. The limit of outlines that do not cross themselves.
Flat squeezed_maze(std::mt19937_64& random) {
  const int size = 2 + int(random() % 4);
  Flat p = maze(size, random);
  const unsigned thin = 1 + unsigned(random() % 3);  // of four lines
  std::vector<double> x{0}, y{0};
  for (int i = 0; i < 2 * size; ++i) {
    x.push_back(x.back() + (random() % 4 < thin ? 0 : 1));
    y.push_back(y.back() + (random() % 4 < thin ? 0 : 1));
  }
  for (auto& [u, v] : p) u = x[std::size_t(2 * u)], v = y[std::size_t(2 * v)];
  return turned(p, random() % p.size(), random() % 2);
}

}  // namespace

TEST(Polygon, MazesOfNoWidthAreCovered) {
  std::mt19937_64 random(20220801);
  for (int k = 0; k < 400; ++k) {
    const Flat p = squeezed_maze(random);
    const Cut result = cut(p, upright);
    EXPECT_FALSE(result.facts.crosses_itself) << k;
    expect_covered(p, result.triangles, "squeezed maze " + std::to_string(k));
  }
}

// Whatever the corners: the polygon is covered, or it is named. Half of these wind around some point otherwise than
// once in one direction, which no triangles that turn one way cover.
TEST(Polygon, IsCoveredOrNamedWhateverItIs) {
  const std::uint64_t seed = std::random_device{}();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937_64 random(seed);
  for (int k = 0; k < 1000; ++k) {
    Flat p;
    if (k % 4 == 0) p = squeezed_maze(random);
    const int side = 3 + int(random() % 4);
    for (std::uint64_t left = k % 4 == 0 ? 0 : 4 + random() % 6; left > 0; --left)
      p.emplace_back(random() % side, random() % side);
    const Cut result = cut(p, upright);
    if (!result.facts.crosses_itself) expect_covered(p, result.triangles, std::to_string(k));
  }
}

// The way around a tree without width: everything runs back, nothing is covered.
TEST(Polygon, ATreeWithoutWidthHasNoArea) {
  std::mt19937_64 random(7);
  Flat p = maze(6, random);
  for (auto& [x, y] : p) x = std::floor(x + 0.25), y = std::floor(y + 0.25);  // the walls fall together
  const Cut result = cut(p, upright);
  EXPECT_FALSE(result.facts.crosses_itself);
  double area = 0;
  for (const auto& [a, b, c] : result.triangles) area += std::fabs(shoelace({p[a], p[b], p[c]}));
  EXPECT_EQ(area, 0);
}

TEST(Polygon, AHundredThousandCornersAreWork) {
  Flat p = comb(25000);
  for (auto& [x, y] : p) y += 0.5 * x;  // so that the boxes around its teeth overlap; exact
  ASSERT_EQ(p.size(), 100000u);
  const Cut result = cut(p, upright);
  EXPECT_FALSE(result.facts.crosses_itself);
  double sum = 0;
  for (const auto& [a, b, c] : result.triangles) sum += std::fabs(shoelace({p[a], p[b], p[c]}));
  EXPECT_EQ(sum / 2, 2 * 25000 - 1 + 4 * 25000);
}

namespace {

std::string number(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.17g", x);
  return text;
}

/// One polygon in the plane z = 0.5 as a file of that kind.
std::string file_of(const std::string& kind, const Flat& p) {
  const std::string count = std::to_string(p.size());
  std::string out, indices;
  for (std::size_t i = 0; i < p.size(); ++i) indices += " " + std::to_string(kind == "obj" ? i + 1 : i);
  if (kind == "off") out = "OFF\n" + count + " 1 0\n";
  if (kind == "ply")
    out = "ply\nformat ascii 1.0\nelement vertex " + count +
          "\nproperty double x\nproperty double y\nproperty double z\nelement face 1\nproperty list int int "
          "vertex_indices\nend_header\n";
  for (const auto& [x, y] : p) out += (kind == "obj" ? "v " : "") + number(x) + " " + number(y) + " 0.5\n";
  return out + (kind == "obj" ? "f" : count) + indices + "\n";
}

}  // namespace

TEST(Polygon, OfEveryFormatIsCoveredFromEveryCorner) {
  std::map<std::string, Flat> shapes{{"spiral", spiral(12, 2)}};
  for (const char* name : {"L", "arrow", "comb", "keyhole"}) shapes[name] = kShapes.at(name).first;
  for (const auto& [name, points] : shapes)
    for (std::size_t first = 0; first < points.size(); ++first)
      for (const bool backwards : {false, true})
        for (const char* kind : {"obj", "off", "ply"}) {
          const Flat p = turned(points, first, backwards);
          std::string said = "?";
          const Mesh mesh = geometry::parse_mesh(file_of(kind, p), std::string("a.") + kind, "m", &said);
          EXPECT_EQ(said, "");
          expect_covered(p, mesh.triangles, name + " as " + kind + " from " + std::to_string(first));
        }
}

TEST(Polygon, IsSaidWithItsLineWhenItCrossesItselfOrIsFarFromFlat) {
  const std::string vertices = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 1 1 0.4\nv 1 1 0.8\n";
  std::string said;
  geometry::parse_mesh(vertices + "f 1 2 3 4\nf 1 3 2 4\n", "a.obj", "m", &said);
  EXPECT_EQ(said, "a.obj: 1 polygon crosses itself and is read as a fan from its first corner (line 8)");
  geometry::parse_mesh(vertices + "f 1 2 5 4\n", "a.obj", "m", &said);
  // 0.1 m along z; the area vector is (-0.4, -0.4, 2) / 2.
  EXPECT_EQ(said, "a.obj: 1 polygon is far from flat, line 7, by 0.0962 m, 9.62 % of its size");
  geometry::parse_mesh("f 1 2 5 4\nf 1 2 6 4\nf 1 3 2 4\nf 2 4 1 3\n" + vertices, "a.obj", "m", &said);
  EXPECT_EQ(said,
            "a.obj: 2 polygons cross themselves and are read as fans from their first corners (the first at line 3); 2 "
            "polygons are far from flat, most of all that at line 2 by 0.174 m, 17.4 % of its size");
}
