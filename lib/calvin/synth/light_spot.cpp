// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The Gaussian of a light by the derivatives of the camera, and its mean over each pixel.

#include "calvin/synth/light_spot.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/LU>

#include "calvin/geometry/se3.hpp"

namespace calvin::synth {

namespace {

// Gauss-Legendre quadrature with four points over a pixel: exact for polynomials up to degree 7,
// and to 1e-4 of the peak for a Gaussian of 0.35 px.
struct Sample {
  double at;  // px from the middle of the pixel
  double weight;
};
constexpr std::array<Sample, 4> kSamples = {{{-0.43056815579702629, 0.17392742256872693},
                                             {-0.16999052179242813, 0.32607257743127307},
                                             {0.16999052179242813, 0.32607257743127307},
                                             {0.43056815579702629, 0.17392742256872693}}};

constexpr double kReach = 6;  // sigma: the Gaussian is below 2e-8 of its peak there

// The derivatives of the projection along two directions across the line of sight, px per m.
std::optional<Eigen::Matrix2d> derivatives(const Camera& camera, const Eigen::Vector3d& at) {
  const double step = 1e-4 * at.norm();
  const Eigen::Matrix3d turn =
      rotation_between(Eigen::Vector3d::UnitZ(), Eigen::Vector3d(at.normalized()));
  Eigen::Matrix2d by_move;
  for (int k = 0; k < 2; ++k) {
    const Eigen::Vector3d move = step * turn.col(k);
    const auto after = camera.project(at + move);
    const auto before = camera.project(at - move);
    if (!after || !before) return std::nullopt;
    by_move(0, k) = (after->u - before->u) / (2 * step);
    by_move(1, k) = (after->v - before->v) / (2 * step);
  }
  return by_move;
}

void add_row(FloatImage& image, int y, const LightSpot& spot) {
  const double determinant = spot.uu * spot.vv - spot.uv * spot.uv;
  if (!(determinant > 0)) return;
  const double a = spot.vv / determinant;
  const double b = -spot.uv / determinant;
  const double c = spot.uu / determinant;
  const double reach = kReach * std::sqrt(spot.uu) + 1;
  const int first = std::max(0, static_cast<int>(std::floor(spot.centre.u - reach)));
  const int last = std::min(image.width - 1, static_cast<int>(std::ceil(spot.centre.u + reach)));
  float* row = image.row(y);
  for (int x = first; x <= last; ++x) {
    double sum = 0;
    for (const Sample& down : kSamples) {
      const double dv = y + down.at - spot.centre.v;
      for (const Sample& across : kSamples) {
        const double du = x + across.at - spot.centre.u;
        sum += down.weight * across.weight *
               std::exp(-0.5 * (a * du * du + 2 * b * du * dv + c * dv * dv));
      }
    }
    row[x] += static_cast<float>(spot.peak * sum);
  }
}

}  // namespace

std::optional<LightSpot> light_spot(const Camera& camera, const Eigen::Vector3d& in_camera,
                                    double diameter, double glow, double blur) {
  const auto centre = camera.project(in_camera);
  if (!centre) return std::nullopt;
  const auto by_move = derivatives(camera, in_camera);
  if (!by_move) return std::nullopt;
  const Eigen::Matrix2d sharp = diameter * diameter / 16 * (*by_move * by_move->transpose());
  const Eigen::Matrix2d blurred = sharp + blur * blur * Eigen::Matrix2d::Identity();
  const double spread = std::sqrt(std::max(sharp.determinant(), 0.0) / blurred.determinant());
  return LightSpot{*centre, blurred(0, 0), blurred(0, 1), blurred(1, 1), glow * spread};
}

void add_light(FloatImage& image, const SpotOfRow& spot_of_row) {
  for (int y = 0; y < image.height; ++y) {
    const auto spot = spot_of_row(y);
    if (!spot || std::abs(y - spot->centre.v) > kReach * std::sqrt(spot->vv) + 1) continue;
    if (!(std::abs(spot->centre.u) < 1e6) || !(spot->uu < 1e6)) continue;
    add_row(image, y, *spot);
  }
}

}  // namespace calvin::synth
