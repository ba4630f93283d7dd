#include "pipeline/scene/poses_csv.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <unordered_map>

#include "geometry/meshes/mesh_file.hpp"
#include "geometry/text.hpp"
#include "pipeline/terminal/error.hpp"
#include "pipeline/terminal/words.hpp"

namespace pipeline {
namespace {

constexpr std::string_view kHeader = "step,body,px,py,pz,qw,qx,qy,qz";
constexpr std::size_t kColumns = 9;
constexpr std::array<std::string_view, kColumns> kNames = {"step", "body", "px", "py", "pz", "qw", "qx", "qy", "qz"};
constexpr double kNormTolerance = 1e-6;

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlank = " \t";
  text.remove_prefix(std::min(text.find_first_not_of(kBlank), text.size()));
  text.remove_suffix(text.size() - std::min(text.find_last_not_of(kBlank) + 1, text.size()));
  return text;
}

/// A field without blanks around it and without quotes, which some writers put around every text.
std::string_view field(std::string_view text) {
  text = trimmed(text);
  if (text.size() >= 2 && text.front() == '"' && text.back() == '"') text = text.substr(1, text.size() - 2);
  return text;
}

std::string quoted(std::string_view text) { return in_quotes(one_line(text, 50)); }

class Reader {
 public:
  Reader(const std::string& file, const std::vector<CsvBody>& bodies) : file_(file), bodies_(bodies) {
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      names_.push_back(bodies[b].name);
      number_.emplace(names_.back(), b);
    }
    motion_.tracks.resize(bodies.size());
    motion_.begins_with_half_turns = true;
  }

  CsvMotion read(std::string_view text) {
    if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
    bool header = false;
    while (!text.empty()) {
      const std::string_view line = trimmed(geometry::take_line(text));
      ++line_;
      if (line.empty()) continue;
      if (header) {
        read_row(split(line));
      } else {
        read_header(line);
        header = true;
      }
    }
    if (motion_.steps == 0)
      fail(header ? "there is no row below the header" : "is empty; it must begin with " + std::string(kHeader));
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
  using Fields = std::array<std::string_view, kColumns>;

  [[noreturn]] void fail(const std::string& what) const {
    throw Error(kInput, file_ + ":" + std::to_string(std::max<std::size_t>(line_, 1)) + ": " + what);
  }

  Fields split(std::string_view line) const {
    Fields fields;
    std::size_t count = 0;
    while (true) {
      const std::size_t comma = std::min(line.find(','), line.size());
      if (count < kColumns) fields[column_[count]] = field(line.substr(0, comma));
      ++count;
      if (comma == line.size()) break;
      line.remove_prefix(comma + 1);
    }
    if (count != kColumns) fail("must have 9 columns, not " + std::to_string(count));
    return fields;
  }

  void read_header(std::string_view line) {
    const auto refuse = [&] { fail("must be " + std::string(kHeader) + ", not " + quoted(line)); };
    if (std::ranges::count(line, ',') != std::ptrdiff_t(kColumns) - 1) refuse();
    const Fields fields = split(line);
    if (!std::is_permutation(fields.begin(), fields.end(), kNames.begin())) refuse();
    for (std::size_t i = 0; i < kColumns; ++i)
      column_[i] = std::size_t(std::ranges::find(kNames, fields[i]) - kNames.begin());
  }

  double real(const Fields& fields, std::size_t column) const {
    const std::string_view text = fields[column];
    double value = 0;
    const auto [stop, error] = geometry::nearest_double(text.data(), text.data() + text.size(), value);
    const bool number = error == std::errc() && stop == text.data() + text.size();
    if (!number || !(std::abs(value) <= geometry::kGreatestCoordinate))
      fail(std::string(kNames[column]) + " must be a number between -1e15 and 1e15, not " + quoted(text));
    return value;
  }

  /// Begins the step of the row when it is a new one.
  void begin_step(std::string_view text) {
    std::uint64_t step = 0;
    const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), step);
    if (error != std::errc() || stop != text.data() + text.size())
      fail("step must be an integer of at least 0, not " + quoted(text));
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

  void read_row(const Fields& fields) {
    begin_step(fields[0]);
    const std::int64_t step = motion_.steps - 1;
    const std::string name(fields[1]);
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
    pose.t = {real(fields, 2), real(fields, 3), real(fields, 4)};
    const geometry::Quaternion q{real(fields, 5), real(fields, 6), real(fields, 7), real(fields, 8)};
    const double norm = geometry::norm(q);
    if (!(std::abs(norm - 1) <= kNormTolerance))
      fail("the quaternion must be of length 1 within 1e-6, not " + real_text(norm));
    pose.q = geometry::normalised(q);
    if (first && q.w != 0) motion_.begins_with_half_turns = false;
    track.poses.push_back(pose);
  }

  const std::string& file_;
  const std::vector<CsvBody>& bodies_;
  std::vector<std::string> names_;
  std::unordered_map<std::string, std::size_t> number_;
  std::array<std::size_t, kColumns> column_{0, 1, 2, 3, 4, 5, 6, 7, 8};  // what each column of the file is of kNames
  std::size_t line_ = 0;
  std::size_t rows_ = 0, born_ = 0;  // moving bodies: with a row at this step; with one at any so far
  CsvMotion motion_;
};

}  // namespace

CsvMotion parse_poses(std::string_view text, const std::string& file, const std::vector<CsvBody>& bodies) {
  return Reader(file, bodies).read(text);
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
