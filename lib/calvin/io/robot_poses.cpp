// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Reads the poses of a robot line by line.

#include "calvin/io/robot_poses.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <set>
#include <span>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "calvin/core/file.hpp"
#include "calvin/core/text.hpp"
#include "calvin/core/utf8.hpp"
#include "calvin/geometry/se3.hpp"
#include "calvin/io/file_text.hpp"

namespace calvin {

namespace {

constexpr double kRounding = 0.01;           // of the length of a quaternion, the entries of R^T R
constexpr double kLargestTranslation = 1e6;  // m

enum class Column { kX, kY, kZ, kQx, kQy, kQz, kQw, kTime, kName, kOther };
constexpr std::size_t kPoseColumns = 7;  // those of a place and a quaternion come first

struct ColumnName {
  std::string_view text;
  Column column;
};
constexpr ColumnName kColumnNames[] = {
    {"x", Column::kX},
    {"tx", Column::kX},
    {"y", Column::kY},
    {"ty", Column::kY},
    {"z", Column::kZ},
    {"tz", Column::kZ},
    {"qx", Column::kQx},
    {"qy", Column::kQy},
    {"qz", Column::kQz},
    {"qw", Column::kQw},
    {"timestamp", Column::kTime},
    {"time", Column::kTime},
    {"name", Column::kName},
    {"image", Column::kName},
    {"file", Column::kName},
    {"filename", Column::kName},
    {"picture", Column::kName},
};

Column column_of(std::string_view word) {
  for (const ColumnName& known : kColumnNames) {
    if (known.text == word) return known.column;
  }
  return Column::kOther;
}

// The columns that a line of words names; empty where a part of a pose is missing or there twice.
std::vector<Column> columns_of(const std::vector<std::string_view>& words) {
  std::vector<Column> columns;
  for (const std::string_view word : words) columns.push_back(column_of(word));
  for (std::size_t part = 0; part < kPoseColumns; ++part) {
    if (std::ranges::count(columns, static_cast<Column>(part)) != 1) return {};
  }
  return columns;
}

Result<SE3> from_quaternion(std::span<const double> at) {
  const Eigen::Quaterniond q(at[6], at[3], at[4], at[5]);
  if (!(std::abs(q.norm() - 1) <= kRounding)) {
    return make_error(
        ErrorCode::kMalformed,
        fmt::format("has a quaternion of length {:.4g}, where a rotation has 1; the order is x y z "
                    "qx qy qz qw, and a line '# x y z qw qx qy qz' before the first pose tells "
                    "another one",
                    q.norm()));
  }
  return SE3{q.normalized().toRotationMatrix(), {at[0], at[1], at[2]}};
}

Result<SE3> from_matrix(std::span<const double> at) {
  SE3 pose;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      pose.rotation(row, column) = at[static_cast<std::size_t>(4 * row + column)];
    }
    pose.translation(row) = at[static_cast<std::size_t>(4 * row + 3)];
  }
  const auto is_off = [](double a, double b) { return !(std::abs(a - b) <= kRounding); };
  const bool ends_well = at.size() == 12 || !(is_off(at[12], 0) || is_off(at[13], 0) ||
                                              is_off(at[14], 0) || is_off(at[15], 1));
  const Eigen::Matrix3d unit = pose.rotation.transpose() * pose.rotation;
  if (!ends_well || !((unit - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() <= kRounding)) {
    return make_error(ErrorCode::kMalformed,
                      "has a matrix that is no rotation with a place beside it: it takes the rows "
                      "of [R | t], one after the other");
  }
  if (pose.rotation.determinant() < 0) {
    return make_error(ErrorCode::kMalformed,
                      "has a matrix that mirrors (its determinant is -1): give poses between "
                      "right-handed frames");
  }
  pose.rotation = closest_rotation(pose.rotation);
  return pose;
}

class PoseReader {
 public:
  // Why the line is refused; empty where it is not.
  std::string line(std::string_view text) {
    const auto comment = text.find('#');
    if (comment != std::string_view::npos) {
      const auto columns = columns_of(fields_of(text.substr(comment + 1)));
      if (!columns.empty()) columns_ = columns;
      text = text.substr(0, comment);
    }
    const auto fields = fields_of(text);
    if (fields.empty()) return "";
    if (const auto columns = columns_of(fields); !columns.empty()) {
      columns_ = columns;
      return "";
    }
    RobotPose pose;
    const auto motion = columns_.empty() ? by_count(fields, pose) : by_columns(fields, pose);
    if (!motion) return motion.error().message;
    return keep(*motion, std::move(pose));
  }

