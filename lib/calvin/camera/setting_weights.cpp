// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Weights along the focus and along the zoom, and the law of the focal length.

#include "calvin/camera/setting_weights.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>

#include "calvin/geometry/monotone_cubic.hpp"

namespace calvin {

namespace {

// Straight between two nodes: what always lies between what their values are.
std::vector<double> straight_weights(std::span<const double> nodes,
                                     std::span<const double> /*guides*/, double x) {
  std::vector<double> weights(nodes.size(), 0);
  const double at = std::clamp(x, nodes.front(), nodes.back());
  const auto above = std::upper_bound(nodes.begin(), nodes.end() - 1, at);
  const auto right = static_cast<std::size_t>(above - nodes.begin());
  if (right == 0) {
    weights[0] = 1;
    return weights;
  }
  const double t = (at - nodes[right - 1]) / (nodes[right] - nodes[right - 1]);
  weights[right - 1] = 1 - t;
  weights[right] = t;
  return weights;
}

// The focuses of a group of settings with one zoom, and their focal lengths by a law.
struct Row {
  std::vector<double> focuses;
  std::vector<double> guides;

  Row(const ZoomTable& table, const ZoomGroup& group, ZoomLaw law) {
    for (std::size_t i = group.begin; i < group.end; ++i) {
      const Calibration& calibration = table.settings[i].calibration;
      focuses.push_back(calibration.focus.value_or(0));
      guides.push_back(by_law(law, calibration.find("fx")->value));
    }
  }
};

double sum_of(const std::vector<double>& weights, const std::vector<double>& values) {
  return std::inner_product(weights.begin(), weights.end(), values.begin(), 0.0);
}

// From the value at a node to what the others have there, of which no more than three on each side
// have a say.
double left_out(const std::vector<double>& nodes, const std::vector<double>& values,
                std::size_t node) {
  constexpr std::size_t kReach = 3;
  std::vector<double> near_nodes;
  std::vector<double> near_values;
  const std::size_t first = node - std::min(node, kReach);
  for (std::size_t i = first; i < std::min(nodes.size(), node + kReach + 1); ++i) {
    if (i == node) continue;
    near_nodes.push_back(nodes[i]);
    near_values.push_back(values[i]);
  }
  const auto weights = monotone_cubic_weights(near_nodes, near_values, nodes[node]);
  return sum_of(weights, near_values) - values[node];
}

}  // namespace

double by_law(ZoomLaw law, double f) {
  if (law == ZoomLaw::kFocalLength) return f;
  return law == ZoomLaw::kPower ? 1 / f : std::log(f);
}

double from_law(ZoomLaw law, double value) {
  if (law == ZoomLaw::kFocalLength) return value;
  return law == ZoomLaw::kPower ? 1 / value : std::exp(value);
}

double slope_of_law(ZoomLaw law, double f) {
  if (law == ZoomLaw::kFocalLength) return 1;
  return law == ZoomLaw::kPower ? -1 / (f * f) : 1 / f;
}

std::vector<double> setting_weights(const ZoomTable& table, ZoomLaw law, ZoomCurve curve,
                                    const LensPosition& position) {
  const auto weights_along =
      curve == ZoomCurve::kSmooth ? monotone_cubic_weights : straight_weights;
  std::vector<double> all;
  std::vector<double> zooms;
  std::vector<double> guides;
  const auto groups = groups_of(table);
  for (const ZoomGroup& group : groups) {
    const Row row(table, group, law);
    const auto along =
        weights_along(row.focuses, row.guides, position.focus.value_or(row.focuses.front()));
    zooms.push_back(*table.settings[group.begin].calibration.zoom);
    guides.push_back(sum_of(along, row.guides));
    all.insert(all.end(), along.begin(), along.end());
  }
  const auto along = weights_along(zooms, guides, position.zoom.value_or(zooms.front()));
  for (std::size_t g = 0; g < groups.size(); ++g) {
    for (std::size_t i = groups[g].begin; i < groups[g].end; ++i) all[i] *= along[g];
  }
  return all;
}

ZoomLaw zoom_law(const ZoomTable& table) {
  constexpr ZoomLaw kLaws[] = {ZoomLaw::kLogarithm, ZoomLaw::kFocalLength, ZoomLaw::kPower};
  const auto groups = groups_of(table);
  ZoomLaw best = kLaws[0];
  double least = std::numeric_limits<double>::infinity();
  for (const ZoomLaw law : kLaws) {
    std::vector<double> zooms;
    std::vector<double> guides;
    for (const ZoomGroup& group : groups) {
      zooms.push_back(*table.settings[group.begin].calibration.zoom);
      guides.push_back(Row(table, group, law).guides.front());
    }
    double sum = 0;
    for (std::size_t g = 1; g + 1 < groups.size(); ++g) {
      const double off = left_out(zooms, guides, g);
      sum += std::pow(std::log(from_law(law, guides[g] + off) / from_law(law, guides[g])), 2);
    }
    if (!(sum < least)) continue;
    least = sum;
    best = law;
  }
  return best;
}

}  // namespace calvin
