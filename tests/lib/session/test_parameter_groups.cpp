// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What is said of the parameters of a camera, against promises of cameras in which all but some are
// known.

#include <gtest/gtest.h>

#include <cmath>

#include "calvin/session/guidance/parameter_groups.hpp"
#include "calvin/solve/uncertainty.hpp"
#include "scenes.hpp"

namespace calvin {
namespace {

Calibration known_by(const char* model, double sigma) {
  scenes::Random random(4);
  Calibration calibration = scenes::random_camera(model, random).to_calibration();
  const std::size_t n = calibration.parameters.size();
  calibration.covariance.assign(n * n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    // About as much for a projection, whatever the parameter: the others are multiplied by fx.
    const double own = i < 4 ? sigma : sigma / calibration.parameters[0].value;
    calibration.parameters[i].sigma = own;
    calibration.covariance[i * n + i] = own * own;
  }
  return calibration;
}

TEST(ParameterErrors, AreThoseOfTheGroupAlone) {
  Calibration all = known_by("brown5", 0.5);
  // What groups share is not counted: fx with cx, and with k1.
  for (const std::size_t other : {2U, 4U}) {
    all.covariance[other] = all.covariance[other * all.parameters.size()] =
        0.6 * *all.parameters[0].sigma * *all.parameters[other].sigma;
  }
  const auto errors = parameter_errors(all);
  ASSERT_EQ(errors.size(), 3U);
  EXPECT_EQ(errors[0].name, "focal length");
  EXPECT_EQ(errors[1].name, "principal point");
  EXPECT_EQ(errors[2].name, "distortion");
  // A camera of which nothing else is estimated.
  const auto alone = [&](std::size_t first, std::size_t end) {
    Calibration some = all;
    some.covariance.clear();
    for (std::size_t i = 0; i < some.parameters.size(); ++i) {
      if (i < first || i >= end) some.parameters[i].sigma.reset();
    }
    for (std::size_t i = first; i < end; ++i) {
      for (std::size_t k = first; k < end; ++k) {
        const double own = *some.parameters[i].sigma;
        some.covariance.push_back(i == k ? own * own : 0);
      }
    }
    return expected_error_anywhere(some).value();
  };
  EXPECT_NEAR(errors[0].expected_error, alone(0, 2), 1e-9);
  EXPECT_NEAR(errors[1].expected_error, alone(2, 4), 1e-9);
  EXPECT_NEAR(errors[2].expected_error, alone(4, 9), 1e-9);
  // The camera turned a little is as good: most of an error of the principal point is no error.
  EXPECT_LT(errors[1].expected_error, 0.5 * errors[0].expected_error);
}

TEST(ParameterErrors, AreNoMoreThanTheWhole) {
  Calibration calibration = known_by("brown5", 0.5);
  // Errors of k1 that those of the focal length undo at the border of the picture.
  const std::size_t n = calibration.parameters.size();
  for (const std::size_t focal : {0U, 1U}) {
    const double product =
        -0.99 * *calibration.parameters[focal].sigma * *calibration.parameters[4].sigma;
    calibration.covariance[focal * n + 4] = calibration.covariance[4 * n + focal] = product;
  }
  calibration.covariance[1] = calibration.covariance[n] = 0.99 * calibration.covariance[0];
  const double whole = expected_error_anywhere(calibration).value();
  for (const GroupError& e : parameter_errors(calibration)) {
    EXPECT_LE(e.expected_error, whole) << e.name;
  }
}

TEST(ParameterErrors, AreNoneWhereNothingIsEstimated) {
  Calibration calibration = known_by("pinhole", 0.5);
  EXPECT_EQ(parameter_errors(calibration).size(), 2U) << "it has no distortion";
  for (Parameter& p : calibration.parameters) p.sigma.reset();
  calibration.covariance.clear();
  for (const GroupError& e : parameter_errors(calibration)) EXPECT_EQ(e.expected_error, 0);
}

TEST(ParameterGroups, AreKnownWhereTheirErrorIsSmallEnough) {
  const auto groups = parameter_groups(
      {{"focal length", 2}, {"principal point", 0.5}, {"distortion", HUGE_VAL}}, 1);
  ASSERT_EQ(groups.size(), 3U);
  EXPECT_DOUBLE_EQ(groups[0].known, 0.5);
  EXPECT_DOUBLE_EQ(groups[1].known, 1);
  EXPECT_DOUBLE_EQ(groups[2].known, 0);
}

TEST(ParameterLines, HaveAsManyDigitsAsAreKnown) {
  Calibration calibration;
  calibration.parameters = {{"fx", 536.12345, 0.4123}, {"k1", -0.271828, 0.00312},
                            {"cy", 235.5, 12.4},       {"k2", 0.25, 0},
                            {"k3", 0, std::nullopt},   {"p1", 1e-9, 1e-12}};
  const auto lines = parameter_lines(calibration);
  ASSERT_EQ(lines.size(), 6U);
  EXPECT_EQ(lines[0], "fx 536.1 \u00b1 0.4");
  EXPECT_EQ(lines[1], "k1 -0.272 \u00b1 0.003");
  EXPECT_EQ(lines[2], "cy 236 \u00b1 12");
  EXPECT_EQ(lines[3], "k2 0.25");
  EXPECT_EQ(lines[4], "k3 0");
  EXPECT_EQ(lines[5], "p1 1.00e-09 \u00b1 1e-12");
}

}  // namespace
}  // namespace calvin
