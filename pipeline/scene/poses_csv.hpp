// Poses from CSV, for replayed scenes: other people's motion (configs/README.md).
//
//   step,body,px,py,pz,qw,qx,qy,qz
//
// The columns may stand in any order; the header says which. Steps count from 0, none is left out and none goes back;
// bodies come in any order within a step. A moving body is born at its first row and has one at every step from there;
// a fixed body has one row, at step 0. Positions in metres; quaternions turn the mesh's frame into the world's, are of
// unit length within 1e-6 and are normalised here.
//
// What is read takes memory by the row, not by steps times bodies: 20,000 bodies of which one moves for 20,000 steps
// would be 22 GB of poses. Those are made when the run has been found to fit into memory (poses_of).
#pragma once
#include <cstdint>
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

/// Where one body is.
struct CsvTrack {
  std::int64_t first = -1;            // the step of its birth; -1: it has no row
  bool stays = false;                 // its one pose is that of every step
  std::vector<geometry::Pose> poses;  // from `first` on
};

struct CsvMotion {
  std::int64_t steps = 0;        // one more than the last
  std::vector<CsvTrack> tracks;  // one per body
  // Every body's first quaternion has w = 0 exactly. So does the identity in the order x, y, z, w: most likely the
  // columns are in another order than the header says.
  bool begins_with_half_turns = false;
};

/// `text` is the content of `file` (csv.hpp). Throws Error(kInput), one line "file:line: ...", for whatever breaks a
/// rule above.
CsvMotion parse_poses(std::string_view text, const std::string& file, const std::vector<CsvBody>& bodies);

/// Poses of the first steps, S x B: unborn where a body has no row.
std::vector<std::vector<geometry::Pose>> poses_of(const CsvMotion& motion, std::int64_t steps);

}  // namespace pipeline
