// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The detectors that are compared: ours, OpenCV's two, mrgingham.
#pragma once

#include <cmath>
#include <ctime>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#if BENCH_HAVE_MRGINGHAM
#include <mrgingham/mrgingham.hh>
#endif
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "calvin/detect/detector.hpp"

namespace bench {

struct Found {
  calvin::Observation observation;  // of a peer: all corners in its own order, no sigma
  double ms = NAN;                  // CPU time of the thread; none where it was not asked
};

inline double thread_ms() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
}

inline calvin::ImageView view_of(const cv::Mat& image) {
  return {image.data, image.cols, image.rows, static_cast<std::ptrdiff_t>(image.step[0]), 1};
}

class Subject {
 public:
  using Detect = std::function<calvin::Observation(const cv::Mat&, const calvin::Board&)>;
  Subject(std::string subject, Detect detect, bool square = false)
      : name(std::move(subject)), square_only_(square), detect_(std::move(detect)) {}

  [[nodiscard]] Found look(const cv::Mat& image, const calvin::Board& board) const {
    if (square_only_ && board.grid()->cols != board.grid()->rows) return {};
    const double begin = thread_ms();
    Found found{detect_(image, board), 0};
    found.ms = thread_ms() - begin;
    return found;
  }

  std::string name;

 private:
  bool square_only_;  // knows no board that has more columns than rows
  Detect detect_;
};

inline calvin::Observation observation_of(const std::vector<cv::Point2f>& corners) {
  calvin::Observation o;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    o.ids.push_back(static_cast<int>(i));
    o.uv.push_back({corners[i].x, corners[i].y});
  }
  return o;
}

inline calvin::Observation by_calvin(const cv::Mat& image, const calvin::Board& board) {
  static std::map<std::string, std::unique_ptr<calvin::Detector>> detectors;
  auto& detector = detectors[board.text()];
  if (!detector) detector = std::move(*calvin::make_detector(board));
  return detector->detect(view_of(image)).observation;
}

// Of a board that is a grid, as those of the scenes are.
inline cv::Size size_of(const calvin::Board& board) {
  return {board.grid()->cols, board.grid()->rows};
}

inline calvin::Observation by_opencv(const cv::Mat& image, const calvin::Board& board) {
  std::vector<cv::Point2f> corners;
  if (!cv::findChessboardCorners(
          image, size_of(board), corners,
          cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_FAST_CHECK)) {
    return {};
  }
  cv::cornerSubPix(image, corners, {11, 11}, {-1, -1},
                   {cv::TermCriteria::EPS | cv::TermCriteria::COUNT, 30, 0.01});
  return observation_of(corners);
}

inline calvin::Observation by_opencv_sb(const cv::Mat& image, const calvin::Board& board) {
  std::vector<cv::Point2f> corners;
  if (!cv::findChessboardCornersSB(image, size_of(board), corners, cv::CALIB_CB_NORMALIZE_IMAGE)) {
    return {};
  }
  return observation_of(corners);
}

#if BENCH_HAVE_MRGINGHAM
inline calvin::Observation by_mrgingham(const cv::Mat& image, const calvin::Board& board) {
  std::vector<mrgingham::PointDouble> points;
  if (mrgingham::find_chessboard_from_image_array(points, nullptr, board.grid()->cols, image) < 0)
    return {};
  std::vector<cv::Point2f> corners;
  for (const auto& p : points) {
    corners.emplace_back(static_cast<float>(p.x), static_cast<float>(p.y));
  }
  return observation_of(corners);
}

#endif

inline std::vector<Subject> subjects() {
  std::vector<Subject> all = {
      {"calvin", by_calvin}, {"OpenCV FAST_CHECK", by_opencv}, {"OpenCV SB", by_opencv_sb}};
#if BENCH_HAVE_MRGINGHAM
  all.emplace_back("mrgingham", by_mrgingham, true);
#endif
  return all;
}

}  // namespace bench
