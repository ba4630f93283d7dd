#include "pipeline/scene/poses_columns.hpp"

#include <algorithm>
#include <map>
#include <numbers>

#include "pipeline/scene/csv.hpp"

namespace pipeline {
namespace {

using Fail = std::function<void(const std::string&)>;

// Before the letter of the component: what loggers of engines, ROS, Blender and EuRoC write.
constexpr std::string_view kPosition[] = {
    "", "p", "t", "pos", "p_", "t_", "pos_", "position_", "translation_", "location_", "pose_position_", "p_rs_r_"};
constexpr std::string_view kQuaternion[] = {
    "q", "q_", "quat_", "quaternion_", "rot_", "rotation_", "orientation_", "pose_orientation_", "q_rs_"};
constexpr std::string_view kAngle[] = {"r", "euler_", "angle_"};
const std::map<std::string, double, std::less<>> kTimes = {{"s", 1}, {"ms", 1e-3}, {"us", 1e-6}, {"ns", 1e-9}};
const std::map<std::string, double, std::less<>> kLengths = {{"m", 1}, {"cm", 1e-2}, {"mm", 1e-3}};
const std::map<std::string, double, std::less<>> kAngles = {{"rad", 1}, {"deg", std::numbers::pi / 180}};

/// The component of a name that is a prefix and one of `letters`, or npos.
template <std::size_t N>
std::size_t component(std::string_view name, const std::string_view (&prefixes)[N], std::string_view letters) {
  if (name.empty() || std::ranges::find(prefixes, name.substr(0, name.size() - 1)) == std::end(prefixes))
    return letters.npos;
  return letters.find(name.back());
}

/// What is known of a header while it is read.
class Finder {
 public:
  Finder(const std::vector<std::string_view>& header, const Fail& fail) : header_(header), fail_(fail) {}

  PoseColumns found() {
    for (std::size_t i = 0; i < header_.size(); ++i) sort(i, column_name(header_[i]));
    if (!out_.when.any()) fail_("has neither a column 'step' nor 'time'" + names());
    place_rotation();
    place_position();
    return out_;
  }

 private:
  void sort(std::size_t i, const ColumnName& column) {
    const std::string& name = column.name;
    if (when_column(header_[i], i, out_.when, fail_)) return;
    if (name == "body" || name == "name" || name == "object") return one(out_.body, i);
    if (name == "roll" || name == "pitch" || name == "yaw")
      fail_(quoted(header_[i]) + " does not say about which axis it turns; name it rx, ry or rz, with its unit");
    if (name.size() == 2 && name[0] == 'q' && name[1] >= '0' && name[1] <= '4')
      fail_(quoted(header_[i]) + " does not say whether the scalar is first or last; name the four qw, qx, qy, qz");
    if (const auto k = component(name, kAngle, "xyz"); k != name.npos) {
      angles_.resize(3, kNoColumn);
      one(angles_[k], i);
      if (column.unit.empty()) fail_(quoted(header_[i]) + " does not say its unit; write rx_deg or rx_rad");
      return unit(i, column.unit, kAngles, out_.angle_unit, &angle_unit_);
    }
    if (const auto k = component(name, kQuaternion, "wxyz"); k != name.npos) {
      quaternion_.resize(4, kNoColumn);
      return one(quaternion_[k], i);
    }
    if (const auto k = component(name, kPosition, "xyz"); k != name.npos) {
      position_.resize(3, kNoColumn);
      one(position_[k], i);
      return unit(i, column.unit, kLengths, out_.length_unit, &length_unit_);
    }
    if (entry(name)) {
      const std::pair at{name[name.size() - 2 - (name.size() == 5)] - '0', name.back() - '0'};
      return one(matrix_.try_emplace(at, kNoColumn).first->second, i);
    }
    out_.left_out.emplace_back(header_[i]);
  }

