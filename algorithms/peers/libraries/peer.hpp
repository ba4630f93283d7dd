// What the plug-ins of this folder share: algorithms/plugin.h on the one side, an engine's own test of two bodies on
// the other, the broad phase of `exact` in front of it, and a test of the engine itself before it is believed.
//
// An engine is a class
//
//     Engine(const Bodies& bodies, const collision_value* knobs);  // may throw: what these bodies lack
//     static double margin(const collision_value* knobs);          // m, added to each body by the engine
//     void place(std::uint32_t body, const Pose& pose);            // of a body that is born
//     bool meet(std::uint32_t a, std::uint32_t b);                 // of two that are
//
// and collision_plugin() of the plug-in gives `peers::table<Engine>(row)`, where `row` has what differs: name, what,
// precision, knobs. Each engine is a library and a process of its own: their globals and symbols meet no others.
#pragma once
#include <cstdint>
#include <exception>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "algorithms/plugin.h"
#include "geometry/decision/broad_phase.hpp"

struct collision_method {
  virtual ~collision_method() = default;
  virtual void prepare(const collision_pose* poses) = 0;
  virtual std::uint64_t answer(std::span<const geometry::PairRun> runs, collision_hits& hits) = 0;  // near pairs
};

namespace peers {

using geometry::Bodies;
using geometry::Facet;
using geometry::Mesh;
using geometry::Pose;
using geometry::Vec3;

inline Bodies bodies_of(const collision_bodies& from) {
  Bodies out;
  for (std::uint32_t i = 0; i < from.mesh_count; ++i) {
    const collision_mesh& mesh = from.mesh[i];
    const auto* vertices = reinterpret_cast<const Vec3*>(mesh.vertices);
    const auto* triangles = reinterpret_cast<const Facet*>(mesh.triangles);
    Mesh& one = out.meshes.emplace_back();
    one.name = mesh.name;
    one.vertices.assign(vertices, vertices + mesh.vertex_count);
    one.triangles.assign(triangles, triangles + mesh.triangle_count);
  }
  for (std::uint32_t body = 0; body < from.body_count; ++body)
    out.add(from.name[body], from.body_mesh[body], from.fixed[body]);
  return out;
}

/// Bodies whose boxes hold those of `bodies` and a margin around them: each vertex is pushed outwards along every axis.
inline Bodies grown(Bodies bodies, double margin) {
  if (margin == 0) return bodies;
  for (Mesh& mesh : bodies.meshes) {
    const Vec3 centre = geometry::bounds(mesh.vertices).centre();
    for (Vec3& v : mesh.vertices)
      for (int axis = 0; axis < 3; ++axis) v[axis] += v[axis] < centre[axis] ? -margin : margin;
  }
  return bodies;
}

/// Two bodies of one mesh, tetrahedra as an engine has to know them: the surfaces cross; then only the boxes do.
template <class Engine>
void test_engine(const collision_value* knobs) {
  const double size = 1 + 10 * Engine::margin(knobs);
  Bodies bodies;
  Mesh& mesh = bodies.meshes.emplace_back();
  mesh.name = "tetrahedron";
  mesh.vertices = {{0, 0, 0}, {size, 0, 0}, {0, size, 0}, {0, 0, size}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  bodies.add("here", 0);
  bodies.add("there", 0);
  Engine engine(bodies, knobs);
  engine.place(0, {});
  engine.place(1, {{}, Vec3::Constant(0.2 * size)});
  if (!engine.meet(0, 1))
    throw std::runtime_error("the library's test fails: two tetrahedra that cross are not reported");
  engine.place(1, {{}, Vec3::Constant(0.6 * size)});
  if (engine.meet(0, 1))
    throw std::runtime_error("the library's test fails: two tetrahedra that are apart are reported");
}

template <class Engine>
class Peer final : public collision_method {
 public:
  Peer(const collision_bodies& bodies, const collision_value* knobs)
      : bodies_(bodies_of(bodies)),
        grown_(grown(bodies_, Engine::margin(knobs))),
        engine_((test_engine<Engine>(knobs), bodies_), knobs),
        broad_phase_(grown_) {}

  void prepare(const collision_pose* first) override {
    const std::span poses(reinterpret_cast<const Pose*>(first), bodies_.size());
    broad_phase_.prepare(poses);
    for (std::uint32_t body = 0; body < poses.size(); ++body)
      if (geometry::is_born(poses[body])) engine_.place(body, poses[body]);
  }

  std::uint64_t answer(std::span<const geometry::PairRun> runs, collision_hits& hits) override {
    broad_phase_.pairs(runs, near_);
    for (const geometry::Pair& pair : near_)
      if (engine_.meet(pair.a, pair.b) && collision_hit(&hits, pair.a, pair.b)) throw std::bad_alloc();
    return near_.size();
  }

 private:
  Bodies bodies_, grown_;
  Engine engine_;
  geometry::BroadPhase broad_phase_;
  std::vector<geometry::Pair> near_;
};

/// Calls `work`; 0, or 1 with what it threw.
template <class Work>
int guarded(char* error, Work work) {
  try {
    work();
    return 0;
  } catch (const std::bad_alloc&) {
    return collision_fail(error, "out of memory");
  } catch (const std::exception& failure) {
    return collision_fail(error, failure.what());
  } catch (...) {
    return collision_fail(error, "it threw what is no std::exception");
  }
}

inline int answer(collision_method* method, const collision_run* runs, std::uint64_t run_count, collision_hits* hits,
                  std::uint64_t* operations, char* error) {
  return guarded(error, [&] {
    *operations = method->answer({reinterpret_cast<const geometry::PairRun*>(runs), run_count}, *hits);
  });
}

/// What differs from engine to engine.
struct Row {
  const char *name, *what, *precision;
  std::span<const collision_knob> knobs = {};
};

template <class Engine>
const collision_table* table(const Row& from) {
  static collision_row row = {};
  row.name = from.name;
  row.what = from.what;
  row.precision = from.precision;
  row.knobs = from.knobs.data();
  row.knob_count = from.knobs.size();
  row.unit = "pairs of bodies that the library is asked about";
  row.promise = COLLISION_NONE;
  row.scope = COLLISION_SCENE;
  row.create = [](const collision_bodies* bodies, const collision_value* knobs, char* error) {
    collision_method* made = nullptr;
    guarded(error, [&] { made = new Peer<Engine>(*bodies, knobs); });
    return made;
  };
  row.prepare = [](collision_method* method, const collision_pose* poses, double, char* error) {
    return guarded(error, [&] { method->prepare(poses); });
  };
  row.answer = [](collision_method* method, const collision_run* runs, std::uint64_t run_count, collision_hits* hits,
                  char* error) {
    std::uint64_t operations = 0;
    return answer(method, runs, run_count, hits, &operations, error);
  };
  row.count = answer;
  row.destroy = [](collision_method* method) { delete method; };
  static const collision_row* const rows[] = {&row};
  static const collision_table all = {COLLISION_ABI, 1, rows, PEER_VERSION};
  return &all;
}

/// A margin as a knob: what the engine adds around each body.
inline collision_knob margin_knob(const char* what) {
  return {"margin", "m", what, COLLISION_REAL, {0, 0, nullptr}, 0, 1e6, nullptr};
}

}  // namespace peers
