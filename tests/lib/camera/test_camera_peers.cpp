// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The lenses that OpenCV has too: the same pixels, the same derivatives.
#include <gtest/gtest.h>

#include "calvin/camera/camera.hpp"
#include "calvin/camera/models.hpp"
#include "calvin_config.h"
#include "lens_samples.hpp"

#if CALVIN_HAVE_OPENCV
#include <opencv2/calib3d.hpp>

namespace calvin {
namespace {

const std::array<double, 4> kPinhole = {520, 518, 325, 236};

// Up to 60 degrees from the axis.
std::vector<cv::Point3d> points() {
  std::vector<cv::Point3d> all;
  for (int i = 0; i <= 20; ++i) {
    const double radius = 0.05 + 0.084 * i;
    for (int k = 0; k < 7; ++k) {
      const double depth = 0.3 + 0.1 * k;
      all.emplace_back(radius * depth * std::cos(0.9 * k + i),
                       radius * depth * std::sin(0.9 * k + i), depth);
    }
  }
  return all;
}

struct Theirs {
  std::vector<cv::Point2d> uv;
  cv::Mat by_point;         // 2n x 3
  cv::Mat by_pinhole;       // 2n x 4: fx fy cx cy
  cv::Mat by_coefficients;  // 2n x m
};

Theirs project(const std::vector<cv::Point3d>& at, const std::vector<double>& d, bool fisheye) {
  const cv::Matx33d k(kPinhole[0], 0, kPinhole[2], 0, kPinhole[1], kPinhole[3], 0, 0, 1);
  const cv::Vec3d none(0, 0, 0);
  const auto n = static_cast<int>(d.size());
  Theirs out;
  cv::Mat j;
  if (fisheye) {
    cv::fisheye::projectPoints(at, out.uv, none, none, k, d, 0, j);
    out.by_pinhole = j.colRange(0, 4);
    out.by_coefficients = j.colRange(4, 8);
    out.by_point = j.colRange(11, 14);
    return out;
  }
  cv::projectPoints(at, none, none, k, d, out.uv, j);
  out.by_point = j.colRange(3, 6);
  out.by_pinhole = j.colRange(6, 10);
  out.by_coefficients = j.colRange(10, 10 + n);
  return out;
}

template <typename L>
class OpenCvHas : public ::testing::Test {};
using Lenses = ::testing::Types<lens::Brown4, lens::Brown5, lens::Rational8, lens::ThinPrism12,
                                lens::Tilted14, lens::Fisheye>;
TYPED_TEST_SUITE(OpenCvHas, Lenses);

TYPED_TEST(OpenCvHas, TheSameFormulaAndDerivatives) {
  using M = Model<TypeParam>;
  const auto at = points();
  for (const auto& d : samples::lens(TypeParam::kName).coefficients) {
    const Theirs theirs = project(at, d, TypeParam::kName == "fisheye");
    std::vector<double> parameters(kPinhole.begin(), kPinhole.end());
    parameters.insert(parameters.end(), d.begin(), d.end());
    for (std::size_t i = 0; i < at.size(); ++i) {
      double uv[2];
      double jp[6];
      double jq[2 * M::kCount];
      ASSERT_TRUE(M::project(parameters.data(), 0, {at[i].x, at[i].y, at[i].z}, uv, jp, jq));
      EXPECT_NEAR(uv[0], theirs.uv[i].x, 1e-9);
      EXPECT_NEAR(uv[1], theirs.uv[i].y, 1e-9);
      for (int axis = 0; axis < 2; ++axis) {
        const int row = 2 * static_cast<int>(i) + axis;
        const auto expect = [&](double ours, double expected, const std::string& what) {
          EXPECT_NEAR(ours, expected, 1e-9 * (1 + std::abs(expected))) << what << ", point " << i;
        };
        for (int c = 0; c < 3; ++c) {
          expect(jp[3 * axis + c], theirs.by_point.at<double>(row, c), "point");
        }
        for (int c = 0; c < 4; ++c) {
          expect(jq[M::kCount * axis + c], theirs.by_pinhole.at<double>(row, c), "pinhole");
        }
        for (int c = 0; c < TypeParam::kCount; ++c) {
          expect(jq[M::kCount * axis + 4 + c], theirs.by_coefficients.at<double>(row, c),
                 std::string(TypeParam::kNames[static_cast<std::size_t>(c)]));
        }
      }
    }
  }
}

}  // namespace
}  // namespace calvin

#endif