  /// m00, m_00, m_0_0, r00: a place of a matrix.
  static bool entry(std::string_view name) {
    if (name.empty() || (name[0] != 'm' && name[0] != 'r')) return false;
    std::string digits;
    for (const char c : name.substr(1))
      if (c != '_') digits += c;
    return digits.size() == 2 && std::ranges::all_of(digits, [](char c) { return c >= '0' && c <= '4'; }) &&
           (name.size() == 3 || (name.size() == 4 && name[1] == '_') ||
            (name.size() == 5 && name[1] == '_' && name[3] == '_'));
  }

  void one(std::size_t& place, std::size_t column) {
    if (place != kNoColumn)
      fail_(quoted(header_[place]) + " and " + quoted(header_[column]) + " can be the same; leave one out");
    place = column;
  }

  void unit(std::size_t i, const std::string& text, const std::map<std::string, double, std::less<>>& known,
            double& value, std::optional<std::string>* same = nullptr) {
    if (same && *same && **same != text) fail_(quoted(header_[i]) + " has another unit than the columns beside it");
    if (same) *same = text;
    if (text.empty()) return;
    const auto found = known.find(text);
    std::string list;
    for (const auto& [name, factor] : known) list += (list.empty() ? "" : ", ") + name;
    if (found == known.end()) fail_("the unit of " + quoted(header_[i]) + " must be one of " + list);
    value = found->second;
  }

  void whole(const std::vector<std::size_t>& places, const char* what, std::string_view letters) {
    for (std::size_t k = 0; k < places.size(); ++k)
      if (places[k] == kNoColumn) fail_(std::string("the ") + what + " has no column for " + letters[k] + names());
  }

  void place_rotation() {
    const int kinds = !quaternion_.empty() + !matrix_.empty() + !angles_.empty();
    if (kinds == 0)
      fail_("has no orientation: columns qw, qx, qy, qz, or m00 to m23, or rx_deg, ry_deg, rz_deg" + names());
    if (kinds > 1)
      fail_("has the orientation in more than one way (quaternion, matrix, angles); leave all but one out");
    whole(quaternion_, "quaternion", "wxyz");
    whole(angles_, "orientation by angles", "xyz");
    if (!quaternion_.empty()) {
      std::ranges::copy(quaternion_, out_.turn.begin());
    } else if (!angles_.empty()) {
      out_.rotation = PoseColumns::Rotation::euler;
      std::ranges::copy(angles_, out_.turn.begin());
    } else {
      place_matrix();
    }
  }

  /// Rows and columns counted from 0 or from 1: nine of a rotation, twelve with the position, sixteen with the last
  /// row.
  void place_matrix() {
    out_.rotation = PoseColumns::Rotation::matrix;
    int first = 4, rows = 0, columns = 0;
    for (const auto& [at, column] : matrix_) {
      first = std::min({first, at.first, at.second});
      rows = std::max(rows, at.first + 1);
      columns = std::max(columns, at.second + 1);
    }
    if (first > 1) first = 1;
    rows -= first;
    columns -= first;
    const bool fits = (rows == 3 && (columns == 3 || columns == 4)) || (rows == 4 && columns == 4);
    if (!fits || int(matrix_.size()) != rows * columns)
      fail_("the matrix must be 3x3, 3x4 or 4x4, whole: m00 to m22, m23 or m33" + names());
    const auto at = [&](int r, int c) { return matrix_.at({r + first, c + first}); };
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) out_.turn[std::size_t(3 * r + c)] = at(r, c);
    if (columns < 4) return;
    if (!position_.empty())
      fail_("has the position in more than one way (matrix and " + quoted(header_[some(position_)]) +
            "); leave one out");
    position_ = {at(0, 3), at(1, 3), at(2, 3)};
    if (rows == 4) out_.last_row = {at(3, 0), at(3, 1), at(3, 2), at(3, 3)};
  }

  void place_position() {
    if (position_.empty()) fail_("has no position: columns px, py, pz" + names());
    whole(position_, "position", "xyz");
    std::ranges::copy(position_, out_.position.begin());
  }

  std::size_t some(const std::vector<std::size_t>& places) const {
    return *std::ranges::find_if(places, [](std::size_t place) { return place != kNoColumn; });
  }

