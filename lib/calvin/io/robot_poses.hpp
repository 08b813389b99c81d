// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Where the hand of a robot was: a text file with a line for each pose. docs/formats.md.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "calvin/core/calibration.hpp"
#include "calvin/core/result.hpp"

namespace calvin {

struct RobotPose {
  std::string name;            // of the picture; empty where the line has none
  std::optional<double> time;  // as the line has it, s
  Pose base_from_hand;         // what the file holds, be it that or its inverse
};

// Numbers between blanks, tabs, commas or semicolons; `#` begins a comment. A line is
//   x y z qx qy qz qw       a place, m, and a unit quaternion
//   12 or 16 numbers        the rows of [R | t], without or with 0 0 0 1
// with a time in front of it (as in the files of the TUM RGB-D benchmark) or the name of a picture,
// which is no number. A line of words, in a comment or not, that names all of x y z qx qy qz qw
// gives the order of the columns that follow. kMalformed where a line is none of these, a
// quaternion is not of length 1, a matrix is no rotation or a mirrored one, or a name is there
// twice; the message names `name` and the line.
[[nodiscard]] Result<std::vector<RobotPose>> parse_robot_poses(std::string_view content,
                                                               std::string_view name = "");

// parse_robot_poses() of a file; errors as of read_file().
[[nodiscard]] Result<std::vector<RobotPose>> read_robot_poses(const std::filesystem::path& path);

}  // namespace calvin
