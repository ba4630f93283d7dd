// Which column of a table of poses is what: by the names in its header, never by their order or their values.
#pragma once
#include <array>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/scene/step_clock.hpp"

namespace pipeline {

/// The columns of a table, by their place in its header.
struct PoseColumns {
  enum class Rotation { quaternion, matrix, euler };

  WhenColumns when;
  std::size_t body = kNoColumn;
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

/// Whether the header's column `i`, so written, is of steps or times; then it is put there.
bool when_column(std::string_view written, std::size_t i, WhenColumns& when,
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
