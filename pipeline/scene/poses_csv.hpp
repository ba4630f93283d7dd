// Poses from tables as other people's programs log them, for replayed scenes (configs/README.md):
//
//   step,body,px,py,pz,qw,qx,qy,qz
//
// The header says which column is what (poses_columns.hpp), in any order. Rows are of steps, which count from 0, none
// of them left out, or of times, which increase: a new one is a new step, and nothing is resampled. Bodies come in any
// order within a step. A moving body is born at its first row and has one at every step from there; a fixed body has
// one row, at step 0. Positions in metres where the header names no other unit. Orientations turn the mesh's frame into
// the world's: unit quaternions, orthonormal matrices, or angles about axes whose order the configuration states.
// Without a header only lines of TUM are read, "time tx ty tz qx qy qz qw", of one body.
//
// What is read takes memory by the row, not by steps times bodies: 20,000 bodies of which one moves for 20,000 steps
// would be 22 GB of poses. Those are made when the run has been found to fit into memory (poses_of).
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/pose.hpp"

namespace pipeline {

/// A body as the rows may name it.
struct CsvBody {
  // Moving; fixed; fixed with its pose in the configuration; moving, with a file of its own.
  enum Rows { every_step, first_step, none, elsewhere };
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
  std::vector<double> times;  // s, of the steps; empty: the file has none
  std::string understood;     // which column is what, in words
  bool plain = false;         // the columns are those above, so that there is nothing to say
};

/// What the configuration says of orientations.
struct CsvRules {
  double tolerance = 1e-6;  // of a quaternion's length, and of a matrix's columns
  std::string euler;        // "xyz": about fixed axes, x first; "XYZ": about the body's own; empty: not stated
};

/// `text` is the content of `file` (csv.hpp). Throws Error(kInput), one line "file:line: ...", for whatever breaks a
/// rule above.
CsvMotion parse_poses(std::string_view text, const std::string& file, const std::vector<CsvBody>& bodies,
                      const CsvRules& rules = {});

/// Puts the tracks of one more file into `motion`, which may be empty. Where both have times, a step's must be nearer
/// to each other than to those of other steps. Throws Error(kInput) naming `file`.
void join(CsvMotion& motion, CsvMotion other, const std::string& file);

/// Steps per second on the mean, where there are times.
std::optional<double> rate_of(const CsvMotion& motion);

/// Poses of the first steps, S x B: unborn where a body has no row.
std::vector<std::vector<geometry::Pose>> poses_of(const CsvMotion& motion, std::int64_t steps);

}  // namespace pipeline
