// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Places and free intrinsics of two cameras: OpenCV's stereoCalibrate() ends at the same optimum.
#include <algorithm>
#include <iostream>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Core>
#include <opencv2/calib3d.hpp>

#include "calvin/camera/camera.hpp"
#include "calvin/rig/solve_rig.hpp"
#include "simulated_rig.hpp"

namespace calvin {
namespace {

using scenes::Random;

struct Pairs {
  std::vector<std::vector<cv::Point3f>> printed;
  std::vector<std::vector<cv::Point2f>> seen[2];
};

// Of views that both cameras have, each with all corners.
Pairs pairs_of(const std::vector<RigCameraViews>& seen, const Board& board) {
  Pairs pairs;
  std::vector<cv::Point3f> printed;
  for (const Eigen::Vector3d& p : board.points()) {
    printed.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()), 0.0F);
  }
  for (std::size_t v = 0; v < seen[0].views.size(); ++v) {
    pairs.printed.push_back(printed);
    for (std::size_t c = 0; c < 2; ++c) {
      auto& corners = pairs.seen[c].emplace_back();
      for (const Pixel& uv : seen[c].views[v].observation.uv) {
        corners.emplace_back(static_cast<float>(uv.u), static_cast<float>(uv.v));
      }
    }
  }
  return pairs;
}

// Leaves the views of instants that both have, named alike, and as precise as OpenCV takes them.
void keep_pairs(std::vector<RigCameraViews>& seen) {
  const auto instant = [](const View& view) { return view.observation.timestamp / 1'000'000'000; };
  for (std::size_t c = 0; c < 2; ++c) {
    std::erase_if(seen[c].views, [&](const View& view) {
      return std::ranges::none_of(
          seen[1 - c].views, [&](const View& other) { return instant(other) == instant(view); });
    });
    for (View& view : seen[c].views) {
      Observation& observation = view.observation;
      if (observation.ids.front() != 0) {
        std::ranges::reverse(observation.ids);
        std::ranges::reverse(observation.uv);
      }
      observation.ambiguous.clear();
      for (Pixel& uv : observation.uv) {
        uv = {static_cast<float>(uv.u), static_cast<float>(uv.v)};
      }
    }
  }
}

TEST(RigLenses, EndWhereOpenCvEnds) {
  Random random(8);
  for (int trial = 0; trial < 3; ++trial) {
    scenes::SimulatedRig rig = scenes::stereo_rig(random);
    for (Camera& camera : rig.cameras) camera = scenes::random_camera("brown5", random);
    auto seen = scenes::seen_by(rig, 25, 0.7, random);
    keep_pairs(seen);
    ASSERT_GT(seen[0].views.size(), 8u);
    const Pairs pairs = pairs_of(seen, rig.board);
    cv::Mat k[2];
    cv::Mat d[2];
    for (std::size_t c = 0; c < 2; ++c) {
      Calibration& known = seen[c].calibration;
      known.parameters[0].value *= 1.01;
      known.parameters[3].value += 8;
      const auto p = [&](std::size_t i) { return known.parameters[i].value; };
      k[c] = (cv::Mat_<double>(3, 3) << p(0), 0, p(2), 0, p(1), p(3), 0, 0, 1);
      d[c] = (cv::Mat_<double>(1, 5) << p(4), p(5), p(6), p(7), p(8));
    }
    cv::Mat r;
    cv::Mat t;
    cv::Mat e;
    cv::Mat f;
    const double rms = cv::stereoCalibrate(
        pairs.printed, pairs.seen[0], pairs.seen[1], k[0], d[0], k[1], d[1],
        cv::Size(scenes::kSize.width, scenes::kSize.height), r, t, e, f,
        cv::CALIB_USE_INTRINSIC_GUESS,
        cv::TermCriteria(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 300, 1e-12));
    RigOptions options;
    options.intrinsics = RigIntrinsics::kFree;
    const auto found = solve_rig(seen, options);
    ASSERT_TRUE(found) << found.error().message;
    const auto& cameras = found->rig.cameras;
    EXPECT_NEAR(found->rig.rms.value(), rms, 1e-4 * rms);
    for (std::size_t c = 0; c < 2; ++c) {
      const auto& own = cameras[c].calibration.parameters;
      EXPECT_NEAR(own[0].value, k[c].at<double>(0, 0), 0.05 * own[0].sigma.value());
      EXPECT_NEAR(own[3].value, k[c].at<double>(1, 2), 0.05 * own[3].sigma.value());
      EXPECT_NEAR(own[5].value, d[c].at<double>(0, 1), 0.05 * own[5].sigma.value());
    }
    const Eigen::Matrix3d turn =
        Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(r.ptr<double>());
    const SE3 right_from_left = to_se3(cameras[1].rig_from_camera).inverse();
    const double turned = log_so3(turn * right_from_left.rotation.transpose()).norm();
    const Eigen::Vector3d place(t.at<double>(0), t.at<double>(1), t.at<double>(2));
    std::cout << "rms " << *found->rig.rms << " px, OpenCV " << rms << "; turned by " << turned
              << " rad, moved by " << (place - right_from_left.translation).norm() << " m\n";
    EXPECT_LT(turned, 1e-5);
    EXPECT_LT((place - right_from_left.translation).norm(), 1e-5);
  }
}

}  // namespace
}  // namespace calvin
