#include "pipeline/scene/poses_csv.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <unordered_map>

#include "geometry/meshes/mesh_file.hpp"
#include "pipeline/scene/csv.hpp"
#include "pipeline/scene/poses_columns.hpp"
#include "pipeline/terminal/error.hpp"
#include "pipeline/terminal/print.hpp"
#include "pipeline/terminal/words.hpp"

namespace pipeline {
namespace {

const std::vector<std::string_view> kPlain = {"step", "body", "px", "py", "pz", "qw", "qx", "qy", "qz"};
const std::vector<std::string_view> kTum = {"time", "tx", "ty", "tz", "qx", "qy", "qz", "qw"};

class Reader {
 public:
  Reader(std::string_view text, const std::string& file, const std::vector<CsvBody>& bodies, const CsvRules& rules)
      : csv_(text, file), clock_(csv_), bodies_(bodies), rules_(rules) {
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      names_.push_back(bodies[b].name);
      number_.emplace(names_.back(), b);
      if (bodies[b].rows <= CsvBody::first_step) ++with_rows_;
    }
    motion_.tracks.resize(bodies.size());
    motion_.begins_with_half_turns = true;
    read_header();
  }

  CsvMotion read() {
    while (csv_.next()) read_row();
    if (motion_.steps == 0) fail("there is no row below the header");
    if (headless_ && motion_.begins_with_half_turns)
      fail(
          "the first quaternion has qw = 0, a half turn: lines without a header are time tx ty tz qx qy qz qw; write a "
          "header when they are in another order, or when it is meant so");
    finish_step();
    for (std::size_t b = 0; b < bodies_.size(); ++b)
      if (!has_row(b) && bodies_[b].rows <= CsvBody::first_step)
        fail("body " + quoted(names_[b]) + " has no row" +
             (bodies_[b].rows == CsvBody::first_step
                  ? "; a fixed body has one row at step 0, or its position in the configuration"
                  : ""));
    motion_.times = clock_.times();
    return std::move(motion_);
  }

 private:
  void read_header() {
    headless_ = csv_.header().empty();
    if (headless_) {
      if (csv_.width() != kTum.size())
        fail(
            "has no header; its first line must name the columns, such as step,body,px,py,pz,qw,qx,qy,qz (only lines "
            "of TUM, time tx ty tz qx qy qz qw, need none)");
      csv_.name(kTum);
    }
    const std::vector<std::string_view>& header = csv_.header();
    columns_ = pose_columns(header, [this](const std::string& what) { fail(what); });
    clock_.columns = columns_.when;
    motion_.plain = !headless_ && csv_.separator() == ',' && std::ranges::is_permutation(header, kPlain);
    if (columns_.body == kNoColumn && with_rows_ != 1)
      fail("has no column 'body', though it is of " + std::to_string(with_rows_) +
           " bodies; add it, or give each body a file of its own");
    const bool euler = columns_.rotation == PoseColumns::Rotation::euler;
    if (euler && rules_.euler.empty())
      fail(
          "has angles: state their order, scene.euler = \"xyz\" (about fixed axes, x first) or \"XYZ\" (about the "
          "body's own)");
    motion_.understood = (headless_ ? "lines of TUM: " : "") + text_of(columns_, header);
    if (euler)
      motion_.understood += "; " + rules_.euler + ", about " +
                            (rules_.euler[0] >= 'x' ? "fixed axes" : "the body's own axes") + ", " + rules_.euler[0] +
                            " first";
  }

  [[noreturn]] void fail(const std::string& what) const { csv_.fail(what); }

  double real(std::size_t column) const {
    return csv_.real(column, geometry::kGreatestCoordinate, "a number between -1e15 and 1e15");
  }

