// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Heads, poses and covariances, checked.

#include "calvin/io/native_fields.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "calvin/camera/camera.hpp"
#include "calvin/geometry/covariance.hpp"
#include "calvin/io/calibration_formats.hpp"

namespace calvin::io {

void read_head(Fields& fields, std::string_view known, int newest, std::string_view of) {
  const std::string format = fields.string("format");
  if (!fields.failed() && format != known) {
    fields.complain("format", fmt::format("is '{}'; the file of {} says '{}'", format, of, known));
  }
  const int version = fields.integer("version");
  if (version > newest) {
    fields.complain("version",
                    fmt::format("is {}: a newer version of this software wrote the file, and this "
                                "one reads up to {}",
                                version, newest),
                    ErrorCode::kUnsupported);
  }
  if (version < 1) fields.complain("version", "is not 1");
}

std::vector<double> read_covariance(Fields& fields, std::size_t size, std::string_view of,
                                    std::string_view key) {
  std::vector<double> all;
  const auto rows = fields.rows(key, size);
  if (!rows.empty() && rows.size() != size) {
    fields.complain(key, fmt::format("has {} rows, but {} {}", rows.size(), size, of));
    return all;
  }
  if (fields.failed()) return all;
  for (const auto& row : rows) all.insert(all.end(), row.begin(), row.end());
  if (const auto why = no_covariance(all, rows.size())) fields.complain(key, *why);
  return all;
}

Pose read_pose(Fields fields) {
  Pose pose;
  const auto rotation = fields.numbers("rotation", 3);
  const auto translation = fields.numbers("translation", 3);
  std::copy(rotation.begin(), rotation.end(), pose.rotation.begin());
  std::copy(translation.begin(), translation.end(), pose.translation.begin());
  return pose;
}

bool is_possible(const Pose& pose) {
  constexpr double kFarthest = 1e6;  // m; of a turn, rad
  const auto is_near = [](double x) { return std::abs(x) <= kFarthest; };
  return std::ranges::all_of(pose.translation, is_near) &&
         std::ranges::all_of(pose.rotation, is_near);
}

bool is_possible(const std::vector<double>& covariance) {
  return std::ranges::all_of(covariance, [](double x) { return std::abs(x) <= 1e12; });
}

void check_place(Fields& fields, std::string_view pose_key, const Pose& pose,
                 std::string_view covariance_key, const std::vector<double>& covariance) {
  if (!is_possible(pose)) fields.complain(pose_key, "is out of range (1e6 m, 1e6 rad)");
  if (!is_possible(covariance)) fields.complain(covariance_key, "is out of range (1e12)");
}

Calibration read_camera(Fields& fields) {
  constexpr std::string_view kKey = "calibration";
  const Node* node = fields.find(kKey);
  if (node == nullptr || node->kind != Node::Kind::kMap) {
    fields.complain(kKey, "is missing");
    return {};
  }
  auto calibration = read_native(*node);
  const auto camera = calibration ? Camera::make(*calibration)
                                  : Result<Camera>(tl::unexpected(calibration.error()));
  if (camera) return *std::move(calibration);
  fields.complain(kKey, fmt::format("is wrong: {}", camera.error().message), camera.error().code);
  return {};
}

Result<Node> camera_node(const Calibration& calibration) {
  if (const auto good = Camera::make(calibration); !good) return tl::unexpected(good.error());
  const auto printed = print_native(calibration);
  if (!printed) return tl::unexpected(printed.error());
  return parse_json(*printed);
}

}  // namespace calvin::io
