// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The formats of a calibration file, each in files named after it: native_*.cpp, opencv_*.cpp,
// ros_camera_info.cpp. Readers take a document that they recognised; none of them checks the camera
// itself, which calibration_io does for all. Writers are kUnsupported for a camera model that the
// format does not hold.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "calvin/core/calibration.hpp"
#include "calvin/io/document.hpp"

namespace calvin::io {

// The version of the native format that is written, and the newest that is read.
inline constexpr int kNativeVersion = 1;

// kInvalidArgument where the calibration does not say for which pictures it is, which `file` holds.
[[nodiscard]] Status check_has_size(const Calibration& calibration, std::string_view file);

[[nodiscard]] bool is_native(const Node& root);
[[nodiscard]] Result<Calibration> read_native(const Node& root);
[[nodiscard]] Result<std::string> print_native(const Calibration& calibration);

// OpenCV's FileStorage in any of its three syntaxes.
[[nodiscard]] bool is_opencv(const Node& root);
[[nodiscard]] Result<Calibration> read_opencv(const Node& root);
[[nodiscard]] Result<std::string> print_opencv_yaml(const Calibration& calibration);
[[nodiscard]] Result<std::string> print_opencv_xml(const Calibration& calibration);
[[nodiscard]] Result<std::string> print_opencv_json(const Calibration& calibration);
[[nodiscard]] bool opencv_holds(std::string_view model);

// Kalibr's camchain of one camera: kalibr.cpp has that of several too (rig_formats.hpp).
[[nodiscard]] bool is_kalibr(const Node& root);
[[nodiscard]] Result<Calibration> read_kalibr_camera(const Node& root);
[[nodiscard]] Result<std::string> print_kalibr_camera(const Calibration& calibration);
[[nodiscard]] bool kalibr_holds(std::string_view model);

// One .cameramodel of mrcal, wherever it stands.
[[nodiscard]] bool is_mrcal(const Node& root);
[[nodiscard]] Result<Calibration> read_mrcal_camera(const Node& root);
[[nodiscard]] Result<std::string> print_mrcal_camera(const Calibration& calibration);
[[nodiscard]] bool mrcal_holds(std::string_view model);

// COLMAP's cameras.txt, of one camera; it is no tree.
[[nodiscard]] bool is_colmap_cameras(std::string_view content);
[[nodiscard]] Result<Calibration> read_colmap_camera(std::string_view content);
[[nodiscard]] Result<std::string> print_colmap_camera(const Calibration& calibration);
[[nodiscard]] bool colmap_holds(std::string_view model);

// caliscope's camera_array.toml of one camera, wherever it stands.
[[nodiscard]] bool is_caliscope(const Node& root);
[[nodiscard]] Result<Calibration> read_caliscope_camera(const Node& root);

// The results of Bouguet's toolbox; of a stereo pair the left camera.
[[nodiscard]] bool is_bouguet(const Node& root);
[[nodiscard]] Result<Calibration> read_bouguet_camera(const Node& root);

// The YAML of ROS's camera_info_manager and camera_calibration_parsers, or a message CameraInfo.
[[nodiscard]] bool is_ros(const Node& root);
[[nodiscard]] Result<Calibration> read_ros(const Node& root);
[[nodiscard]] Result<std::string> print_ros(const Calibration& calibration);
// Row-major: R, 3 x 3, and P, 3 x 4, of one camera of a stereo pair; else it is not rectified.
struct RosRectification {
  std::array<double, 9> rotation;
  std::array<double, 12> projection;
};
[[nodiscard]] Result<std::string> print_ros(const Calibration& calibration,
                                            const std::optional<RosRectification>& rectification);
[[nodiscard]] bool ros_holds(std::string_view model);

}  // namespace calvin::io
