// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Medians of distances, and the limits for corners and views that are multiples of them.

#include "calvin/solve/residuals/outliers.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

namespace calvin {

namespace {

// See find_outliers() for where these come from.
constexpr double kCornerLimit = 6;          // scales of the corners
constexpr double kViewFactor = 4;           // times the median scale of the views
constexpr double kViewDeviations = 6;       // standard deviations of the scales of the views
constexpr std::size_t kFewestViews = 4;     // for views to be judged
constexpr double kMadToSigma = 1.4826;      // of a Gaussian
constexpr double kRayleighMedian = 1.1774;  // of the distance, in sigmas per coordinate

double median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// The scale beyond which a view is wrong.
double view_limit(const std::vector<double>& scales) {
  std::vector<double> values = scales;
  const double center = median(values);
  for (double& v : values) v = std::abs(v - center);
  const double deviation = kMadToSigma * median(values);
  return std::max(kViewFactor * center, center + kViewDeviations * deviation);
}

double scale_of_all(std::span<const std::vector<double>> distances) {
  std::vector<double> all;
  for (const auto& view : distances) all.insert(all.end(), view.begin(), view.end());
  return robust_scale(std::move(all));
}

bool all_within(const std::vector<double>& distances, double limit) {
  return std::all_of(distances.begin(), distances.end(), [limit](double d) { return d <= limit; });
}

}  // namespace

double robust_scale(std::vector<double> distances) {
  if (distances.empty()) return kLeastScale;
  return std::max(kLeastScale, median(distances) / kRayleighMedian);
}

double trimmed_rms(std::vector<double> distances) {
  if (distances.empty()) return 0;
  const auto kept = static_cast<std::ptrdiff_t>((3 * distances.size() + 3) / 4);
  std::nth_element(distances.begin(), distances.begin() + kept - 1, distances.end());
  const double squares =
      std::inner_product(distances.begin(), distances.begin() + kept, distances.begin(), 0.0);
  return std::sqrt(squares / static_cast<double>(kept));
}

std::vector<ViewMask> find_outliers(std::span<const std::vector<double>> distances) {
  std::vector<double> scales;
  scales.reserve(distances.size());
  for (const auto& view : distances) scales.push_back(robust_scale(view));
  const bool judge_views = distances.size() >= kFewestViews;
  const double limit = judge_views ? view_limit(scales) : 0;
  std::optional<double> common;  // few views have a corner that asks for it

  std::vector<ViewMask> masks(distances.size());
  for (std::size_t v = 0; v < distances.size(); ++v) {
    ViewMask& mask = masks[v];
    mask.view = !judge_views || scales[v] <= limit;
    mask.corners.assign(distances[v].size(), mask.view);
    if (!mask.view || all_within(distances[v], kCornerLimit * scales[v])) continue;
    if (!common) common = scale_of_all(distances);
    const double corner_limit = kCornerLimit * std::max(*common, scales[v]);
    for (std::size_t i = 0; i < distances[v].size(); ++i) {
      mask.corners[i] = distances[v][i] <= corner_limit;
    }
  }
  return masks;
}

bool any_outlier(std::span<const ViewMask> masks) {
  return std::any_of(masks.begin(), masks.end(), [](const ViewMask& mask) {
    return !mask.view ||
           std::find(mask.corners.begin(), mask.corners.end(), false) != mask.corners.end();
  });
}

}  // namespace calvin
