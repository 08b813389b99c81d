// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Rays to the rim of a disc, and the moments of what they enclose.

#include "calvin/detect/circles/blob_shape.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "calvin/detect/checkerboard/corners/grey_at.hpp"

namespace calvin::detect {

namespace {

constexpr int kRays = 16;
constexpr int kMostSteps = 24;

struct Ray {
  double x;
  double y;
};
const std::array<Ray, kRays> kDirections = [] {
  std::array<Ray, kRays> rays{};
  for (int k = 0; k < kRays; ++k) {
    const double angle = 2 * std::numbers::pi * k / kRays;
    rays[static_cast<std::size_t>(k)] = {std::cos(angle), std::sin(angle)};
  }
  return rays;
}();

// Grey levels along all rays, brighter outwards.
struct Profiles {
  std::array<std::array<float, kMostSteps + 1>, kRays> grey;
  int steps = 0;
  double step = 1;  // px

  // False where a ray leaves the image.
  bool take(const ImageView& image, double x, double y, double reach, bool light) {
    steps = std::clamp(static_cast<int>(std::ceil(reach)), 3, kMostSteps);
    step = reach / steps;
    for (std::size_t k = 0; k < kRays; ++k) {
      for (int i = 0; i <= steps; ++i) {
        const auto v = grey_at(image, static_cast<float>(x + i * step * kDirections[k].x),
                               static_cast<float>(y + i * step * kDirections[k].y));
        if (!v) return false;
        grey[k][static_cast<std::size_t>(i)] = light ? 255 - *v : *v;
      }
    }
    return true;
  }
};

// The grey levels of the disc and of what is around it.
struct Levels {
  float inside = 0;
  float outside = 0;
};
Levels levels_of(const Profiles& profiles) {
  std::array<float, kRays> brightest{};
  float first = 0;
  for (std::size_t k = 0; k < kRays; ++k) {
    const auto& ray = profiles.grey[k];
    brightest[k] = *std::max_element(ray.begin(), ray.begin() + profiles.steps + 1);
    first += ray[1] / kRays;
  }
  std::nth_element(brightest.begin(), brightest.begin() + kRays / 2, brightest.end());
  return {std::min(first, profiles.grey[0][0]), brightest[kRays / 2]};
}

// How far the rim is along a ray, px: where the grey level half way is passed first.
std::optional<double> rim_of(const Profiles& profiles, std::size_t k, float half) {
  const auto& ray = profiles.grey[k];
  if (ray[0] >= half) return std::nullopt;
  for (std::size_t i = 1; i <= static_cast<std::size_t>(profiles.steps); ++i) {
    if (ray[i] < half) continue;
    const double part = static_cast<double>((half - ray[i - 1]) / (ray[i] - ray[i - 1]));
    return (static_cast<double>(i - 1) + part) * profiles.step;
  }
  return std::nullopt;
}

// The ellipse with the first and second moments of what the rim encloses.
Ellipse ellipse_of(double x, double y, const std::array<double, kRays>& rim) {
  double area = 0;
  double mx = 0;
  double my = 0;
  double xx = 0;
  double xy = 0;
  double yy = 0;
  for (std::size_t k = 0; k < kRays; ++k) {
    const Ray d = kDirections[k];
    const double square = rim[k] * rim[k];
    area += square / 2;
    mx += square * rim[k] / 3 * d.x;
    my += square * rim[k] / 3 * d.y;
    xx += square * square / 4 * d.x * d.x;
    xy += square * square / 4 * d.x * d.y;
    yy += square * square / 4 * d.y * d.y;
  }
  mx /= area;
  my /= area;
  Ellipse e;
  e.x = x + mx;
  e.y = y + my;
  e.xx = 4 * (xx / area - mx * mx);  // the variance of a disc is a quarter of its radius squared
  e.xy = 4 * (xy / area - mx * my);
  e.yy = 4 * (yy / area - my * my);
  return e;
}

// How far the rim is from the ellipse, RMS, px.
double misfit(double x, double y, const std::array<double, kRays>& rim, const Ellipse& e) {
  double sum = 0;
  for (std::size_t k = 0; k < kRays; ++k) {
    const double dx = x + rim[k] * kDirections[k].x - e.x;
    const double dy = y + rim[k] * kDirections[k].y - e.y;
    const double radii = std::sqrt(e.square_distance(dx, dy));
    const double share = (radii - 1) / std::max(radii, 0.1);
    sum += share * share * (dx * dx + dy * dy);
  }
  return std::sqrt(sum / kRays);
}

}  // namespace

std::optional<Ellipse> measure_blob(const ImageView& image, double x, double y, bool light,
                                    double reach, float contrast) {
  constexpr double kMostElongated = 16;  // of the axes, squared
  constexpr double kLeastSquare = 0.5;   // px^2, of the shorter half axis
  constexpr double kMisfit = 0.3;        // px
  constexpr double kMisfitShare = 0.06;  // of the radius
  Profiles profiles;
  if (!profiles.take(image, x, y, reach, light)) return std::nullopt;
  const Levels levels = levels_of(profiles);
  if (levels.outside - levels.inside < contrast) return std::nullopt;
  std::array<double, kRays> rim{};
  for (std::size_t k = 0; k < kRays; ++k) {
    const auto at = rim_of(profiles, k, 0.5F * (levels.inside + levels.outside));
    if (!at) return std::nullopt;
    rim[k] = std::max(*at, 0.2);
  }
  Ellipse e = ellipse_of(x, y, rim);
  if (!(e.determinant() > 0) || !(e.xx > 0)) return std::nullopt;
  if (e.shortest_square() < kLeastSquare ||
      e.longest_square() > kMostElongated * e.shortest_square() ||
      misfit(x, y, rim, e) > kMisfit + kMisfitShare * e.radius()) {
    return std::nullopt;
  }
  e.inside = light ? 255 - levels.inside : levels.inside;
  e.outside = light ? 255 - levels.outside : levels.outside;
  return e;
}

std::optional<Ellipse> closer_ellipse(const ImageView& image, const Ellipse& near) {
  constexpr double kFrom = 0.6;  // of the radius
  constexpr double kTo = 1.4;
  const double a = std::sqrt(near.xx);
  const double b = near.xy / a;
  const double c = std::sqrt(std::max(near.yy - b * b, 0.0));
  const float half = 0.5F * (near.inside + near.outside);
  const float sign = near.is_light() ? -1.0F : 1.0F;
  const int steps = std::clamp(static_cast<int>(std::ceil((kTo - kFrom) * near.radius())), 4, 40);
  const double step = (kTo - kFrom) / steps;
  // How much brighter than half way a point in a direction is, as seen from a dark disc.
  const auto above_half = [&](const Ray& d, double radii) {
    const auto grey = grey_at(image, static_cast<float>(near.x + radii * a * d.x),
                              static_cast<float>(near.y + radii * (b * d.x + c * d.y)));
    return grey ? std::optional(sign * (*grey - half)) : std::nullopt;
  };
  std::array<double, kRays> rim{};
  for (std::size_t k = 0; k < kRays; ++k) {
    auto before = above_half(kDirections[k], kFrom);
    if (!before || *before >= 0) return std::nullopt;
    for (int i = 1; i <= steps && rim[k] == 0; ++i) {
      const auto next = above_half(kDirections[k], kFrom + i * step);
      if (!next) return std::nullopt;
      if (*next >= 0) {
        rim[k] = kFrom + step * (i - 1 + static_cast<double>(*before / (*before - *next)));
      }
      before = next;
    }
    if (rim[k] == 0) return std::nullopt;
  }
  // In radii of the ellipse that was known.
  const Ellipse e = ellipse_of(0, 0, rim);
  if (!(e.determinant() > 0) || !(e.xx > 0)) return std::nullopt;
  Ellipse closer = near;
  closer.x += a * e.x;
  closer.y += b * e.x + c * e.y;
  closer.xx = a * a * e.xx;
  closer.xy = a * (b * e.xx + c * e.xy);
  closer.yy = b * b * e.xx + 2 * b * c * e.xy + c * c * e.yy;
  return closer;
}

}  // namespace calvin::detect
