// kind = "extremes": two bodies at a time, placed at a signed gap around exact touching. A script: nothing is
// integrated.
//
// The first body stands at (offset, offset, offset); the second comes along an axis of the world from outside (where it
// is nested: from the middle of the first outwards) in whole ulps u of the pair: the spacing of doubles at the greatest
// coordinate, offset + 8 scale. All positions are multiples of u, hence exact, also when both bodies are moved by
// powers of two times u. The exact truth is bisected down to one u: at gap 0 the two meet, one ulp farther they do not.
// With both turned at random an axis is as good a direction as any.
#include "pipeline/scene/kinds/extremes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "geometry/decision/meet.hpp"
#include "geometry/meshes/shapes.hpp"
#include "geometry/random.hpp"
#include "pipeline/terminal/error.hpp"
#include "pipeline/terminal/progress.hpp"

namespace pipeline {
namespace {

using geometry::Mesh;
using geometry::Pose;
using geometry::Vec3;

constexpr double kMostRatio = 0x1p40;  // offset over scale: beyond, an ulp is a visible part of the bodies
constexpr double kExtent = 8;          // scales from the first body to the greatest coordinate, when both are moved
constexpr double kThin = 1e-9;         // thickness of needles and slivers, scales
constexpr double kAside = 0.3;         // of coplanar ones across the approach, scales
constexpr std::int64_t kMostOrientations = 1000;
constexpr std::array<std::int64_t, 4> kUlps = {0, 1, 10, 1000};
constexpr int kLeastDecade = -12;  // gaps of 1e-12 to 1 scales
constexpr int kSamples = 128;      // of an approach, before bisection
constexpr int kTries = 64;         // orientations until two bodies meet at all
constexpr Range kScale{.least = 1e-9, .most = 1e9};
constexpr Range kOffset{.least = 0, .most = 1e9};

// ---- Bodies --------------------------------------------------------------------------------------------------------

/// Four corners as a closed mesh.
Mesh tetrahedron(const std::string& name, const char* kind, double scale, const std::array<Vec3, 4>& corners) {
  Mesh mesh;
  mesh.name = name;
  for (const Vec3& corner : corners) mesh.vertices.push_back(scale * corner);
  mesh.triangles = {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}};
  mesh.shape = std::string("{\"kind\":\"") + kind + "\",\"length\":" + real_text(2 * scale) +
               ",\"thickness\":" + real_text(kThin * scale) + "}";
  return mesh;
}

/// The body of that name, about `scale` from its middle to its ends.
Mesh body_mesh(const std::string& shape, const std::string& name, double scale) {
  constexpr double h = kThin / 2;
  if (shape == "sphere") return geometry::sphere(name, scale, 16);
  if (shape == "small_sphere") return geometry::sphere(name, 0.3 * scale, 8);
  if (shape == "box") return geometry::box(name, scale * Vec3(2, 1.6, 1.2));
  if (shape == "small_box") return geometry::box(name, scale * Vec3(0.5, 0.4, 0.3));
  if (shape == "capsule") return geometry::capsule(name, 2 * scale, 0.5 * scale, 0.5 * scale, 8);
  if (shape == "torus") return geometry::torus(name, 1.5 * scale, 0.5 * scale, 16);
  if (shape == "torus_knot") return geometry::torus_knot(name, 0.6 * scale, 0.2 * scale, 32, 32, 2, 3);
  // All faces have two corners next to each other and one far away.
  if (shape == "needle")
    return tetrahedron(name, "needle", scale, {Vec3(-1, -h, -h), Vec3(1, 0, 0), Vec3(-1, h, -h), Vec3(-1, 0, h)});
  // All faces are nearly on a line, a corner between the two others or beside one.
  if (shape == "sliver")
    return tetrahedron(name, "sliver", scale, {Vec3(-1, -h, 0), Vec3(1, -h, 0), Vec3(0, h, -h), Vec3(0, h, h)});
  Mesh sheet;  // two facets in the plane z = 0
  sheet.name = name;
  for (const double y : {-0.8, 0.8})
    for (const double x : {-1.0, 1.0}) sheet.vertices.push_back(scale * Vec3(x, y, 0));
  sheet.triangles = {{0, 1, 3}, {0, 3, 2}};
  sheet.shape = "{\"kind\":\"sheet\",\"size\":[" + real_text(2 * scale) + "," + real_text(1.6 * scale) + "]}";
  return sheet;
}

enum class Placing { free, inside, coplanar };

/// Two shapes and how they come together.
struct PairKind {
  std::string name, a, b;
  Placing placing = Placing::free;
};

const std::vector<PairKind>& pair_kinds() {
  static const std::vector<PairKind> kinds = [] {
    const std::vector<std::string> built_in = {"sphere", "box", "capsule", "torus", "torus_knot"};
    std::vector<PairKind> all;
    for (std::size_t i = 0; i < built_in.size(); ++i)
      for (std::size_t j = i; j < built_in.size(); ++j)
        all.push_back({built_in[i] + "-" + built_in[j], built_in[i], built_in[j]});
    for (const auto& [a, b] :
         {std::pair("sliver", "sliver"), std::pair("sliver", "needle"), std::pair("sliver", "sphere"),
          std::pair("needle", "needle"), std::pair("needle", "box")})
      all.push_back({std::string(a) + "-" + b, a, b});
    all.push_back({"sphere-nested_sphere", "sphere", "small_sphere", Placing::inside});
    all.push_back({"box-nested_box", "box", "small_box", Placing::inside});
    all.push_back({"coplanar_boxes", "box", "box", Placing::coplanar});
    all.push_back({"coplanar_sheets", "sheet", "sheet", Placing::coplanar});
    return all;
  }();
  return kinds;
}

std::vector<std::string> pair_names() {
  std::vector<std::string> names;
  for (const PairKind& kind : pair_kinds()) names.push_back(kind.name);
  return names;
}

const PairKind& pair_kind(const std::string& name) { return *std::ranges::find(pair_kinds(), name, &PairKind::name); }

// ---- Where and how far ---------------------------------------------------------------------------------------------

/// A scale with an offset that goes with it, and the gaps that doubles can tell there.
struct Place {
  double scale, offset, ulp;
  std::vector<std::pair<std::string, std::int64_t>> gaps;  // class and ulps, from deep to apart

