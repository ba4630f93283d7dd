// Simbody's triangle meshes without its headers, which are not valid C++20.
#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace peers {

class SimbodyMeshes {
 public:
  SimbodyMeshes();
  ~SimbodyMeshes();

  /// One more mesh: x y z of each vertex and three vertices of each triangle. Throws what Simbody throws.
  void add(const double* vertices, std::size_t vertex_count, const std::uint32_t* triangles,
           std::size_t triangle_count);

  /// Whether two meshes meet at these places: nine of a rotation, row by row, and three of a position.
  bool meet(std::size_t a, const double* rotation_a, const double* position_a, std::size_t b, const double* rotation_b,
            const double* position_b) const;

 private:
  struct Held;
  std::unique_ptr<Held> held_;
};

}  // namespace peers
