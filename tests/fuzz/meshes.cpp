// Any bytes as a mesh file of each format: refused in one line, or a mesh that everything else can use.
#include <cmath>
#include <string>
#include <vector>

#include "fuzz.hpp"
#include "geometry/bodies.hpp"
#include "geometry/decision/broad_phase.hpp"
#include "geometry/decision/bvh.hpp"
#include "geometry/decision/contain.hpp"
#include "geometry/meshes/mesh_file.hpp"
#include "geometry/meshes/soundness.hpp"

namespace {

void require_usable(const geometry::Mesh& mesh) {
  fuzz::require(!mesh.triangles.empty(), "a mesh has a triangle");
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t corner : triangle) fuzz::require(corner < mesh.vertices.size(), "an index is in range");
  for (const geometry::Vec3& v : mesh.vertices)
    for (int k = 0; k < 3; ++k)
      fuzz::require(std::fabs(v[k]) <= geometry::kGreatestCoordinate, "a coordinate is finite and not too great");
  constexpr std::size_t kMost = 2000;  // triangles: more take long and show nothing else
  if (mesh.triangles.size() > kMost) return;
  geometry::enclosure(mesh);
  geometry::solid_of(mesh, geometry::kClosedWithin);
  const geometry::Bvh bvh = geometry::build_bvh(mesh);
  fuzz::require(bvh.order.size() == mesh.triangles.size(), "a hierarchy holds every triangle");
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  for (const char* file : {"a.obj", "a.off", "a.stl", "a.ply"}) {
    try {
      std::string said;
      require_usable(geometry::parse_mesh(fuzz::text_of(data, size), file, "a", &said));
      if (!said.empty()) fuzz::require_one_line(said);
    } catch (const geometry::MeshFileError& error) {
      fuzz::require_one_line(error.what());
      fuzz::require(std::string_view(error.what()).starts_with(file), "an error names the file");
    }
  }
  // What is looked at before another library reads it.
  for (const std::string file : {"a.gltf", "a.glb", "a.dae", "a.3mf"}) {
    try {
      geometry::refuse_unsound(fuzz::text_of(data, size), file, file.substr(2));
    } catch (const geometry::MeshFileError& error) {
      fuzz::require_one_line(error.what());
      fuzz::require(std::string_view(error.what()).starts_with(file), "an error names the file");
    }
  }
  return 0;
}
