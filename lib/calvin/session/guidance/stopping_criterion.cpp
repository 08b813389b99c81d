// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Compares a calibration's promises with what is asked for.

#include "calvin/session/guidance/stopping_criterion.hpp"

#include <cmath>

#include "calvin/camera/camera.hpp"
#include "calvin/camera/usable_area.hpp"
#include "calvin/geometry/convex_hull.hpp"

namespace calvin {

namespace {

bool covers_most(const Calibration& calibration) {
  constexpr double kMost = 0.8;  // of the picture, as far as a board can be shown there
  const ImageSize size = calibration.image_size;
  const double covered = polygon_area(calibration.covered);
  if (covered >= kMost * size.width * size.height) return true;
  // Of a camera that is known in the middle alone nobody knows where its picture ends.
  constexpr double kKnown = 0.01;  // of the diagonal
  const double anywhere = calibration.expected_error_anywhere.value_or(HUGE_VAL);
  if (anywhere > kKnown * std::hypot(size.width, size.height)) return false;
  const auto camera = Camera::make(calibration);
  return camera && covered >= kMost * visible_area(*camera);
}

bool has_misfit(const Calibration& calibration) {
  return !calibration.misfit.empty() && calibration.misfit != "none";
}

}  // namespace

double wanted_error_anywhere(double target) {
  constexpr double kMuchWorse = 5;     // times the target
  constexpr double kInvisible = 0.15;  // px
  return target > 0 ? kMuchWorse * target : kInvisible;
}

bool is_accurate(const Calibration& calibration, double target) {
  const auto& anywhere = calibration.expected_error_anywhere;
  const double wanted = wanted_error_anywhere(target);
  if (!(target > 0)) return anywhere.value_or(HUGE_VAL) <= wanted && covers_most(calibration);
  if (calibration.expected_error.value_or(HUGE_VAL) > target) return false;
  return anywhere.value_or(0) <= wanted || covers_most(calibration);
}

bool is_good_enough(const Calibration& calibration, double target) {
  return is_accurate(calibration, target) && !has_misfit(calibration);
}

}  // namespace calvin
