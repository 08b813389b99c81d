// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Known points, and where pictures show them, as rows of numbers: the files of Tsai's, Heikkila's
// and Zhang's programs, of MyPTV and of surveys. docs/formats.md.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "calvin/core/image.hpp"
#include "calvin/core/result.hpp"
#include "calvin/target/board.hpp"

namespace calvin {

enum class PointField { kSkip, kId, kX, kY, kZ, kDiameter, kNx, kNy, kNz, kU, kV, kSigma };

// A column of numbers; of X, Y, Z or a normal with the sign -1 where the axis points the other way.
struct PointColumn {
  PointField field = PointField::kSkip;
  double sign = 1;
};

struct PointRow {
  std::optional<int> id;
  std::optional<Eigen::Vector3d> point;  // m; z is 0 where there is no such column
  double diameter = 0;                   // m
  std::array<double, 3> normal = {};     // of the surface around it, any length; 0: not told
  std::optional<Pixel> seen;             // px
  std::optional<double> sigma;           // px
};

struct PointRowsFormat {
  std::vector<PointColumn> columns;  // empty: as the file says, or by the count of its numbers
  std::optional<double> unit;        // of points, m; absent: as the file says
};

// "X,Y,Z,u,v", of id X Y Z diameter nx ny nz u v sigma, and _ for a column that does not count; the
// case of X Y Z does not matter. -Z and -nz turn an axis round, as points of a left-handed frame
// need. kInvalidArgument for other words, one that is there twice, and where X without Y, u without
// v or a part of a normal is there, or neither points nor places.
[[nodiscard]] Result<std::vector<PointColumn>> parse_point_columns(std::string_view text);

// Numbers between blanks, tabs, commas or semicolons; `#` begins a comment. A line of words, in a
// comment or not, that are columns gives their order; `unit: mm`, likewise, the unit of points
// (mm, cm, m, in). Without either, 2 numbers are X Y, 3 X Y Z, 4 X Y u v, 5 X Y Z u v, and 8 X Y Z
// u v nx ny nz (Heikkila's). A line may hold several rows: twice, three times
// ... as many numbers as there are columns. kMalformed for all else, and for points without a unit;
// the message names `name` and the line.
[[nodiscard]] Result<std::vector<PointRow>> parse_point_rows(std::string_view content,
                                                             const PointRowsFormat& format,
                                                             std::string_view name = "");

// parse_point_rows() of a file; errors as of read_file().
[[nodiscard]] Result<std::vector<PointRow>> read_point_rows(const std::filesystem::path& path,
                                                            const PointRowsFormat& format = {});

// The rows as a board called `name`: ids are those of the rows, or count them from 0. kMalformed
// for rows without points; errors of PointBoard::make().
[[nodiscard]] Result<Board> board_of_rows(const std::vector<PointRow>& rows, std::string name);

}  // namespace calvin
