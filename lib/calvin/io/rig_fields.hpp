// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What the rigs of other programs have in common. Internal.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "calvin/core/rig.hpp"
#include "calvin/geometry/se3.hpp"
#include "calvin/io/document.hpp"
#include "calvin/io/opencv_camera.hpp"

namespace calvin::io {

// No rig has more.
inline constexpr std::size_t kMostRigCameras = 4096;

// A camera in OpenCV's numbers, of which a Camera can be made; what is wrong is told of `key`.
[[nodiscard]] std::optional<Calibration> camera_of(Fields& fields, std::string_view key,
                                                   const OpenCvCamera& numbers, ImageSize size);

// The same lens with coefficients that are 0 left out: brown4 or more, as `numbers` holds them.
// `calibration` is of a model that OpenCV has.
[[nodiscard]] Result<OpenCvCamera> shortest_opencv(const Calibration& calibration);

// The rotation that a matrix is, which was printed with few digits perhaps; absent for any other
// matrix.
[[nodiscard]] std::optional<Eigen::Matrix3d> rotation_near(const Eigen::Matrix3d& matrix);

// Whether a place is no farther away than any is, 1e6 m.
[[nodiscard]] bool is_near(const Eigen::Vector3d& place);

// The world of a rig whose file does not tell it: the first camera that stands where the rig has
// its origin, and as its axes are, else kReferenceWorld.
[[nodiscard]] std::string world_of(const std::vector<RigCamera>& cameras);

// A name that is there twice; nullptr where there is none.
[[nodiscard]] const std::string* repeated_name(const std::vector<RigCamera>& cameras);

// "[1, 2.5]"
[[nodiscard]] std::string list_text(const std::vector<double>& values);

// The nine numbers of a matrix, row by row.
[[nodiscard]] Eigen::Matrix3d matrix_of(const std::vector<double>& row_major);

}  // namespace calvin::io
