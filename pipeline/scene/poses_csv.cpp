#include "pipeline/scene/poses_csv.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <unordered_map>

#include "geometry/meshes/mesh_file.hpp"
#include "pipeline/scene/csv.hpp"
#include "pipeline/terminal/words.hpp"

namespace pipeline {
namespace {

constexpr double kNormTolerance = 1e-6;

class Reader {
 public:
  Reader(std::string_view text, const std::string& file, const std::vector<CsvBody>& bodies)
      : csv_(text, file, {"step", "body", "px", "py", "pz", "qw", "qx", "qy", "qz"}), bodies_(bodies) {
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      names_.push_back(bodies[b].name);
      number_.emplace(names_.back(), b);
    }
    motion_.tracks.resize(bodies.size());
    motion_.begins_with_half_turns = true;
  }

  CsvMotion read() {
    while (csv_.next()) read_row();
    if (motion_.steps == 0) fail("there is no row below the header");
    finish_step();
    for (std::size_t b = 0; b < bodies_.size(); ++b)
      if (!has_row(b) && bodies_[b].rows != CsvBody::none)
        fail("body " + quoted(names_[b]) + " has no row" +
             (bodies_[b].rows == CsvBody::first_step
                  ? "; a fixed body has one row at step 0, or its position in the configuration"
                  : ""));
    return std::move(motion_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { csv_.fail(what); }

  double real(std::size_t column) const {
    return csv_.real(column, geometry::kGreatestCoordinate, "a number between -1e15 and 1e15");
  }

  /// Begins the step of the row when it is a new one.
  void begin_step(std::uint64_t step) {
    const std::uint64_t next = std::uint64_t(motion_.steps);
    if (step + 1 == next) return;
    if (step < next)
      fail("step " + std::to_string(step) + " comes after step " + std::to_string(next - 1) + "; steps do not go back");
    if (step > next)
      fail(next == 0 ? "steps must begin with 0, not " + std::to_string(step)
                     : "step " + std::to_string(step) + " comes after step " + std::to_string(next - 1) +
                           "; no step may be left out");
    if (next > 0) finish_step();
    ++motion_.steps;
    rows_ = 0;
  }

  bool has_row(std::size_t body) const { return motion_.tracks[body].first >= 0; }
  /// The step of its last row; it has one.
  std::int64_t last(std::size_t body) const {
    return motion_.tracks[body].first + std::int64_t(motion_.tracks[body].poses.size()) - 1;
  }

  /// Every moving body that is born must have had its row.
  void finish_step() const {
    if (rows_ == born_) return;
    const std::int64_t step = motion_.steps - 1;
    for (std::size_t b = 0; b < bodies_.size(); ++b)
      if (bodies_[b].rows == CsvBody::every_step && has_row(b) && last(b) != step)
        fail("body " + quoted(names_[b]) + " has no row at step " + std::to_string(step) + "; it was born at step " +
             std::to_string(motion_.tracks[b].first) + " and must have one at every step from there");
  }

  void read_row() {
    begin_step(csv_.integer(0));
    const std::int64_t step = motion_.steps - 1;
    const std::string name(csv_[1]);
    const auto found = number_.find(name);
    if (found == number_.end()) {
      const std::string meant = nearest(name, names_);
      fail("there is no body " + quoted(name) + " in the configuration" +
           (meant.empty() ? "" : "; did you mean " + quoted(meant) + "?"));
    }
    const std::size_t b = found->second;
    if (bodies_[b].rows == CsvBody::none)
      fail("body " + quoted(name) + " is fixed and has its pose in the configuration; remove one of them");
    if (has_row(b) && last(b) == step)
      fail("a second row of body " + quoted(name) + " at step " + std::to_string(step));
    if (bodies_[b].rows == CsvBody::first_step && step > 0)
      fail("body " + quoted(name) + " is fixed: it has one row, at step 0");
    CsvTrack& track = motion_.tracks[b];
    const bool moves = bodies_[b].rows == CsvBody::every_step, first = !has_row(b);
    if (first) {
      track.first = step;
      track.stays = !moves;
      born_ += moves;
    }
    rows_ += moves;

    geometry::Pose pose;
    pose.t = {real(2), real(3), real(4)};
    const geometry::Quaternion q{real(5), real(6), real(7), real(8)};
    const double norm = geometry::norm(q);
    if (!(std::abs(norm - 1) <= kNormTolerance))
      fail("the quaternion must be of length 1 within 1e-6, not " + real_text(norm));
    pose.q = geometry::normalised(q);
    if (first && q.w != 0) motion_.begins_with_half_turns = false;
    track.poses.push_back(pose);
  }

  CsvReader csv_;
  const std::vector<CsvBody>& bodies_;
  std::vector<std::string> names_;
  std::unordered_map<std::string, std::size_t> number_;
  std::size_t rows_ = 0, born_ = 0;  // moving bodies: with a row at this step; with one at any so far
  CsvMotion motion_;
};

}  // namespace

CsvMotion parse_poses(std::string_view text, const std::string& file, const std::vector<CsvBody>& bodies) {
  return Reader(text, file, bodies).read();
}

std::vector<std::vector<geometry::Pose>> poses_of(const CsvMotion& motion, std::int64_t steps) {
  assert(steps <= motion.steps && "no more steps than there are");
  std::vector<std::vector<geometry::Pose>> out(std::size_t(steps),
                                               std::vector(motion.tracks.size(), geometry::unborn()));
  for (std::size_t b = 0; b < motion.tracks.size(); ++b) {
    const CsvTrack& track = motion.tracks[b];
    for (std::int64_t s = std::max<std::int64_t>(track.first, 0); track.first >= 0 && s < steps; ++s)
      out[std::size_t(s)][b] = track.poses[track.stays ? 0 : std::size_t(s - track.first)];
  }
  return out;
}

}  // namespace pipeline
