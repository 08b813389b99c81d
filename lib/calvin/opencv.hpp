// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// For programs that use OpenCV (4.6 and newer) too: its pictures, corners and cameras as ours, and
// back. Headers alone, and not part of calvin.hpp; the program links opencv_core itself. Both agree
// on where (0, 0) is and on the direction of the distortion, so that no number changes.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>

#include "calvin/camera/camera.hpp"
#include "calvin/core/calibration.hpp"
#include "calvin/core/image.hpp"
#include "calvin/core/observation.hpp"
#include "calvin/core/result.hpp"
#include "calvin/target/board.hpp"

namespace calvin {

// A grey picture (CV_8UC1), in place; empty for any other type. The Mat keeps the pixels.
[[nodiscard]] inline ImageView image_view(const cv::Mat& picture) {
  if (picture.type() != CV_8UC1) return {};
  return {picture.data, picture.cols, picture.rows, static_cast<std::ptrdiff_t>(picture.step[0])};
}

// The corners of an observation, px, and where they are on their board, m: the two arguments of
// cv::solvePnP() and, one of each for a view, of cv::calibrateCamera(). Corners that the board does
// not have are in neither.
struct OpenCvPoints {
  std::vector<cv::Point3f> object;
  std::vector<cv::Point2f> image;
};
[[nodiscard]] inline OpenCvPoints to_opencv(const Observation& observation, const Board& board) {
  OpenCvPoints points;
  const auto places = board.points();
  for (std::size_t i = 0; i < observation.ids.size(); ++i) {
    const auto index = board.index_of(observation.ids[i]);
    if (!index) continue;
    const auto& p = places[*index];
    const Pixel& uv = observation.uv[i];
    points.object.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()),
                               static_cast<float>(p.z()));
    points.image.emplace_back(static_cast<float>(uv.u), static_cast<float>(uv.v));
  }
  return points;
}

// The corners of cv::findChessboardCorners(), all of them and in its order, with this 1 sigma (px).
// kInvalidArgument where the board has another number of control points. OpenCV does not look at
// the colours: control point 0 may be at the other end of the board than that of our detector.
[[nodiscard]] inline Result<Observation> observation_from_opencv(
    const std::vector<cv::Point2f>& corners, const Board& board, ImageSize image_size,
    double sigma = 0.1) {
  Observation seen;
  seen.ids = board.ids();
  if (seen.ids.size() != corners.size()) {
    return make_error(ErrorCode::kInvalidArgument, "There are " + std::to_string(corners.size()) +
                                                       " corners and the board " + board.text() +
                                                       " has " + std::to_string(seen.ids.size()) +
                                                       ": give all of them.");
  }
  seen.board = board.text();
  seen.image_size = image_size;
  seen.ambiguous = board.symmetries();
  seen.sigma.assign(corners.size(), sigma);
  for (const cv::Point2f& corner : corners) seen.uv.push_back({corner.x, corner.y});
  return seen;
}

// cameraMatrix and distCoeffs.
struct OpenCvCamera {
  cv::Matx33d matrix = cv::Matx33d::eye();
  std::vector<double> distortion;
};

namespace opencv_detail {

struct Model {
  std::string_view name;
  std::size_t coefficients;
};

// Those of cv::projectPoints(): distCoeffs of each are a beginning of the next one's.
inline constexpr std::array<Model, 6> kBrown = {{{"pinhole", 0},
                                                 {"brown4", 4},
                                                 {"brown5", 5},
                                                 {"rational8", 8},
                                                 {"thinprism12", 12},
                                                 {"tilted14", 14}}};
inline constexpr std::array<Model, 1> kFisheye = {{{"fisheye", 4}}};

template <std::size_t N>
Result<OpenCvCamera> to_opencv(const Calibration& calibration, const std::array<Model, N>& models,
                               const char* advice) {
  const auto camera = Camera::make(calibration);
  if (!camera) return tl::unexpected<Error>(camera.error());
  for (const Model& model : models) {
    if (model.name != camera->model()) continue;
    if (camera->skew() != 0) {
      return make_error(ErrorCode::kUnsupported,
                        "OpenCV has no skew: calibrate without it, or undistort with calvin.");
    }
    const auto& p = camera->parameters();
    return OpenCvCamera{{p[0], 0, p[2], 0, p[1], p[3], 0, 0, 1}, {p.begin() + 4, p.end()}};
  }
  return make_error(ErrorCode::kUnsupported,
                    "The model " + calibration.model + " is none of these: " + advice);
}

template <std::size_t N>
Result<Calibration> from_opencv(const cv::Mat& matrix, const cv::Mat& distortion,
                                ImageSize image_size, const std::array<Model, N>& models) {
  if (matrix.rows != 3 || matrix.cols != 3 || matrix.channels() != 1 ||
      (!distortion.empty() && (distortion.channels() != 1 || distortion.dims != 2))) {
    return make_error(ErrorCode::kInvalidArgument,
                      "A camera of OpenCV is a matrix of 3x3 numbers and a row of coefficients.");
  }
  cv::Mat_<double> k;
  cv::Mat_<double> d;
  matrix.convertTo(k, CV_64F);
  distortion.convertTo(d, CV_64F);
  for (const Model& model : models) {
    if (model.coefficients != d.total()) continue;
    std::vector<double> parameters = {k(0, 0), k(1, 1), k(0, 2), k(1, 2)};
    parameters.insert(parameters.end(), d.begin(), d.end());
    const auto camera = Camera::make(model.name, image_size, parameters, k(0, 1));
    if (!camera) return tl::unexpected<Error>(camera.error());
    return camera->to_calibration();
  }
  return make_error(ErrorCode::kInvalidArgument,
                    "No model of OpenCV's has " + std::to_string(d.total()) + " coefficients.");
}

}  // namespace opencv_detail

// A calibration of the brown family (pinhole, brown4, brown5, rational8, thinprism12, tilted14),
// for cv::undistort(), cv::solvePnP() and the like. kUnsupported for any other lens and for a skew,
// which those do not know.
[[nodiscard]] inline Result<OpenCvCamera> to_opencv(const Calibration& calibration) {
  return opencv_detail::to_opencv(
      calibration, opencv_detail::kBrown,
      "pinhole, brown4, brown5, rational8, thinprism12, tilted14. A fisheye goes by "
      "to_opencv_fisheye().");
}

// A calibration with the model fisheye, for the functions of cv::fisheye.
[[nodiscard]] inline Result<OpenCvCamera> to_opencv_fisheye(const Calibration& calibration) {
  return opencv_detail::to_opencv(calibration, opencv_detail::kFisheye,
                                  "fisheye. The brown family goes by to_opencv().");
}

// What cv::calibrateCamera() found, of pictures of this size: the model follows from the number of
// coefficients, 0, 4, 5, 8, 12 or 14. Errors of Camera::make() for numbers that no camera has.
[[nodiscard]] inline Result<Calibration> calibration_from_opencv(const cv::Mat& matrix,
                                                                 const cv::Mat& distortion,
                                                                 ImageSize image_size) {
  return opencv_detail::from_opencv(matrix, distortion, image_size, opencv_detail::kBrown);
}

// What cv::fisheye::calibrate() found: four coefficients.
[[nodiscard]] inline Result<Calibration> calibration_from_opencv_fisheye(const cv::Mat& matrix,
                                                                         const cv::Mat& distortion,
                                                                         ImageSize image_size) {
  return opencv_detail::from_opencv(matrix, distortion, image_size, opencv_detail::kFisheye);
}

}  // namespace calvin
