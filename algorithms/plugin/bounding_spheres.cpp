// bounding_spheres_cpp: bounding_spheres.c in C++17. A class does the work, the functions of the table call it and let
// no exception out.
//
//     c++ -std=c++17 -O3 -fPIC -shared -fvisibility=hidden -ffp-contract=off -I algorithms
//         algorithms/plugin/bounding_spheres.cpp -Wl,--exclude-libs,ALL -o libbounding_spheres_cpp.so
//
// --exclude-libs keeps the symbols of static libraries (-static-libstdc++, an engine) from being mixed up with others.
#include <cmath>
#include <cstdint>
#include <cstring>
#include <exception>
#include <new>
#include <vector>

#include "plugin.h"

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define PROCESSOR_CLONES __attribute__((target_clones("avx2", "default")))
#else
#define PROCESSOR_CLONES
#endif

namespace {

/// hit[i] for the pairs (a, first + i), by squares; false when one came so close that only the square root may decide.
PROCESSOR_CLONES bool overlap_run(const double* x, const double* y, const double* z, const double* r, std::uint32_t a,
                                  std::uint32_t first, std::uint32_t last, std::uint8_t* hit) {
  const double ax = x[a], ay = y[a], az = z[a], ar = r[a];
  std::uint8_t doubt = 0;
  for (std::uint32_t b = first; b < last; ++b) {
    const double dx = ax - x[b], dy = ay - y[b], dz = az - z[b], reach = ar + r[b];
    const double square = dx * dx + dy * dy + dz * dz, reach_square = reach * reach;
    hit[b - first] = square < reach_square;
    doubt |= std::fabs(square - reach_square) <= reach_square * 0x1p-50 + 1e-290;
  }
  return !doubt;
}

void report(collision_hits* hits, std::uint32_t a, std::uint32_t b) {
  if (collision_hit(hits, a, b) != 0) throw std::bad_alloc();
}

}  // namespace

struct collision_method {
  collision_method(const collision_bodies& bodies, double scale) {
    for (std::uint32_t body = 0; body < bodies.body_count; ++body) {
      const collision_mesh& mesh = bodies.mesh[bodies.body_mesh[body]];
      double half[3] = {};
      for (std::uint64_t i = 0; i < 3 * mesh.vertex_count; ++i)
        half[i % 3] = std::fmax(half[i % 3], std::fabs(mesh.vertices[i]));
      radius.push_back(scale * std::sqrt(half[0] * half[0] + half[1] * half[1] + half[2] * half[2]));
    }
    x = y = z = r = radius;
    hit.resize(radius.size() + 8);
  }

  void prepare(const collision_pose* poses, double enlarge) {
    for (std::size_t body = 0; body < radius.size(); ++body) {
      const double* t = poses[body].position;
      x[body] = t[0];
      y[body] = t[1];
      z[body] = t[2];
      r[body] = radius[body];
      if (enlarge > 0) r[body] += enlarge * (radius[body] + std::sqrt(t[0] * t[0] + t[1] * t[1] + t[2] * t[2]));
    }
  }

  /// The definition.
  bool overlap(std::uint32_t a, std::uint32_t b) const {
    const double dx = x[a] - x[b], dy = y[a] - y[b], dz = z[a] - z[b];
    return r[a] + r[b] > std::sqrt(dx * dx + dy * dy + dz * dz);
  }

  void answer(collision_run run, collision_hits* hits) {
    const std::uint32_t size = run.last - run.first;
    if (!overlap_run(x.data(), y.data(), z.data(), r.data(), run.a, run.first, run.last, hit.data()))
      for (std::uint32_t k = 0; k < size; ++k) hit[k] = overlap(run.a, run.first + k);
    std::memset(hit.data() + size, 0, 8);
    for (std::uint32_t k = 0; k < size; k += 8) {  // hits are rare: eight answers are skipped at once
      std::uint64_t eight;
      std::memcpy(&eight, hit.data() + k, 8);
      if (eight == 0) continue;
      for (std::uint32_t j = k; j < k + 8; ++j)
        if (hit[j]) report(hits, run.a, run.first + j);
    }
  }

  std::vector<double> radius, x, y, z, r;  // m; `radius` is not enlarged
  std::vector<std::uint8_t> hit;           // of one run, and 8 bytes more
};

namespace {

/// What the table promises: 0, or 1 and a text.
template <class Work>
int guarded(char* error, Work work) {
  try {
    work();
    return 0;
  } catch (const std::exception& failure) {
    return collision_fail(error, failure.what());
  } catch (...) {
    return collision_fail(error, "an exception that is no std::exception");
  }
}

const collision_row& spheres() {
  static const collision_knob knob = {
      "scale", "1", "balls are so many times as large", COLLISION_REAL, {0, 1, nullptr}, 1, 1000, nullptr};
  static const collision_row row = [] {
    collision_row row = {};
    row.name = "bounding_spheres_cpp";
    row.what = "balls of the half diagonal about the bodies' positions overlap";
    row.unit = "distances";
    row.precision = "double";
    row.promise = COLLISION_CONSERVATIVE;
    row.scope = COLLISION_PAIR;
    row.knobs = &knob;
    row.knob_count = 1;
    row.create = [](const collision_bodies* bodies, const collision_value* knobs, char* error) {
      collision_method* made = nullptr;
      guarded(error, [&] { made = new collision_method(*bodies, knobs[0].real); });
      return made;
    };
    row.prepare = [](collision_method* method, const collision_pose* poses, double enlarge, char* error) {
      return guarded(error, [&] { method->prepare(poses, enlarge); });
    };
    row.answer = [](collision_method* method, const collision_run* runs, std::uint64_t run_count, collision_hits* hits,
                    char* error) {
      return guarded(error, [&] {
        for (std::uint64_t i = 0; i < run_count; ++i) method->answer(runs[i], hits);
      });
    };
    row.count = [](collision_method* method, const collision_run* runs, std::uint64_t run_count, collision_hits* hits,
                   std::uint64_t* operations, char* error) {
      return guarded(error, [&] {
        for (std::uint64_t i = 0; i < run_count; ++i)
          for (std::uint32_t b = runs[i].first; b < runs[i].last; ++b) {
            ++*operations;
            if (method->overlap(runs[i].a, b)) report(hits, runs[i].a, b);
          }
      });
    };
    row.destroy = [](collision_method* method) { delete method; };
    return row;
  }();
  return row;
}

}  // namespace

COLLISION_EXPORT const collision_table* collision_plugin() {
  static const collision_row* const rows[] = {&spheres()};
  static const collision_table table = {COLLISION_ABI, 1, rows, "1"};
  return &table;
}
