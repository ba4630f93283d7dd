// Any text as the poses of a replayed scene: refused in one line, or whole tracks of unit quaternions.
#include <cmath>
#include <string>
#include <vector>

#include "fuzz.hpp"
#include "pipeline/scene/poses_csv.hpp"
#include "pipeline/terminal/error.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using pipeline::CsvBody;
  const std::vector<CsvBody> bodies = {{"hero", CsvBody::every_step},
                                       {"drone", CsvBody::every_step},
                                       {"wall", CsvBody::first_step},
                                       {"gate", CsvBody::none}};
  try {
    const pipeline::CsvMotion motion = pipeline::parse_poses(fuzz::text_of(data, size), "poses.csv", bodies);
    fuzz::require(motion.steps >= 1 && motion.tracks.size() == bodies.size(), "there is a step, and a track per body");
    const auto poses = pipeline::poses_of(motion, motion.steps);
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      const pipeline::CsvTrack& track = motion.tracks[b];
      fuzz::require(track.first >= 0 || bodies[b].rows == CsvBody::none || track.poses.empty(), "no birth, no pose");
      for (const geometry::Pose& pose : track.poses) {
        const auto& [w, x, y, z] = pose.q;
        fuzz::require(std::fabs(w * w + x * x + y * y + z * z - 1) < 1e-14, "a quaternion is of unit length");
        fuzz::require(pose.t.allFinite(), "a position is finite");
      }
      for (std::size_t s = 0; s < poses.size(); ++s)
        fuzz::require(geometry::is_born(poses[s][b]) == (track.first >= 0 && std::int64_t(s) >= track.first),
                      "born from its first row on");
    }
  } catch (const pipeline::Error& error) {
    fuzz::require(error.code() == pipeline::kInput, "what the user wrote is code 3");
    fuzz::require_one_line(error.what());
  }
  return 0;
}