  Place(double scale, double offset) : scale(scale), ulp(std::ldexp(1.0, std::ilogb(offset + kExtent * scale) - 52)) {
    this->offset = std::nearbyint(offset / ulp) * ulp;
    for (const int sign : {-1, 1}) {
      std::vector<std::pair<std::string, std::int64_t>> some;
      const std::string mark = sign < 0 ? "-" : "+";
      for (const std::int64_t ulps : kUlps)
        if (ulps != 0 || sign > 0)
          some.push_back({(ulps == 0 ? "" : mark) + std::to_string(ulps) + " ulp", sign * ulps});
      for (int decade = kLeastDecade; decade <= 0; ++decade) {
        const std::string text = decade == 0 ? "1" : "1e" + std::to_string(decade);
        const double ulps = std::nearbyint(std::strtod(text.c_str(), nullptr) * (scale / ulp));
        if (ulps >= 1) some.push_back({mark + text, sign * std::int64_t(ulps)});
      }
      if (sign < 0) std::ranges::reverse(some);
      gaps.insert(gaps.end(), some.begin(), some.end());
    }
  }
};

std::vector<Place> places(const ExtremesScene& scene) {
  std::vector<Place> out;
  for (const double scale : scene.scales)
    for (const double offset : scene.offsets)
      if (offset <= kMostRatio * scale) out.emplace_back(scale, offset);
  return out;
}

/// Calls visit(set number, pair kind, place) for every set, in the order of the steps.
template <class Visit>
void for_each_set(const ExtremesScene& scene, const std::vector<Place>& all, Visit visit) {
  std::uint64_t number = 0;
  for (const std::string& name : scene.pairs)
    for (const Place& place : all)
      for (std::int64_t i = 0; i < scene.orientations; ++i) visit(number++, pair_kind(name), place);
}

// ---- Keys ----------------------------------------------------------------------------------------------------------

void read(const Section& s, SceneConfig& config) {
  s.only({"kind", "pairs", "scales", "offsets", "orientations"});
  ExtremesScene scene;
  scene.pairs = s.choices("pairs", pair_names(), pair_names());
  scene.scales = s.numbers("scales", scene.scales, kScale);
  scene.offsets = s.numbers("offsets", scene.offsets, kOffset);
  scene.orientations = s.integer("orientations", scene.orientations, 1, kMostOrientations);
  s.refuse_twice("pairs", scene.pairs);
  s.refuse_twice("scales", scene.scales);
  s.refuse_twice("offsets", scene.offsets);
  if (places(scene).empty())
    s.refuse("offsets", "hold one of at most 2^40 times a scale", "lower it, or raise 'scene.scales'");
  config.scene = std::move(scene);
}

void write(const SceneConfig& config, TomlText& out) {
  const ExtremesScene& scene = config.keys<ExtremesScene>();
  out.list("pairs", scene.pairs);
  out.list("scales", scene.scales);
  out.list("offsets", scene.offsets);
  out.line("orientations", scene.orientations);
}

// ---- Size and bodies -----------------------------------------------------------------------------------------------

std::int64_t steps(const SceneConfig& config) {
  const ExtremesScene& scene = config.keys<ExtremesScene>();
  std::int64_t out = 0;
  for_each_set(scene, places(scene),
               [&](std::uint64_t, const PairKind&, const Place& place) { out += std::int64_t(place.gaps.size()); });
  return out;
}

/// All bodies: of every shape and scale one for each side of a pair that needs it. Meshes are shared.
struct AllBodies {
  geometry::Bodies bodies;