  /// Begins the step of the row when it is a new one.
  void begin_step() {
    if (!clock_.begins()) return;
    if (motion_.steps > 0) finish_step();
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

  /// The body of which all rows are where no column names it.
  const std::string& the_only() const {
    return std::ranges::find_if(bodies_, [](const CsvBody& body) { return body.rows <= CsvBody::first_step; })->name;
  }

  void read_row() {
    begin_step();
    const std::int64_t step = motion_.steps - 1;
    const std::string name(columns_.body == kNoColumn ? the_only() : csv_[columns_.body]);
    const auto found = number_.find(name);
    if (found == number_.end()) {
      const std::string meant = nearest(name, names_);
      fail("there is no body " + quoted(name) + " in the configuration" +
           (meant.empty() ? "" : "; did you mean " + quoted(meant) + "?"));
    }
    const std::size_t b = found->second;
    if (bodies_[b].rows == CsvBody::none)
      fail("body " + quoted(name) + " is fixed and has its pose in the configuration; remove one of them");
    if (bodies_[b].rows == CsvBody::elsewhere)
      fail("body " + quoted(name) + " has its poses in a file of its own; remove one of them");
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
    for (int k = 0; k < 3; ++k) pose.t[k] = columns_.length_unit * real(columns_.position[std::size_t(k)]);
    pose.q = geometry::normalised(turn());
    if (first && pose.q.w != 0) motion_.begins_with_half_turns = false;
    track.poses.push_back(pose);
  }

  geometry::Quaternion turn() const {
    const auto& at = columns_.turn;
    switch (columns_.rotation) {
      case PoseColumns::Rotation::matrix:
        return of_matrix();
      case PoseColumns::Rotation::euler: {
        geometry::Quaternion q;
        for (const char axis : rules_.euler) {
          const bool fixed = axis >= 'x';
          const int k = axis - (fixed ? 'x' : 'X');
          const double angle = columns_.angle_unit * real(at[std::size_t(k)]);
          const geometry::Quaternion about = geometry::turn_about(geometry::Vec3::Unit(k), angle);
          q = fixed ? about * q : q * about;
        }
        return q;
      }
      case PoseColumns::Rotation::quaternion:
        break;
    }
    const geometry::Quaternion q{real(at[0]), real(at[1]), real(at[2]), real(at[3])};
    const double norm = geometry::norm(q);
    if (!(std::abs(norm - 1) <= rules_.tolerance))
      fail("the quaternion must be of length 1 within " + tolerance_text() + ", not " + real_text(norm));
    return q;
  }

  geometry::Quaternion of_matrix() const {
    if (columns_.last_row)
      for (std::size_t k = 0; k < 4; ++k)
        if (real((*columns_.last_row)[k]) != (k == 3))
          fail(
              "the last row of the matrix must be 0 0 0 1" +
              std::string(k < 3 ? "; where it holds the position, the matrix is transposed: name its columns so" : ""));
    geometry::Mat3 r;
    for (int k = 0; k < 9; ++k) r(k / 3, k % 3) = real(columns_.turn[std::size_t(k)]);
    for (int a = 0; a < 3; ++a) {
      const double length = r.col(a).norm();
      if (!(std::abs(length - 1) <= rules_.tolerance))
        fail("column " + std::to_string(a) + " of the matrix must be of length 1 within " + tolerance_text() +
             ", not " + real_text(length) + "; a scale belongs to the body: scale");
      if (const double cosine = r.col(a).dot(r.col((a + 1) % 3)); !(std::abs(cosine) <= rules_.tolerance))
        fail("columns " + std::to_string(a) + " and " + std::to_string((a + 1) % 3) +
             " of the matrix must be at right angles within " + tolerance_text() + ", not " + real_text(cosine) +
             " off");
    }
    if (r.determinant() < 0) fail("the matrix mirrors; a body can only be turned");
    const Eigen::Quaterniond q(r);
    return {q.w(), q.x(), q.y(), q.z()};
  }

  std::string tolerance_text() const { return real_text(rules_.tolerance); }

  CsvReader csv_;
  StepClock clock_;
  PoseColumns columns_;
  bool headless_ = false;
  const std::vector<CsvBody>& bodies_;
  const CsvRules& rules_;
  std::vector<std::string> names_;
  std::unordered_map<std::string, std::size_t> number_;
  std::size_t with_rows_ = 0;        // bodies that have rows here
  std::size_t rows_ = 0, born_ = 0;  // moving bodies: with a row at this step; with one at any so far
  CsvMotion motion_;
};

}  // namespace

CsvMotion parse_poses(std::string_view text, const std::string& file, const std::vector<CsvBody>& bodies,
                      const CsvRules& rules) {
  return Reader(text, file, bodies, rules).read();
}

void join(CsvMotion& motion, CsvMotion other, const std::string& file) {
  const auto fail = [&](const std::string& what) { throw Error(kInput, file + ": " + what); };
  if (motion.steps == 0) {
    motion.steps = other.steps;
    motion.begins_with_half_turns = other.begins_with_half_turns;
  }
  if (motion.steps != other.steps)
    fail("has " + std::to_string(other.steps) + " steps, the poses before it " + std::to_string(motion.steps) +
         "; files of one scene have the same");
  if (motion.times.empty()) motion.times = other.times;
  for (std::size_t s = 0; s < other.times.size(); ++s) {
    const double apart = std::abs(other.times[s] - motion.times[s]);
    const auto near = [&](const std::vector<double>& times) {
      return (s == 0 || apart < (times[s] - times[s - 1]) / 2) &&
             (s + 1 == times.size() || apart < (times[s + 1] - times[s]) / 2);
    };
    if (apart > 0 && !(near(motion.times) && near(other.times)))
      fail("step " + std::to_string(s) + " is at " + real_text(other.times[s]) + " s, in the poses before it at " +
           real_text(motion.times[s]) + " s; files of one scene are sampled together");
  }
  motion.begins_with_half_turns &= other.begins_with_half_turns;
  motion.tracks.resize(std::max(motion.tracks.size(), other.tracks.size()));
  for (std::size_t b = 0; b < other.tracks.size(); ++b)
    if (other.tracks[b].first >= 0) motion.tracks[b] = std::move(other.tracks[b]);
}

std::optional<double> rate_of(const CsvMotion& motion) {
  if (motion.times.size() < 2) return std::nullopt;
  return double(motion.times.size() - 1) / (motion.times.back() - motion.times.front());
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
