// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What the native files of cameras and of rigs have in common.
#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include "calvin/core/calibration.hpp"
#include "calvin/io/document.hpp"

namespace calvin::io {

// `format` and `version`: another format than `known` is refused, and a version after `newest`.
// `of` is what the file is one of: "a camera".
void read_head(Fields& fields, std::string_view known, int newest, std::string_view of);

// A covariance, row-major; empty where it is absent or wrong. `of` says in a complaint what `size`
// counts: "parameters have a sigma".
[[nodiscard]] std::vector<double> read_covariance(Fields& fields, std::size_t size,
                                                  std::string_view of,
                                                  std::string_view key = "covariance");

// `rotation` and `translation`.
[[nodiscard]] Pose read_pose(Fields fields);

// Whether anything has such a pose, and such a covariance of a place (1e6 m and rad, 1e12).
[[nodiscard]] bool is_possible(const Pose& pose);
[[nodiscard]] bool is_possible(const std::vector<double>& covariance);

// s: no clocks of one rig are farther apart.
inline constexpr double kMostTimeOffset = 3600;

// Complains of poses and covariances of places that nothing has (1e6 m and rad, 1e12), so that
// whatever is computed of them stays finite.
void check_place(Fields& fields, std::string_view pose_key, const Pose& pose,
                 std::string_view covariance_key, const std::vector<double>& covariance);

// `calibration`, of which a Camera can be made; and the inverse.
[[nodiscard]] Calibration read_camera(Fields& fields);
[[nodiscard]] Result<Node> camera_node(const Calibration& calibration);

}  // namespace calvin::io
