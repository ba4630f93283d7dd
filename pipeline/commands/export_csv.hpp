// A result as files that any engine reads, for methods that cannot run here: meshes as OBJ, bodies and poses as CSV.
//
// Every number is written by the shortest text that reads back as the same double. `pipeline import` takes the answers.
#pragma once
#include <filesystem>
#include <string>

#include "pipeline/result/products/proxies.hpp"
#include "pipeline/result/result.hpp"

namespace pipeline {

/// The files' texts. A mesh's vertices and triangles in their order, triangles counted from 1 as OBJ has it.
std::string obj_text(const geometry::Mesh& mesh);
/// number,body,mesh,fixed,chosen,first_step: one row a body. chosen: 1 where pairs with the body are asked about.
std::string bodies_text(const Result& result);
/// step,body,px,py,pz,qw,qx,qy,qz, as configs/README.md has it for a replay: a row for every body that is there, of a
/// fixed body at step 0 alone.
std::string poses_text(const Result& result);

/// What stands in place of a mesh: solids as they are, one object each; balls, and a capsule, as meshes with their
/// vertices on them, which lie within by up to a hundredth of the radius.
std::string proxy_text(const MeshProxy& row);

struct CsvExportOptions {
  std::filesystem::path folder;  // made when it does not exist
  bool force = false;            // an earlier export is replaced; else a folder with anything in it is refused
};

/// Writes bodies.csv, poses.csv, meshes/<name>.obj and proxies/<label>/<name>.obj into the folder and returns what was
/// written, relative to it. When it fails or is interrupted nothing that it wrote stays. Throws Error: kFile for the
/// folder and a full disk, kInterrupted.
std::vector<std::filesystem::path> write_csv(const Result& result, const CsvExportOptions& options);

}  // namespace pipeline
