// Which column of a table of poses is what: by the names in its header, never by their order or their values.
#pragma once
#include <array>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace pipeline {

constexpr std::size_t kNoColumn = std::size_t(-1);

/// The columns of a table, by their place in its header.
struct PoseColumns {
  enum class Rotation { quaternion, matrix, euler };

  std::size_t step = kNoColumn, time = kNoColumn, body = kNoColumn;
  double time_unit = 1;          // s
  bool time_unit_named = false;  // else seconds are meant
  std::array<std::size_t, 3> position{};
  double length_unit = 1;  // m
  Rotation rotation = Rotation::quaternion;
  // w x y z; or the nine of a matrix, row by row; or the angles about x, y, z.
  std::array<std::size_t, 9> turn{};
  std::optional<std::array<std::size_t, 4>> last_row;  // of a 4x4 matrix
  double angle_unit = 1;                               // rad
  std::vector<std::string> left_out;
};

/// What such a header says. `fail` throws what is missing, twice there or can be meant in two ways.
PoseColumns pose_columns(const std::vector<std::string_view>& header,
                         const std::function<void(const std::string&)>& fail);

/// The same in words: "time in s, body, position in m (tx, ty, tz), quaternion (qw, qx, qy, qz); left out: vx".
std::string text_of(const PoseColumns& columns, const std::vector<std::string_view>& header);

/// A name of a header without its unit, and the unit: "Shoulder [deg]" or "shoulder_deg". In lower case, with what is
/// neither letter nor digit as '_'.
struct ColumnName {
  std::string name, unit;
};
ColumnName column_name(std::string_view written);

}  // namespace pipeline