  AllBodies(const ExtremesScene& scene, const std::vector<Place>& all) {
    for_each_set(scene, all, [&](std::uint64_t, const PairKind& kind, const Place& place) {
      find_or_add('a', kind.a, place.scale);
      find_or_add('b', kind.b, place.scale);
    });
  }

  std::uint32_t find_or_add(char side, const std::string& shape, double scale) {
    const std::string mesh = shape + "_" + real_text(scale), name = std::string(1, side) + "_" + mesh;
    const auto found = std::ranges::find(bodies.name, name) - bodies.name.begin();
    if (found < std::ptrdiff_t(bodies.name.size())) return std::uint32_t(found);
    const auto of = std::ranges::find(bodies.meshes, mesh, &Mesh::name) - bodies.meshes.begin();
    if (of == std::ptrdiff_t(bodies.meshes.size())) bodies.meshes.push_back(body_mesh(shape, mesh, scale));
    bodies.add(name, std::uint32_t(of));
    return std::uint32_t(found);
  }
};

SceneSize size(const SceneConfig& config) {
  const ExtremesScene& scene = config.keys<ExtremesScene>();
  const std::vector<Place> all = places(scene);
  const geometry::Bodies bodies = AllBodies(scene, all).bodies;
  SceneSize size{.bodies = bodies.size(), .meshes = bodies.meshes.size()};
  for (const Mesh& mesh : bodies.meshes) {
    size.mesh_vertices += mesh.vertices.size();
    size.mesh_triangles += mesh.triangles.size();
  }
  for (std::uint32_t body = 0; body < bodies.size(); ++body) size.body_vertices += bodies.mesh_of(body).vertices.size();
  size.pairs = 1;
  std::set<std::pair<std::string, double>> seen;
  for_each_set(scene, all, [&](std::uint64_t, const PairKind& kind, const Place& place) {
    ++size.asked["case_sets"];
    if (!seen.emplace(kind.name, place.scale).second) return;
    const auto mesh = [&](const std::string& shape) {
      return *std::ranges::find(bodies.meshes, shape + "_" + real_text(place.scale), &Mesh::name);
    };
    size.alone.push_back(
        {.meshes = {mesh(kind.a), mesh(kind.b)}, .name = {"a", "b"}, .mesh = {0, 1}, .fixed = {0, 0}, .chosen = {}});
  });
  return size;
}

std::vector<Ahead> ahead(const SceneConfig& config) {
  const ExtremesScene& scene = config.keys<ExtremesScene>();
  std::vector<Ahead> out;
  double step = 0;
  for_each_set(scene, places(scene), [&](std::uint64_t, const PairKind&, const Place& place) {
    step += double(place.gaps.size());
    out.push_back({.what = "sets of gaps", .first = step - 1});
  });
  return out;
}

// ---- Touching ------------------------------------------------------------------------------------------------------

/// The two bodies of a set, the second at any number of ulps along its way.
class Approach {
 public:
  Approach(const Mesh& a, const Mesh& b, const PairKind& kind, const Place& place)
      : kind_(kind), place_(place), bvhs_{geometry::build_bvh(a), geometry::build_bvh(b)} {
    two_.meshes = {a, b};
    two_.name = {"a", "b"};
    two_.mesh = {0, 1};
    two_.fixed = {0, 0};
    double reach = kAside * place.scale;
    for (const Mesh* mesh : {&a, &b}) {
      double square = 0;
      for (const Vec3& v : mesh->vertices) square = std::fmax(square, (v.x() * v.x() + v.y() * v.y()) + v.z() * v.z());
      reach += std::sqrt(square);
    }
    far_ = std::int64_t(1.01 * (reach / place.ulp));
  }

