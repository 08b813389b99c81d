// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Calibration files: the native one (JSON), OpenCV's (YAML, XML, JSON), ROS's camera_info, mrcal's
// cameramodel, COLMAP's cameras.txt, and Kalibr's camchain and caliscope's camera_array.toml of one
// camera. A file is known by its content, never by its name. Formats: docs/formats.md.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "calvin/core/calibration.hpp"
#include "calvin/core/export.hpp"

namespace calvin {

// A calibration of 4,400 views has over 1 MB. More than this is no calibration.
inline constexpr std::size_t kMaxCalibrationBytes = std::size_t{16} << 20;

// Any known format, of at most kMaxCalibrationBytes; the time grows as the length. What comes back
// makes a Camera: Camera::make() has checked it. One thing may be missing: OpenCV's files need not
// say their image size, which is then 0x0, and the caller's images tell it. An OpenCV file of a
// stereo pair gives its first camera.
// kMalformed for broken content, kUnsupported for what this version or build cannot read. The
// message names `name` (a path, or empty) and says what is wrong and what to do.
[[nodiscard]] CALVIN_API Result<Calibration> parse_calibration(std::string_view content,
                                                               std::string_view name = "");

// parse_calibration() of a file. kNotFound where there is none, kIo where
// the system refuses or the path is a folder or a device.
[[nodiscard]] CALVIN_API Result<Calibration> read_calibration(const std::filesystem::path& path);

// The inverse, in one of calibration_formats(). Numbers read back as the same; only the native
// format holds everything. kInvalidArgument for an unknown format, a calibration without an image
// size where the format needs one, and for numbers that could not be read back, whatever the format
// has of them: an rms that is not finite, a negative sigma; kUnsupported where the format has no
// such camera model.
[[nodiscard]] CALVIN_API Result<std::string> print_calibration(const Calibration& calibration,
                                                               std::string_view format = "calvin");

// kUnsupported where the format has no camera model of that name, whatever its numbers: for whoever
// knows both before there is a calibration. kInvalidArgument for an unknown format.
[[nodiscard]] CALVIN_API Status can_hold(std::string_view format, std::string_view model);

// print_calibration(), then the file is written whole: a reader sees the old file or the new, but
// for one that can only be overwritten. kIo where the system refuses, with what to do.
[[nodiscard]] CALVIN_API Status write_calibration(const std::filesystem::path& path,
                                                  const Calibration& calibration,
                                                  std::string_view format = "calvin");

// Whether write_calibration() can work there, found without writing: for the warning at start.
[[nodiscard]] CALVIN_API Status can_write(const std::filesystem::path& path);

// "calvin", "opencv-yaml", "opencv-xml", "opencv-json", "ros", "kalibr", "mrcal", "colmap".
[[nodiscard]] CALVIN_API std::vector<std::string_view> calibration_formats();

}  // namespace calvin
