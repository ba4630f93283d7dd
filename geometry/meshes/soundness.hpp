// Files of nodes read once more, before assimp does: it takes much that is broken for something else, without a word (a
// DAE that ends in the middle, a turn of three numbers, a coordinate that is no number), or says it without the place.
// Only what decides where surfaces are is looked at: containers, numbers, counts, units; not materials, normals, bones.
#pragma once
#include <string>
#include <string_view>

namespace geometry {

/// Throws MeshFileError for what is broken in a file of that extension, where it is one of glTF, GLB, DAE and 3MF:
/// "file.gltf:12:5: ...", "file.glb: byte 8: ...", "file.glb: nodes[3].rotation: ...", "file.dae:12: ...",
/// "file.3mf: 3D/3dmodel.model:12: ...".
void refuse_unsound(std::string_view bytes, const std::string& file, std::string_view extension);

}  // namespace geometry