  std::string names() const {
    std::string out;
    for (const std::string_view name : header_) out += (out.empty() ? "" : ",") + std::string(name);
    return "; its columns are " + quoted(out);
  }

  const std::vector<std::string_view>& header_;
  const Fail& fail_;
  PoseColumns out_;
  std::vector<std::size_t> position_, quaternion_, angles_;  // empty: none of them is there
  std::map<std::pair<int, int>, std::size_t> matrix_;        // the column, by row and column as written
  std::optional<std::string> length_unit_, angle_unit_;
};

std::string unit_text(const std::map<std::string, double, std::less<>>& known, double value) {
  for (const auto& [name, factor] : known)
    if (factor == value) return name;
  return "";
}

}  // namespace

ColumnName column_name(std::string_view written) {
  ColumnName out;
  std::string name;
  for (const char c : written) {
    const bool upper = c >= 'A' && c <= 'Z';
    name += upper ? char(c - 'A' + 'a') : c;
  }
  if (const std::size_t open = name.find_first_of("[(");
      open != name.npos && (name.back() == ']' || name.back() == ')')) {
    out.unit = name.substr(open + 1, name.size() - open - 2);
    name.resize(open);
  }
  for (const char c : name) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9');
    if (plain)
      out.name += c;
    else if (!out.name.empty() && out.name.back() != '_')
      out.name += '_';
  }
  if (out.name.ends_with('_')) out.name.pop_back();
  if (out.unit.empty())
    for (const std::string_view unit : {"_ns", "_us", "_ms", "_s", "_deg", "_rad", "_mm", "_cm", "_m"})
      if (out.name.size() > unit.size() && out.name.ends_with(unit)) {
        out.unit = unit.substr(1);
        out.name.resize(out.name.size() - unit.size());
        break;
      }
  return out;
}

bool when_column(std::string_view written, std::size_t i, WhenColumns& when, const Fail& fail) {
  const auto [name, unit] = column_name(written);
  const bool step = name == "step" || name == "frame";
  if (!step && name != "time" && name != "timestamp") return false;
  std::size_t& place = step ? when.step : when.time;
  if (place != kNoColumn) fail("a second column, " + quoted(written) + ", is of the " + (step ? "step" : "time"));
  place = i;
  if (step || unit.empty()) return true;
  if (const auto found = kTimes.find(unit); found != kTimes.end())
    when.time_unit = found->second;
  else
    fail("the unit of " + quoted(written) + " must be one of ms, ns, s, us");
  when.time_unit_named = true;
  return true;
}

PoseColumns pose_columns(const std::vector<std::string_view>& header, const Fail& fail) {
  return Finder(header, fail).found();
}

std::string text_of(const PoseColumns& columns, const std::vector<std::string_view>& header) {
  const auto named = [&](const auto& places, std::size_t count) {
    std::string out;
    for (std::size_t k = 0; k < count; ++k) out += (k ? ", " : " (") + std::string(header[places[k]]);
    return out + ")";
  };
  std::string out;
  if (columns.when.step != kNoColumn) out += "step";
  if (columns.when.time != kNoColumn)
    out += (out.empty() ? "" : ", ") + std::string("time in ") + unit_text(kTimes, columns.when.time_unit);
  if (columns.body != kNoColumn) out += ", body";
  out += ", position in " + unit_text(kLengths, columns.length_unit) + named(columns.position, 3);
  switch (columns.rotation) {
    case PoseColumns::Rotation::quaternion:
      out += ", quaternion w x y z" + named(columns.turn, 4);
      break;
    case PoseColumns::Rotation::matrix:
      out += std::string(", rotation as a matrix") + (columns.last_row ? " of 4x4" : "") + ", row by row" +
             named(columns.turn, 9);
      break;
    case PoseColumns::Rotation::euler:
      out += ", angles in " + unit_text(kAngles, columns.angle_unit) + named(columns.turn, 3);
  }
  for (std::size_t i = 0; i < columns.left_out.size(); ++i) out += (i ? ", " : "; left out: ") + columns.left_out[i];
  return out;
}

}  // namespace pipeline
