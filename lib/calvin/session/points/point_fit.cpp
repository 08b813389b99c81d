// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Finds one wrong point among right ones by leaving out each in turn.

#include "calvin/session/points/point_fit.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <fmt/format.h>

#include "calvin/solve/pose.hpp"

namespace calvin {

namespace {

// px: corners are where their sigmas say to three of them, and a camera and a list of places are
// seldom better than this.
double expected_rms(const Observation& seen) {
  constexpr double kLeast = 1.5;
  constexpr double kSigmas = 3;
  double squares = 0;
  for (const double sigma : seen.sigma) squares += sigma * sigma;
  const auto count = static_cast<double>(std::max<std::size_t>(1, seen.sigma.size()));
  return std::max(kLeast, kSigmas * std::sqrt(squares / count));
}

std::optional<double> rms_of(const Camera& camera, const View& view) {
  PoseQuality quality;
  const auto pose = solve_pose(camera, view.board, view.observation, &quality);
  return pose ? std::optional(quality.rms) : std::nullopt;
}

View without(const View& view, std::size_t i) {
  View left = view;
  const auto erase = [i](auto& values) {
    values.erase(values.begin() + static_cast<std::ptrdiff_t>(i));
  };
  erase(left.observation.ids);
  erase(left.observation.uv);
  erase(left.observation.sigma);
  return left;
}

}  // namespace

std::optional<PointFit> fit_points(const Camera& camera, const View& view) {
  constexpr std::size_t kFewest = 6;  // 5 points that agree say that the sixth does not
  constexpr std::size_t kMost = 40;
  const auto rms = rms_of(camera, view);
  if (!rms) return std::nullopt;
  PointFit fit{*rms, expected_rms(view.observation), std::nullopt, 0};
  const std::vector<int>& ids = view.observation.ids;
  if (fit.agrees() || ids.size() < kFewest || ids.size() > kMost) return fit;
  double least = fit.expected;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const auto left = rms_of(camera, without(view, i));
    if (!left || *left > least) continue;
    least = fit.rms_without = *left;
    fit.odd = ids[i];
  }
  return fit;
}

std::string to_text(const PointFit& fit) {
  if (fit.agrees()) return fmt::format("The points fit the camera to {:.2g} px.", fit.rms);
  if (fit.odd) {
    return fmt::format(
        "The points fit the camera to {:.3g} px only, and without the point {} to {:.2g} px: take "
        "that one out and choose it again.",
        fit.rms, *fit.odd, fit.rms_without);
  }
  return fmt::format(
      "The points fit the camera to {:.3g} px only: see that they were chosen in their order, that "
      "the axes are right-handed, and that the camera is the one of `initial`.",
      fit.rms);
}

}  // namespace calvin
