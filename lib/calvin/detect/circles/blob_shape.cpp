// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Rays to the rim of a disc, and the moments of what they enclose.

#include "calvin/detect/circles/blob_shape.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>

#include "calvin/detect/checkerboard/corners/grey_at.hpp"

namespace calvin::detect {

namespace {

constexpr std::size_t kRays = BlobShapes::kRays;
constexpr std::size_t kReach = BlobShapes::kReach;

struct Ray {
  double x;
  double y;
};
const std::array<Ray, kRays> kDirections = [] {
  std::array<Ray, kRays> rays{};
  for (std::size_t k = 0; k < kRays; ++k) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(k) / kRays;
    rays[k] = {std::cos(angle), std::sin(angle)};
  }
  return rays;
}();

using Profiles = BlobShapes::Profiles;

// Where a ray is after so many px, from the pixel that it begins in: the upper left one of four
// pixels, and their weights.
struct Tap {
  int x;
  int y;
  std::array<float, 4> weights;
};
const std::array<std::array<Tap, kRays>, kReach> kTaps = [] {
  std::array<std::array<Tap, kRays>, kReach> taps{};
  for (std::size_t i = 1; i <= kReach; ++i) {
    for (std::size_t k = 0; k < kRays; ++k) {
      // Not farther than the ray, where it ends at a pixel; within what computing leaves.
      const auto whole = [](double w) {
        return w > 0.5 ? std::ceil(w - 1e-9) - 1 : std::floor(w + 1e-9);
      };
      const double u = static_cast<double>(i) * kDirections[k].x;
      const double v = static_cast<double>(i) * kDirections[k].y;
      const double right = std::clamp(u - whole(u), 0.0, 1.0);
      const double down = std::clamp(v - whole(v), 0.0, 1.0);
      Tap& tap = taps[i - 1][k];
      tap.x = static_cast<int>(whole(u));
      tap.y = static_cast<int>(whole(v));
      tap.weights = {static_cast<float>((1 - right) * (1 - down)),
                     static_cast<float>(right * (1 - down)), static_cast<float>((1 - right) * down),
                     static_cast<float>(right * down)};
    }
  }
  return taps;
}();

// The grey levels of the disc and of what is around it.
struct DiscLevels {
  float inside = 0;
  float outside = 0;
};
DiscLevels levels_of(const Profiles& profiles) {
  std::array<float, kRays> brightest = profiles.grey[0];
  for (std::size_t i = 1; i <= kReach; ++i) {
    for (std::size_t k = 0; k < kRays; ++k) {
      brightest[k] = std::max(brightest[k], profiles.grey[i][k]);
    }
  }
  float first = 0;
  for (const float grey : profiles.grey[1]) first += grey / kRays;
  std::nth_element(brightest.begin(), brightest.begin() + kRays / 2, brightest.end());
  return {std::min(first, profiles.grey[0][0]), brightest[kRays / 2]};
}

// Whether every second ray comes half way to the grey level that most of them come to, at the
// least.
bool may_have_rim(const Profiles& profiles) {
  constexpr std::size_t kHalf = kRays / 2;
  std::array<float, kHalf> brightest{};
  float first = 0;
  for (std::size_t k = 0; k < kHalf; ++k) {
    brightest[k] = profiles.grey[1][2 * k];
    first += brightest[k] / kHalf;
    for (std::size_t i = 2; i <= kReach; ++i) {
      brightest[k] = std::max(brightest[k], profiles.grey[i][2 * k]);
    }
  }
  std::nth_element(brightest.begin(), brightest.begin() + kHalf / 2 - 1, brightest.end());
  const float least = *std::min_element(brightest.begin(), brightest.begin() + kHalf / 2);
  const float inside = std::min(first, profiles.grey[0][0]);
  return least >= 0.5F * (inside + brightest[kHalf / 2 - 1]);
}

// How far the rim is along a ray, px: where the grey level half way is passed first.
std::optional<double> rim_of(const Profiles& profiles, std::size_t k, float half) {
  if (profiles.grey[0][k] >= half) return std::nullopt;
  for (std::size_t i = 1; i <= kReach; ++i) {
    const float grey = profiles.grey[i][k];
    if (grey < half) continue;
    const float before = profiles.grey[i - 1][k];
    return static_cast<double>(i - 1) + static_cast<double>((half - before) / (grey - before));
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

// Every second ray, from the first or the second one on.
void BlobShapes::take_rays(const std::uint8_t* centre, std::size_t first,
                           Profiles& profiles) const {
  const float sign = light_ ? -1.0F : 1.0F;
  const float dark = light_ ? 255.0F : 0.0F;
  for (std::size_t i = 1; i <= kReach; ++i) {
    for (std::size_t k = first; k < kRays; k += 2) {
      const std::uint8_t* at = centre + offsets_[(i - 1) * kRays + k];
      const std::uint8_t* below = at + image_.stride;
      const auto& w = kTaps[i - 1][k].weights;
      profiles.grey[i][k] =
          dark + sign * (w[0] * static_cast<float>(at[0]) + w[1] * static_cast<float>(at[1]) +
                         w[2] * static_cast<float>(below[0]) + w[3] * static_cast<float>(below[1]));
    }
  }
}

void BlobShapes::begin(const ImageView& image, bool light) {
  image_ = image;
  light_ = light;
  offsets_.clear();
  for (const auto& distance : kTaps) {
    for (const Tap& tap : distance) offsets_.push_back(tap.y * image.stride + tap.x);
  }
}

std::optional<Ellipse> BlobShapes::measure(int x, int y, float contrast) const {
  constexpr double kMostElongated = 16;  // of the axes, squared
  constexpr double kLeastSquare = 0.5;   // px^2, of the shorter half axis
  constexpr double kMisfit = 0.3;        // px
  constexpr double kMisfitShare = 0.06;  // of the radius
  constexpr int kRoom = kReach;
  if (x < kRoom || y < kRoom || x > image_.width - 1 - kRoom || y > image_.height - 1 - kRoom) {
    return std::nullopt;
  }
  Profiles profiles;
  const std::uint8_t* centre = image_.data + y * image_.stride + x;
  profiles.grey[0].fill(light_ ? 255.0F - static_cast<float>(*centre)
                               : static_cast<float>(*centre));
  take_rays(centre, 0, profiles);
  if (!may_have_rim(profiles)) return std::nullopt;
  take_rays(centre, 1, profiles);
  const DiscLevels levels = levels_of(profiles);
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
  e.inside = light_ ? 255 - levels.inside : levels.inside;
  e.outside = light_ ? 255 - levels.outside : levels.outside;
  return e;
}

namespace {

// How a disc's own circle of radius 1 comes to its ellipse: (x, y) to (a x, b x + c y).
struct RadiiMap {
  double a;
  double b;
  double c;

  explicit RadiiMap(const Ellipse& e)
      : a(std::sqrt(e.xx)), b(e.xy / a), c(std::sqrt(std::max(e.yy - b * b, 0.0))) {}
};

// How far the rim is in all directions, in radii of an ellipse that is near it.
std::optional<std::array<double, kRays>> rim_near(const ImageView& image, const Ellipse& near) {
  constexpr double kFrom = 0.6;  // of the radius
  constexpr double kTo = 1.4;
  const RadiiMap map(near);
  const float half = 0.5F * (near.inside + near.outside);
  const float sign = near.is_light() ? -1.0F : 1.0F;
  const int steps = std::clamp(static_cast<int>(std::ceil((kTo - kFrom) * near.radius())), 4, 40);
  const double step = (kTo - kFrom) / steps;
  // How much brighter than half way a point in a direction is, as seen from a dark disc.
  const auto above_half = [&](const Ray& d, double radii) {
    const auto grey = grey_at(image, static_cast<float>(near.x + radii * map.a * d.x),
                              static_cast<float>(near.y + radii * (map.b * d.x + map.c * d.y)));
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
  return rim;
}

}  // namespace

std::optional<Ellipse> closer_ellipse(const ImageView& image, const Ellipse& near) {
  const auto rim = rim_near(image, near);
  if (!rim) return std::nullopt;
  // In radii of the ellipse that was known.
  const Ellipse e = ellipse_of(0, 0, *rim);
  if (!(e.determinant() > 0) || !(e.xx > 0)) return std::nullopt;
  const auto [a, b, c] = RadiiMap(near);
  Ellipse closer = near;
  closer.x += a * e.x;
  closer.y += b * e.x + c * e.y;
  closer.xx = a * a * e.xx;
  closer.xy = a * (b * e.xx + c * e.xy);
  closer.yy = b * b * e.xx + 2 * b * c * e.xy + c * c * e.yy;
  return closer;
}

std::optional<double> rim_squareness(const ImageView& image, const Ellipse& near) {
  const auto closer = closer_ellipse(image, near);
  const auto rim = closer ? rim_near(image, *closer) : std::nullopt;
  if (!rim) return std::nullopt;
  double even = 0;
  double odd = 0;
  for (std::size_t k = 0; k < kRays; ++k) {
    const Ray& four_times = kDirections[4 * k % kRays];
    even += (*rim)[k] * four_times.x;
    odd += (*rim)[k] * four_times.y;
  }
  return 2.0 / kRays * std::hypot(even, odd);
}

}  // namespace calvin::detect
