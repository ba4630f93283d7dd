#include "pipeline/poses_csv.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <unordered_map>

#include "geometry/mesh_file.hpp"
#include "pipeline/error.hpp"
#include "pipeline/words.hpp"

namespace pipeline {
namespace {

constexpr std::string_view kHeader = "step,body,px,py,pz,qw,qx,qy,qz";
constexpr std::size_t kColumns = 9;
constexpr std::array<const char*, kColumns> kNames = {"step", "body", "px", "py", "pz", "qw", "qx", "qy", "qz"};
constexpr double kNormTolerance = 1e-6;

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r";
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
    first_.assign(bodies.size(), kNone);
    last_.assign(bodies.size(), kNone);
  }

  std::vector<std::vector<geometry::Pose>> read(std::string_view text) {
    if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
    bool header = false;
    while (!text.empty()) {
      const std::size_t end = std::min(text.find('\n'), text.size());
      const std::string_view line = trimmed(text.substr(0, end));
      text.remove_prefix(std::min(end + 1, text.size()));
      ++line_;
      if (line.empty()) continue;
      if (header) {
        read_row(split(line));
      } else {
        read_header(line);
        header = true;
      }
    }
    if (poses_.empty())
      fail(header ? "there is no row below the header" : "is empty; it must begin with " + std::string(kHeader));
    finish_step();
    for (std::size_t b = 0; b < bodies_.size(); ++b)
      if (first_[b] == kNone && bodies_[b].rows != CsvBody::none)
        fail("body " + quoted(names_[b]) + " has no row" +
             (bodies_[b].rows == CsvBody::first_step
                  ? "; a fixed body has one row at step 0, or its position in the configuration"
                  : ""));
    return std::move(poses_);
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
      if (count < kColumns) fields[count] = field(line.substr(0, comma));
      ++count;
      if (comma == line.size()) break;
      line.remove_prefix(comma + 1);
    }
    if (count != kColumns) fail("must have 9 columns, not " + std::to_string(count));
    return fields;
  }

  void read_header(std::string_view line) const {
    const auto refuse = [&] { fail("must be " + std::string(kHeader) + ", not " + quoted(line)); };
    if (std::ranges::count(line, ',') != std::ptrdiff_t(kColumns) - 1) refuse();
    const Fields fields = split(line);
    if (!std::equal(fields.begin(), fields.end(), kNames.begin())) refuse();
  }

  double real(const Fields& fields, std::size_t column) const {
    std::string_view text = fields[column];
    if (text.starts_with('+')) text.remove_prefix(1);
    double value = 0;
    const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    const bool number = error == std::errc() && stop == text.data() + text.size();
    if (!number || !(std::abs(value) <= geometry::kGreatestCoordinate))
      fail(std::string(kNames[column]) + " must be a number between -1e15 and 1e15, not " + quoted(fields[column]));
    return value;
  }

  /// Begins the step of the row when it is a new one.
  void begin_step(std::string_view text) {
    std::uint64_t step = 0;
    const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), step);
    if (error != std::errc() || stop != text.data() + text.size())
      fail("step must be an integer of at least 0, not " + quoted(text));
    const std::uint64_t next = poses_.size();
    if (step + 1 == next) return;
    if (step < next)
      fail("step " + std::to_string(step) + " comes after step " + std::to_string(next - 1) + "; steps do not go back");
    if (step > next)
      fail(next == 0 ? "steps must begin with 0, not " + std::to_string(step)
                     : "step " + std::to_string(step) + " comes after step " + std::to_string(next - 1) +
                           "; no step may be left out");
    if (next > 0) finish_step();
    poses_.emplace_back(bodies_.size(), geometry::unborn());
    for (std::size_t b = 0; next > 0 && b < bodies_.size(); ++b)
      if (bodies_[b].rows == CsvBody::first_step) poses_[next][b] = poses_[0][b];
  }

  /// Every moving body that is born must have had its row.
  void finish_step() const {
    const std::int64_t step = std::int64_t(poses_.size()) - 1;
    for (std::size_t b = 0; b < bodies_.size(); ++b)
      if (bodies_[b].rows == CsvBody::every_step && first_[b] != kNone && last_[b] != step)
        fail("body " + quoted(names_[b]) + " has no row at step " + std::to_string(step) + "; it was born at step " +
             std::to_string(first_[b]) + " and must have one at every step from there");
  }

  void read_row(const Fields& fields) {
    begin_step(fields[0]);
    const std::int64_t step = std::int64_t(poses_.size()) - 1;
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
    if (last_[b] == step) fail("a second row of body " + quoted(name) + " at step " + std::to_string(step));
    if (bodies_[b].rows == CsvBody::first_step && step > 0)
      fail("body " + quoted(name) + " is fixed: it has one row, at step 0");
    if (first_[b] == kNone) first_[b] = step;
    last_[b] = step;

    geometry::Pose& pose = poses_.back()[b];
    pose.t = {real(fields, 2), real(fields, 3), real(fields, 4)};
    const geometry::Quaternion q{real(fields, 5), real(fields, 6), real(fields, 7), real(fields, 8)};
    const double norm = geometry::norm(q);
    if (!(std::abs(norm - 1) <= kNormTolerance))
      fail("the quaternion must be of length 1 within 1e-6, not " + real_text(norm));
    pose.q = geometry::normalised(q);
  }

  static constexpr std::int64_t kNone = -1;

  const std::string& file_;
  const std::vector<CsvBody>& bodies_;
  std::vector<std::string> names_;
  std::unordered_map<std::string, std::size_t> number_;
  std::vector<std::int64_t> first_, last_;  // steps of a body's first and last row so far
  std::size_t line_ = 0;
  std::vector<std::vector<geometry::Pose>> poses_;
};

}  // namespace

std::vector<std::vector<geometry::Pose>> parse_poses(std::string_view text, const std::string& file,
                                                     const std::vector<CsvBody>& bodies) {
  return Reader(file, bodies).read(text);
}

}  // namespace pipeline