  [[nodiscard]] std::vector<RobotPose> take() { return std::move(poses_); }

 private:
  static Result<double> number(std::string_view field) {
    const auto value = parse_double(field);
    if (value) return *value;
    return make_error(ErrorCode::kMalformed,
                      fmt::format("has '{}', which is no number", shortened(field, 40)));
  }

  // In the order that a line of words has given.
  [[nodiscard]] Result<SE3> by_columns(const std::vector<std::string_view>& fields,
                                       RobotPose& pose) const {
    if (fields.size() != columns_.size()) {
      return make_error(ErrorCode::kMalformed, fmt::format("has {} columns, where {} are named",
                                                           fields.size(), columns_.size()));
    }
    std::array<double, kPoseColumns> values{};
    for (std::size_t i = 0; i < fields.size(); ++i) {
      if (columns_[i] == Column::kOther) continue;
      if (columns_[i] == Column::kName) {
        pose.name = fields[i];
        continue;
      }
      const auto value = number(fields[i]);
      if (!value) return tl::unexpected(value.error());
      if (columns_[i] == Column::kTime) {
        pose.time = *value;
      } else {
        values[static_cast<std::size_t>(columns_[i])] = *value;
      }
    }
    return from_quaternion(values);
  }

  // By how many numbers there are.
  [[nodiscard]] static Result<SE3> by_count(const std::vector<std::string_view>& fields,
                                            RobotPose& pose) {
    std::vector<double> values;
    for (std::size_t i = 0; i < fields.size(); ++i) {
      const auto value = number(fields[i]);
      if (value) {
        values.push_back(*value);
      } else if (i == 0) {
        pose.name = fields[i];
      } else {
        return tl::unexpected(value.error());
      }
    }
    const std::size_t count = values.size();
    const auto is_pose = [](std::size_t n) { return n == kPoseColumns || n == 12 || n == 16; };
    std::span<const double> at = values;
    if (pose.name.empty() && count > 0 && is_pose(count - 1)) {
      pose.time = values.front();
      pose.name = fields.front();
      at = at.subspan(1);
    }
    if (!is_pose(at.size())) {
      return make_error(ErrorCode::kMalformed,
                        fmt::format("has {} numbers, where a pose has 7 (x y z qx qy qz qw), 12 or "
                                    "16 (the rows of its matrix)",
                                    count));
    }
    return at.size() == kPoseColumns ? from_quaternion(at) : from_matrix(at);
  }

  std::string keep(const SE3& motion, RobotPose pose) {
    if (!(motion.translation.cwiseAbs().maxCoeff() <= kLargestTranslation)) {
      return "has a place farther than 1e6 m: it takes metres";
    }
    if (!pose.name.empty() && !names_.insert(pose.name).second) {
      return fmt::format("has '{}', which an earlier line has too: give a picture one pose",
                         shortened(pose.name, 60));
    }
    pose.base_from_hand = to_pose(motion);
    poses_.push_back(std::move(pose));
    return "";
  }

  std::vector<Column> columns_;  // as a line of words has named them
  std::vector<RobotPose> poses_;
  std::set<std::string> names_;
};

Result<std::vector<RobotPose>> parse_lines(std::string_view content, std::string_view name) {
  const std::string file = name.empty() ? std::string("The text of robot poses")
                                        : fmt::format("'{}'", shortened(name, 400));
  PoseReader reader;
  std::size_t number = 0;
  for (const std::string_view line : io::lines_of(content)) {
    ++number;
    if (const std::string why = reader.line(line); !why.empty()) {
      return make_error(ErrorCode::kMalformed,
                        fmt::format("{} cannot be used: line {} {}.", file, number, why));
    }
  }
  std::vector<RobotPose> poses = reader.take();
  if (poses.empty()) {
    return make_error(ErrorCode::kMalformed,
                      fmt::format("{} has no pose of a robot: it takes a line 'x y z qx qy qz qw' "
                                  "for each picture.",
                                  file));
  }
  return poses;
}

}  // namespace

Result<std::vector<RobotPose>> parse_robot_poses(std::string_view content, std::string_view name) {
  try {
    return parse_lines(content, name);
  } catch (const std::exception&) {
    return make_error(ErrorCode::kMalformed, "There is no memory for so many poses of a robot.");
  }
}

Result<std::vector<RobotPose>> read_robot_poses(const std::filesystem::path& path) {
  const auto content = read_file(path.string());
  if (!content) return tl::unexpected(content.error());
  return parse_robot_poses(*content, path.string());
}

}  // namespace calvin
