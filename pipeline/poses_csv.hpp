// Poses from CSV, for replayed scenes: other people's motion (README, "Other people's motion").
//
//   step,body,px,py,pz,qw,qx,qy,qz
//
// Steps count from 0, none is left out and none goes back; bodies come in any order within a step. A moving body is
// born at its first row and has one at every step from there; a fixed body has one row, at step 0. Positions in metres;
// quaternions turn the mesh's frame into the world's, are of unit length within 1e-6 and are normalised here.
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "geometry/pose.hpp"

namespace pipeline {

/// A body as the rows may name it.
struct CsvBody {
  enum Rows { every_step, first_step, none };  // moving; fixed; fixed with its pose in the configuration
  std::string name;
  Rows rows = every_step;
};

/// Poses of every step, S x B: unborn where a body has no row; a fixed body keeps its row's. S is one more than the
/// last step. `text` is the content of `file`, UTF-8 with or without byte order mark; lines end with LF or CR LF; blank
/// ones are skipped. Throws Error(kInput), one line "file:line: ...", for whatever breaks a rule above.
std::vector<std::vector<geometry::Pose>> parse_poses(std::string_view text, const std::string& file,
                                                     const std::vector<CsvBody>& bodies);

}  // namespace pipeline
