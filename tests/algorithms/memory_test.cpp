// What a row says its method takes, against what the allocator hands out.
#include <gtest/gtest.h>
#include <malloc.h>

#include <cstdlib>
#include <new>

#include "tests/support/facet_scenes.hpp"

namespace {

// Bytes that operator new has given out, now and at most.
std::int64_t live = 0, most = 0;

void* counted(void* pointer) {
  if (!pointer) throw std::bad_alloc();
  live += static_cast<std::int64_t>(malloc_usable_size(pointer));
  most = std::max(most, live);
  return pointer;
}

void uncounted(void* pointer) {
  live -= static_cast<std::int64_t>(malloc_usable_size(pointer));
  std::free(pointer);
}

}  // namespace

void* operator new(std::size_t size) { return counted(std::malloc(size)); }
void* operator new(std::size_t size, std::align_val_t align) {
  const auto to = static_cast<std::size_t>(align);
  return counted(std::aligned_alloc(to, (size + to - 1) / to * to));
}
void operator delete(void* pointer) noexcept { uncounted(pointer); }
void operator delete(void* pointer, std::size_t) noexcept { uncounted(pointer); }
void operator delete(void* pointer, std::align_val_t) noexcept { uncounted(pointer); }
void operator delete(void* pointer, std::size_t, std::align_val_t) noexcept { uncounted(pointer); }

namespace {

using algorithms::Memory;
using facet_scenes::at;
using facet_scenes::Knobs;
using facet_scenes::Scene;

/// Bodies of two meshes in rows, neighbours `apart` metres from each other.
Scene rows(const geometry::Mesh& one, const geometry::Mesh& other, int count, double apart = 1.5) {
  Scene scene;
  scene.add(one, at(0, 0, 0));
  scene.add(other, at(apart, 0, 0));
  for (int i = 2; i < count; ++i) {
    scene.bodies.add("more" + std::to_string(i), static_cast<std::uint32_t>(i % 2));
    scene.poses.push_back(at(apart * (i % 20), 2.5 * (i / 20), 0));
  }
  return scene;
}

#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define LIBRARIES_ALLOCATE_ELSEWHERE  // its own operator new comes before ours there
#endif
#endif

Memory taken(const std::string& name, const Scene& scene, const Knobs& knobs) {
  const auto runs = geometry::pair_runs(scene.bodies, scene.poses);
  std::vector<algorithms::Pair> hits;
  hits.reserve(1 << 16);  // the caller's, not the method's
  const std::int64_t before = most = live;
  const auto method = algorithms::find(name)->make(scene.bodies, knobs);
  method->prepare(scene.poses);
  method->answer(runs, hits);
  method->remember();
  return {static_cast<std::uint64_t>(live - before), static_cast<std::uint64_t>(most - before)};
}

void expect_near(std::uint64_t said, std::uint64_t real, const std::string& what) {
  EXPECT_LE(double(said), 1.5 * double(real)) << what;
  EXPECT_LE(double(real), 1.5 * double(said)) << what;
}

void expect_true(const std::string& name, const Scene& scene, const Knobs& changes = {}) {
#ifdef LIBRARIES_ALLOCATE_ELSEWHERE
  if (!algorithms::find(name)->library.name.empty()) return;
#endif
  const Knobs knobs = facet_scenes::knobs(name, changes);
  const Memory said = algorithms::memory(*algorithms::find(name), scene.bodies, knobs),
               real = taken(name, scene, knobs);
  expect_near(said.held, real.held, name + " holds");
  expect_near(said.greatest, real.greatest, name + " at most");
}

TEST(Memory, OfEveryRowIsWhatItTakesOfSpheres) {
  const Scene scene = rows(geometry::sphere("a", 1, 20), geometry::sphere("b", 1, 14), 300);
  for (const algorithms::Algorithm& row : algorithms::all()) expect_true(row.name, scene);
}

TEST(Memory, OfEveryRowIsWhatItTakesOfOneFineMesh) {
  const Scene scene = rows(geometry::sphere("a", 1, 48), geometry::box("b", {1, 1, 1}), 2);
  for (const std::string name : {"aabb", "exact", "exact_cold", "facet_distance"}) expect_true(name, scene);
  for (const algorithms::Algorithm& row : algorithms::all())
    if (!row.library.name.empty()) expect_true(row.name, scene);
}

// The knobs that decide how many points there are.
TEST(Memory, FollowsDensityStrideAndTriangles) {
  const Scene scene = rows(geometry::box("a", {1, 2, 3}), geometry::sphere("b", 1, 10), 4, 50);
  expect_true("facet_distance", scene, {{"facets_per_area", 2000.0}});
  expect_true("facet_distance", scene, {{"facets_per_area", 2000.0}, {"search", std::string("exhaustive")}});
  const Scene large = rows(geometry::box("a", {9, 9, 12}), geometry::sphere("b", 1, 24), 2, 50);
  for (const std::string name : {"facet_vectors", "facet_triangles", "facet_rotations"})
    expect_true(name, large, {{"densify", true}, {"stride", std::int64_t{2}}});
  for (const std::string name : {"facet_triangles", "facet_rotations"})
    expect_true(name, large, {{"densify", true}, {"stride", std::int64_t{2}}, {"triangles", std::string("strip")}});
  expect_true("facet_rotations", scene, {{"angle_step", 2.0}});
}

// Said without making it: a mesh that would need billions of facets is refused at once, and one of millions costs
// nothing.
TEST(Memory, OfWhatWouldNotFitIsSaidWithoutMakingIt) {
  const algorithms::Algorithm& row = *algorithms::find("facet_distance");
  const Scene cubes = rows(geometry::box("a", {600, 600, 600}), geometry::box("b", {600, 600, 600}), 2);
  const std::int64_t before = most = live;
  const Memory said = algorithms::memory(row, cubes.bodies, algorithms::presets(row));
  EXPECT_LT(most - before, 1 << 20);
  // 2 bodies of 8 * 6 * 600^2 facets at least, whose points are kept of the mesh, of the body and in a tree.
  EXPECT_GT(said.held, 2 * 8 * 6 * 600 * 600 * std::uint64_t{3 * 24});
  EXPECT_THROW(
      algorithms::memory(row, rows(geometry::box("a", {6e4, 6e4, 6e4}), geometry::box("b", {1, 1, 1}), 2).bodies,
                         algorithms::presets(row)),
      std::invalid_argument);
}

TEST(Memory, WithoutARowsWordIsACopyOfTheMeshes) {
  const Scene scene = rows(geometry::box("a", {1, 1, 1}), geometry::box("b", {1, 1, 1}), 2);
  algorithms::Algorithm row = *algorithms::find("aabb");
  row.memory = nullptr;
  EXPECT_EQ(algorithms::memory(row, scene.bodies, {}).held, 2u * (8 * 24 + 12 * 12));
}

}  // namespace
