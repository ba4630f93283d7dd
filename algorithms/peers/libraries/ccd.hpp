// What ccd_mpr and ccd_gjk share: libccd asked about the convex hulls of two bodies, by support points of their
// vertices.
#pragma once
#include <ccd/ccd.h>

#include "algorithms/peers/libraries/peer.hpp"

namespace peers {

class Ccd {
 public:
  Ccd(const Bodies& bodies, const collision_value* knobs) : hulls_(bodies.size()) {
    CCD_INIT(&ccd);
    ccd.max_iterations = static_cast<unsigned long>(knobs[0].integer);
    ccd.support1 = ccd.support2 = [](const void* hull, const ccd_vec3_t* way, ccd_vec3_t* out) {
      const Vec3 point = static_cast<const Hull*>(hull)->support({way->v[0], way->v[1], way->v[2]});
      ccdVec3Set(out, point.x(), point.y(), point.z());
    };
    ccd.center1 = ccd.center2 = [](const void* hull, ccd_vec3_t* out) {
      const Vec3 point = static_cast<const Hull*>(hull)->centre();
      ccdVec3Set(out, point.x(), point.y(), point.z());
    };
    for (std::size_t body = 0; body < bodies.size(); ++body) {
      const Mesh& mesh = bodies.mesh_of(std::uint32_t(body));
      hulls_[body].mesh = &mesh;
      for (const Vec3& v : mesh.vertices) hulls_[body].middle += v / double(mesh.vertices.size());
    }
  }

  static double margin(const collision_value*) { return 0; }

  void place(std::uint32_t body, const Pose& pose) {
    hulls_[body].r = geometry::rotation(pose.q);
    hulls_[body].t = pose.t;
  }

 protected:
  struct Hull {
    const Mesh* mesh = nullptr;
    Vec3 middle = Vec3::Zero();  // of the vertices: inside the hull
    geometry::Mat3 r;
    Vec3 t;

    Vec3 support(const Vec3& way) const {
      const Vec3 local = r.transpose() * way;
      const Vec3* best = nullptr;
      double farthest = 0;
      for (const Vec3& v : mesh->vertices) {
        const double along = v.x() * local.x() + v.y() * local.y() + v.z() * local.z();
        if (best && along <= farthest) continue;
        best = &v;
        farthest = along;
      }
      return r * *best + t;
    }
    Vec3 centre() const { return r * middle + t; }
  };

  const Hull* hull(std::uint32_t body) const { return &hulls_[body]; }
  ccd_t ccd;

 private:
  std::vector<Hull> hulls_;
};

/// CCD_INIT leaves 2^64 - 1, which may not end.
inline collision_knob iterations_knob() {
  return {"max_iterations",
          "1",
          "after so many it is no hit; libccd's own default has no end",
          COLLISION_INTEGER,
          {100, 0, nullptr},
          1,
          1e9,
          nullptr};
}

}  // namespace peers
