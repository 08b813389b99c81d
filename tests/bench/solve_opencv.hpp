// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// OpenCV's calibrations: with its own start and its own end of the iteration.
#pragma once

#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>

#include "solve_problem.hpp"

namespace bench {

class OpenCv {
 public:
  explicit OpenCv(const Problem& problem) : problem_(problem) {
    std::vector<cv::Point3f> points;
    for (const Eigen::Vector3d& p : kBoard.points()) {
      points.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()), 0.0F);
    }
    for (const calvin::View& view : problem.views) {
      std::vector<cv::Point2f> corners;
      for (const calvin::Pixel p : view.observation.uv) {
        corners.emplace_back(static_cast<float>(p.u), static_cast<float>(p.v));
      }
      board_.push_back(points);
      image_.push_back(corners);
    }
  }

  // cv::calibrateCamera with `flags`, brown5.
  [[nodiscard]] Fitted brown5(int flags) const {
    Mats m;
    cv::calibrateCamera(board_, image_, {kSize.width, kSize.height}, m.k, m.d, m.r, m.t, flags);
    return fitted(m, 5);
  }

  // cv::fisheye::calibrate. Its own guess of the focal length often ends elsewhere: it gets that of
  // near_truth().
  [[nodiscard]] Fitted fisheye() const {
    const auto p = near_truth(problem_).intrinsics;
    Mats m;
    m.k = (cv::Mat_<double>(3, 3) << p[0], 0, p[2], 0, p[1], p[3], 0, 0, 1);
    m.d = cv::Mat::zeros(4, 1, CV_64F);
    cv::fisheye::calibrate(board_, image_, {kSize.width, kSize.height}, m.k, m.d, m.r, m.t,
                           cv::fisheye::CALIB_USE_INTRINSIC_GUESS |
                               cv::fisheye::CALIB_RECOMPUTE_EXTRINSIC |
                               cv::fisheye::CALIB_FIX_SKEW);
    return fitted(m, 4);
  }

 private:
  struct Mats {
    cv::Mat k;
    cv::Mat d;
    std::vector<cv::Mat> r;
    std::vector<cv::Mat> t;
  };

  static Fitted fitted(const Mats& m, int coefficients) {
    Fitted result;
    result.intrinsics = {m.k.at<double>(0, 0), m.k.at<double>(1, 1), m.k.at<double>(0, 2),
                         m.k.at<double>(1, 2)};
    for (int i = 0; i < coefficients; ++i) result.intrinsics.push_back(m.d.at<double>(i));
    for (std::size_t i = 0; i < m.r.size(); ++i) {
      Eigen::Vector3d w(m.r[i].ptr<double>());
      Eigen::Vector3d t(m.t[i].ptr<double>());
      result.camera_from_board.push_back({calvin::exp_so3(w), t});
    }
    return result;
  }

  Problem problem_;
  std::vector<std::vector<cv::Point3f>> board_;
  std::vector<std::vector<cv::Point2f>> image_;
};

}  // namespace bench
