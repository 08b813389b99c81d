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

// Adds what one point of a pixel has, `weight` times.
inline void add_point(const SpotVector& fit, double x, double y, double weight, SpotValue& value) {
  constexpr double kMiddle = 1e-9;  // of the square, where its logarithm has no meaning any more
  const double square = fit[kP] * x * x + 2 * fit[kQ] * x * y + fit[kR] * y * y;
  double power = square;  // square^flatness
  double rise = 1;        // its derivative by the square
  double logarithm = 0;
  if (fit[kFlatness] != 1) {
    logarithm = std::log(std::max(square, kMiddle));
    power = std::exp(fit[kFlatness] * logarithm);
    rise = fit[kFlatness] * power / std::max(square, kMiddle);
  }
  const double part = weight * std::exp(fit[kLogHeight] - power / 2);
  value.grey += part;
  value.slope[kX] += part * rise * (fit[kP] * x + fit[kQ] * y);
  value.slope[kY] += part * rise * (fit[kQ] * x + fit[kR] * y);
  value.slope[kLogHeight] += part;
  value.slope[kP] -= part * rise * x * x / 2;
  value.slope[kQ] -= part * rise * x * y;
  value.slope[kR] -= part * rise * y * y / 2;
  value.slope[kFlatness] -= part * power * logarithm / 2;
}

// Of the pixel at (x, y); the mean by four points, which is exact up to third order.
inline SpotValue spot_value(const SpotVector& fit, double x, double y) {
  constexpr double kPoint = 0.28867513459481287;  // px from the middle, 1 / sqrt(12)
  SpotValue value;
  value.grey = fit[kOffset];
  value.slope[kOffset] = 1;
  for (const double dx : {-kPoint, kPoint}) {
    for (const double dy : {-kPoint, kPoint}) {
      add_point(fit, x + dx - fit[kX], y + dy - fit[kY], 0.25, value);
    }
  }
  return value;
}

}  // namespace calvin::detect