  /// Turns both by the stream and finds where they first touch; false when they never do.
  bool find(geometry::Random random) {
    const auto axis = std::size_t(random.next() % 3);
    const double sign = random.next() % 2 ? 1 : -1;
    a_.q = b_.q = {};
    Vec3 aside = Vec3::Zero();
    along_ = Vec3::Zero();
    if (kind_.placing == Placing::coplanar) {
      // Sheets come within their plane; boxes face to face, beside each other in both directions.
      const bool sheets = kind_.a == "sheet";
      const auto k = sheets ? axis % 2 : axis;
      const double by = std::nearbyint(kAside * place_.scale / place_.ulp) * place_.ulp;
      aside[(k + 1) % (sheets ? 2 : 3)] = by;
      if (!sheets) aside[(k + 2) % 3] = by;
      along_[k] = sign * place_.ulp;
    } else {
      a_.q = random.rotation();
      b_.q = random.rotation();
      along_[axis] = sign * place_.ulp;
    }
    a_.t = Vec3::Constant(place_.offset);
    start_ = a_.t + aside;

    geometry::Decision decision(two_, bvhs_);
    const auto meet = [&](std::int64_t n) { return decision.meet(std::vector<Pose>{a_, b(n)}, {0, 1}); };
    const bool inside = kind_.placing == Placing::inside;
    const std::int64_t begin = inside ? 0 : far_, end = inside ? far_ : -far_;
    outward_ = inside ? -1 : 1;
    std::int64_t no = begin;
    if (meet(no)) return false;
    for (int i = 1; i <= kSamples; ++i) {
      // The middle one is 0: needles that cross meet there and hardly anywhere else.
      std::int64_t yes = i == kSamples / 2 && !inside ? 0 : begin + (end - begin) / kSamples * i;
      if (!meet(yes)) {
        no = yes;
        continue;
      }
      while (std::abs(yes - no) > 1) {
        const std::int64_t middle = no + (yes - no) / 2;
        (meet(middle) ? yes : no) = middle;
      }
      touching_ = yes;
      return true;
    }
    return false;
  }

  const Pose& a() const { return a_; }
  /// `gap` ulps from touching.
  Pose b_at(std::int64_t gap) const { return b(touching_ + outward_ * gap); }
  Vec3 outward() const { return double(outward_) * along_; }

 private:
  Pose b(std::int64_t n) const { return {b_.q, start_ + double(n) * along_}; }

  const PairKind& kind_;
  const Place& place_;
  geometry::Bodies two_;
  std::vector<geometry::Bvh> bvhs_;
  std::int64_t far_ = 0, touching_ = 0, outward_ = 1;
  Pose a_, b_;
  Vec3 start_ = Vec3::Zero(), along_ = Vec3::Zero();
};

Scene make(const SceneConfig& config) {
  const ExtremesScene& extremes = config.keys<ExtremesScene>();
  const std::vector<Place> all = places(extremes);
  AllBodies table(extremes, all);
  Scene scene;
  for_each_set(extremes, all, [&](std::uint64_t number, const PairKind& kind, const Place& place) {
    const std::int64_t left = config.steps - std::int64_t(scene.script.size());
    if (left <= 0) return;
    stop_if_wanted();
    CaseSet set{.first_step = std::int64_t(scene.script.size()),
                .steps = std::min(left, std::int64_t(place.gaps.size())),
                .a = table.find_or_add('a', kind.a, place.scale),
                .b = table.find_or_add('b', kind.b, place.scale)};
    Approach approach(table.bodies.mesh_of(set.a), table.bodies.mesh_of(set.b), kind, place);
    std::uint64_t stream = number * kTries;
    while (!approach.find(geometry::Random::of(std::uint64_t(config.seed), stream)))
      if (++stream == (number + 1) * kTries)
        throw Error(kInput, one_line(config.path.string(), 4096) + ": '" + kind.name + "' at scale " +
                                real_text(place.scale) + " and offset " + real_text(place.offset) +
                                " must meet in one of " + std::to_string(kTries) +
                                " orientations, and does in none; take another seed");
    set.outward = approach.outward();
    const double step = std::ldexp(1.0, std::ilogb(place.scale));
    set.moved = {step, -step, step / 2};
    scene.case_sets.push_back(set);
    for (std::int64_t i = 0; i < set.steps; ++i) {
      const auto& [text, ulps] = place.gaps[std::size_t(i)];
      std::vector<Pose> poses(table.bodies.size(), geometry::unborn());
      poses[set.a] = approach.a();
      poses[set.b] = approach.b_at(ulps);
      scene.script.push_back(std::move(poses));
      scene.cases.push_back({.pair = kind.name,
                             .gap_class = text,
                             .gap = double(ulps) * place.ulp,
                             .gap_ulps = ulps,
                             .ulp = place.ulp,
                             .scale = place.scale,
                             .offset = place.offset,
                             .orientation = stream});
    }
  });
  scene.bodies = std::move(table.bodies);
  return scene;
}

}  // namespace

SceneKind extremes_kind() {
  return {.name = "extremes",
          .what = "pairs of shapes at signed gaps around exact touching, at every scale and offset; scripted",
          .integrated = false,
          .read = read,
          .write = write,
          .size = size,
          .make = make,
          .steps = steps,
          .draws = [](const SceneConfig&) { return true; },  // how the two of every pair lie
          .ahead = ahead};
}

}  // namespace pipeline
