// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Hermite's cubic between two nodes, with slopes that are mixes of secants.

#include "calvin/geometry/monotone_cubic.hpp"

#include <algorithm>
#include <cstddef>

namespace calvin {

namespace {

struct Curve {
  std::span<const double> nodes;
  std::span<const double> guides;

  [[nodiscard]] double width(std::size_t i) const { return nodes[i + 1] - nodes[i]; }
  [[nodiscard]] double secant(std::size_t i) const {
    return (guides[i + 1] - guides[i]) / width(i);
  }
};

// Whether a cubic that has these slopes at its ends turns back nowhere, going by one of them: not
// against the secant, nor more than three times as steep (F. Fritsch, R. Carlson, SIAM J. Numer.
// Anal. 17(2), 1980).
bool keeps_order(double slope, double secant) {
  constexpr double kSteepest = 3;
  return secant > 0 ? slope >= 0 && slope <= kSteepest * secant
                    : slope <= 0 && slope >= kSteepest * secant;
}

// How much of the slope at an inner node is the secant before it; the rest is the one behind it.
double share_before(const Curve& curve, std::size_t node) {
  const double before = curve.width(node - 1);
  const double behind = curve.width(node);
  const double s0 = curve.secant(node - 1);
  const double s1 = curve.secant(node);
  const double parabola = behind / (before + behind);
  const double slope = parabola * s0 + (1 - parabola) * s1;
  if (keeps_order(slope, s0) && keeps_order(slope, s1)) return parabola;
  // The guides turn here themselves: level.
  if (s0 * s1 <= 0) return s0 == s1 ? parabola : s1 / (s1 - s0);
  // s0 s1 / (w0 s1 + w1 s0) as a mix of s0 and s1.
  const double w0 = (before + 2 * behind) / (3 * (before + behind));
  return w0 * s1 / (w0 * s1 + (1 - w0) * s0);
}

// Adds the weights of `factor` times the slope at a node.
void add_slope(const Curve& curve, std::size_t node, double factor, std::vector<double>& weights) {
  const auto add = [&](std::size_t i, double part) {
    weights[i + 1] += factor * part / curve.width(i);
    weights[i] -= factor * part / curve.width(i);
  };
  const std::size_t last = curve.nodes.size() - 1;
  if (node > 0 && node < last) {
    const double share = share_before(curve, node);
    add(node - 1, share);
    add(node, 1 - share);
    return;
  }
  // At an end: the slope of the parabola through the three points there.
  const std::size_t own = node == 0 ? 0 : last - 1;
  if (last < 2) return add(own, 1);
  const std::size_t next = node == 0 ? 1 : last - 2;
  const double beyond = curve.width(own) / (curve.width(own) + curve.width(next));
  const double slope = (1 + beyond) * curve.secant(own) - beyond * curve.secant(next);
  const bool bent = keeps_order(slope, curve.secant(own));
  add(own, bent ? 1 + beyond : 1);
  if (bent) add(next, -beyond);
}

}  // namespace

std::vector<double> monotone_cubic_weights(std::span<const double> nodes,
                                           std::span<const double> guides, double x) {
  std::vector<double> weights(nodes.size(), 0);
  const double at = std::clamp(x, nodes.front(), nodes.back());
  if (nodes.size() == 1) {
    weights[0] = 1;
    return weights;
  }
  const auto above = std::upper_bound(nodes.begin() + 1, nodes.end() - 1, at);
  const auto right = static_cast<std::size_t>(above - nodes.begin());
  const std::size_t left = right - 1;
  const Curve curve = {nodes, guides};
  const double h = curve.width(left);
  const double t = (at - nodes[left]) / h;
  weights[left] = (1 + 2 * t) * (1 - t) * (1 - t);
  weights[right] = t * t * (3 - 2 * t);
  add_slope(curve, left, h * t * (1 - t) * (1 - t), weights);
  add_slope(curve, right, -h * t * t * (1 - t), weights);
  return weights;
}

}  // namespace calvin
