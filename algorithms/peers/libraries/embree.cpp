// embree: Intel's ray tracer as a finder of triangles that may meet, which are then decided exactly.
//
// Source  Embree 3.13, rtcCollide on user geometry whose boxes hold the world triangles, refitted where the body moved;
//         the project's own exact test of triangles (geometry/decision/exact.hpp) for each pair that it finds.
// Cost    The broad phase of `exact`; then of each body that is near another all world vertices and its hierarchy
// refitted;
//         per near pair a descent of two hierarchies and the exact tests.
// Misses  Bodies without a common surface point, one inside the other, as `exact` does.
// Extra   Nothing: boxes in single precision, rounded outwards, only choose what is tested.
#include <embree3/rtcore.h>

#include <cmath>

#include "algorithms/peers/libraries/peer.hpp"
#include "geometry/decision/exact.hpp"

namespace peers {
namespace {

class Embree {
 public:
  Embree(const Bodies& bodies, const collision_value*) : device_(rtcNewDevice("threads=1")), bodies_(bodies.size()) {
    if (!device_) throw std::runtime_error("Embree does not start on this processor");
    for (std::uint32_t body = 0; body < bodies.size(); ++body) {
      One& one = bodies_[body];
      one.mesh = &bodies.mesh_of(body);
      one.fixed = bodies.fixed[body];
      one.world = one.mesh->vertices;
      one.scene = rtcNewScene(device_);
      rtcSetSceneFlags(one.scene, RTC_SCENE_FLAG_DYNAMIC | RTC_SCENE_FLAG_ROBUST);
      rtcSetSceneBuildQuality(one.scene, RTC_BUILD_QUALITY_LOW);  // others build anew at every commit
      one.geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_USER);
      rtcSetGeometryUserPrimitiveCount(one.geometry, unsigned(one.mesh->triangles.size()));
      rtcSetGeometryUserData(one.geometry, &one);
      rtcSetGeometryBoundsFunction(one.geometry, box_of, nullptr);
      rtcSetGeometryBuildQuality(one.geometry, RTC_BUILD_QUALITY_REFIT);
      rtcAttachGeometry(one.scene, one.geometry);
      rtcReleaseGeometry(one.geometry);  // the scene holds it
      commit(one);
    }
  }

  ~Embree() {
    for (One& one : bodies_) rtcReleaseScene(one.scene);
    rtcReleaseDevice(device_);
  }

  Embree(const Embree&) = delete;
  Embree& operator=(const Embree&) = delete;

  static double margin(const collision_value*) { return 0; }

  void place(std::uint32_t body, const Pose& pose) {
    One& one = bodies_[body];
    if (!one.fixed) one.placed = false;
    one.pose = pose;
  }

  bool meet(std::uint32_t a, std::uint32_t b) {
    refit(bodies_[a]);
    refit(bodies_[b]);
    Question question{&bodies_[a], &bodies_[b], false};
    rtcCollide(bodies_[a].scene, bodies_[b].scene, decide, &question);
    return question.meet;
  }

 private:
  struct One {
    const Mesh* mesh = nullptr;
    Pose pose;
    bool fixed = false;
    bool placed = false;  // world vertices and scene are of that pose
    std::vector<Vec3> world;
    RTCScene scene = nullptr;
    RTCGeometry geometry = nullptr;  // the scene's

    geometry::Triangle triangle(unsigned int i) const {
      const Facet& facet = mesh->triangles[i];
      return {world[facet[0]], world[facet[1]], world[facet[2]]};
    }
  };
  struct Question {
    const One *a, *b;
    bool meet;
  };

  static float below(double x) { return std::nextafter(float(x), -HUGE_VALF); }
  static float above(double x) { return std::nextafter(float(x), HUGE_VALF); }

  static void box_of(const RTCBoundsFunctionArguments* asked) {
    const One& one = *static_cast<const One*>(asked->geometryUserPtr);
    const geometry::Triangle t = one.triangle(asked->primID);
    const Vec3 low = t[0].cwiseMin(t[1]).cwiseMin(t[2]), high = t[0].cwiseMax(t[1]).cwiseMax(t[2]);
    RTCBounds& out = *asked->bounds_o;
    out.lower_x = below(low.x()), out.lower_y = below(low.y()), out.lower_z = below(low.z());
    out.upper_x = above(high.x()), out.upper_y = above(high.y()), out.upper_z = above(high.z());
  }

  static void decide(void* asked, RTCCollision* found, unsigned int count) {
    Question& question = *static_cast<Question*>(asked);
    for (unsigned int i = 0; i < count && !question.meet; ++i)
      question.meet =
          geometry::triangles_meet(question.a->triangle(found[i].primID0), question.b->triangle(found[i].primID1));
  }

  void refit(One& one) {
    if (one.placed) return;
    geometry::to_world(one.pose, one.mesh->vertices, one.world);
    commit(one);
    one.placed = true;
  }

  void commit(const One& one) {
    rtcCommitGeometry(one.geometry);
    rtcCommitScene(one.scene);
    if (rtcGetDeviceError(device_) != RTC_ERROR_NONE) throw std::runtime_error("Embree cannot build a hierarchy");
  }

  RTCDevice device_;
  std::vector<One> bodies_;
};

}  // namespace
}  // namespace peers

COLLISION_EXPORT const collision_table* collision_plugin() {
  return peers::table<peers::Embree>(
      {.name = "embree",
       .what = "Embree: hierarchies refitted at each step find triangles, decided exactly",
       .precision = "double"});
}
