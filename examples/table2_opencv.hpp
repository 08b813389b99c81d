// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// OpenCV's column of table2.
#pragma once

#include <vector>

#include <Eigen/Core>
#include <opencv2/calib3d.hpp>

#include "calvin/solve/solve.hpp"

namespace table2 {

// fx fy cx cy k1 k2 p1 p2, with k3 where it is asked for.
inline Eigen::VectorXd opencv_parameters(const std::vector<calvin::View>& views,
                                         calvin::ImageSize size, bool with_k3) {
  std::vector<std::vector<cv::Point3f>> board;
  std::vector<std::vector<cv::Point2f>> image;
  for (const calvin::View& view : views) {
    const auto points = view.board.points();
    const double side = view.board.cell_size(0);
    board.emplace_back();
    image.emplace_back();
    for (std::size_t i = 0; i < view.observation.ids.size(); ++i) {
      // In units of a square, which are exact floats.
      const auto& p = points[static_cast<std::size_t>(view.observation.ids[i])];
      board.back().emplace_back(static_cast<float>(p.x() / side), static_cast<float>(p.y() / side),
                                0.0F);
      image.back().emplace_back(static_cast<float>(view.observation.uv[i].u),
                                static_cast<float>(view.observation.uv[i].v));
    }
  }
  cv::Mat k;
  cv::Mat d;
  std::vector<cv::Mat> r;
  std::vector<cv::Mat> t;
  cv::calibrateCamera(board, image, {size.width, size.height}, k, d, r, t,
                      cv::CALIB_USE_LU | (with_k3 ? 0 : cv::CALIB_FIX_K3));
  Eigen::VectorXd result(with_k3 ? 9 : 8);
  result.head<4>() << k.at<double>(0, 0), k.at<double>(1, 1), k.at<double>(0, 2),
      k.at<double>(1, 2);
  for (int i = 0; i < result.size() - 4; ++i) result[4 + i] = d.at<double>(i);
  return result;
}

}  // namespace table2
