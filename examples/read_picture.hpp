// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Pictures from files, for the programs that have no pipeline.
#pragma once

#include <filesystem>

#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgcodecs.hpp>

// Empty where a file is no picture. As the sensor saw it, like in a pipeline: a calibration knows
// nothing of how the camera was held, which a phone notes in the file.
inline cv::Mat read_picture(const std::filesystem::path& file) {
  // What cannot be read is told by the program.
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  return cv::imread(file.string(), cv::IMREAD_GRAYSCALE | cv::IMREAD_IGNORE_ORIENTATION);
}
