// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What a small light adds to a pixel, and how that changes with the unknowns of the fit:
//
//   offset + height exp(-(d^T (p q; q r) d)^flatness / 2)        d: from the centre
//
// as the mean over the pixel. With a flatness of 1 it is a Gaussian; above that the middle is flat
// and the flanks are steep, as of a disc. Internal.
#pragma once

#include <algorithm>
#include <cmath>

#include <Eigen/Core>

namespace calvin::detect {

inline constexpr int kSpotUnknowns = 8;
using SpotVector = Eigen::Matrix<double, kSpotUnknowns, 1>;
using SpotMatrix = Eigen::Matrix<double, kSpotUnknowns, kSpotUnknowns>;

// The places of the unknowns: centre (px), logarithm of the height, offset (grey levels), p, q, r
// (1/px^2), flatness.
enum SpotUnknown { kX, kY, kLogHeight, kOffset, kP, kQ, kR, kFlatness };

struct SpotValue {
  double grey = 0;
  SpotVector slope = SpotVector::Zero();
};

// Of one point, d from the centre: d^T (p q; q r) d to the power of the flatness, its derivative by
// what is raised, and the logarithm of that.
struct SpotPower {
  double power = 0;
  double rise = 1;
  double logarithm = 0;
};

inline SpotPower power_at(const SpotVector& fit, double x, double y) {
  constexpr double kMiddle = 1e-9;  // of the square, where its logarithm has no meaning any more
  const double square = fit[kP] * x * x + 2 * fit[kQ] * x * y + fit[kR] * y * y;
  if (fit[kFlatness] == 1) return {square, 1, 0};
  const double logarithm = std::log(std::max(square, kMiddle));
  const double power = std::exp(fit[kFlatness] * logarithm);
  return {power, fit[kFlatness] * power / std::max(square, kMiddle), logarithm};
}

// Calls f(x, y) with four points of the pixel at (x, y), from the centre: their mean is that over
// the pixel up to third order.
template <typename F>
void for_points(const SpotVector& fit, double x, double y, F f) {
  constexpr double kPoint = 0.28867513459481287;  // px from the middle, 1 / sqrt(12)
  for (const double dx : {-kPoint, kPoint}) {
    for (const double dy : {-kPoint, kPoint}) f(x + dx - fit[kX], y + dy - fit[kY]);
  }
}

// Of the pixel at (x, y), grey levels.
inline double spot_grey(const SpotVector& fit, double x, double y) {
  double sum = 0;
  for_points(fit, x, y,
             [&](double u, double v) { sum += std::exp(-power_at(fit, u, v).power / 2); });
  return fit[kOffset] + std::exp(fit[kLogHeight]) / 4 * sum;
}

// The same with its derivatives by the unknowns.
inline SpotValue spot_value(const SpotVector& fit, double x, double y) {
  SpotValue value;
  value.grey = fit[kOffset];
  value.slope[kOffset] = 1;
  const double height = std::exp(fit[kLogHeight]) / 4;
  for_points(fit, x, y, [&](double u, double v) {
    const SpotPower at = power_at(fit, u, v);
    const double part = height * std::exp(-at.power / 2);
    const double fall = part * at.rise;
    value.grey += part;
    value.slope[kX] += fall * (fit[kP] * u + fit[kQ] * v);
    value.slope[kY] += fall * (fit[kQ] * u + fit[kR] * v);
    value.slope[kLogHeight] += part;
    value.slope[kP] -= fall * u * u / 2;
    value.slope[kQ] -= fall * u * v;
    value.slope[kR] -= fall * v * v / 2;
    value.slope[kFlatness] -= part * at.power * at.logarithm / 2;
  });
  return value;
}

}  // namespace calvin::detect
