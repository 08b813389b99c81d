// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Divided differences along rows and columns, and the verdict on each corner from them.

#include "calvin/detect/checkerboard/fits/stray_corners.hpp"

#include <algorithm>
#include <cmath>

#include "calvin/detect/checkerboard/fits/node_fit.hpp"
#include "calvin/detect/maps/outliers.hpp"
#include "calvin/geometry/homography.hpp"

namespace calvin::detect {

namespace {

constexpr std::size_t kFewest = 3;  // nodes of a difference
constexpr std::size_t kMost = 5;
constexpr int kLongest = 8;      // steps over missing nodes
constexpr float kSigmas = 2;     // of the noise, which is in the median as well
constexpr float kSlack = 0.01F;  // px, what a fit may be off by at least beside its noise
// Of the spacing: of such slack five corners in a line make eight.
constexpr float kLargeSlack = 0.006F;
constexpr float kUnusual = 5;     // times the median
constexpr int kFewForMedian = 6;  // differences of an order
constexpr float kHigh = 2.5F;     // times the median, where that is high itself; up to
constexpr float kHighest = 0.3F;  // of the spacing: the ends of a line are still confirmed
constexpr float kRough = 1.5F;    // times the median, where nothing better is to be had
// Tolerated differences by order, of the spacing: bounds of a multiple of the median, and the value
// without enough differences for a median. The upper bound is a board close to the rim of a
// fisheye's picture; the presumed value is one at a grazing angle from close up, where the depth
// changes by a tenth per square.
constexpr float kLeastUsual[] = {0, 0, 0.02F, 0.006F, 0.003F};
constexpr float kMostUsual[] = {0, 0, 0.5F, 0.3F, 0.2F};
constexpr float kPresumed[] = {0, 0, 0.25F, 0.08F, 0.03F};
constexpr float kLike = 0.35F;  // of a difference: neighbours that differ by less are alike
constexpr int kLinesAside = 2;
constexpr int kFewestAlike = 2;
// A node is something else if its sigma is above kUncertainTimes medians and kUncertainLeast, and
// its place is off by kUncertainError and by kUncertainOfTolerance: at the ends of lines
// differences tell places to some pixels only, and sigmas contain how uncertain bends are there.
constexpr float kUncertainTimes = 6;
constexpr float kUncertainLeast = 0.06F;  // px
constexpr float kUncertainError = 0.5F;   // px
constexpr float kUncertainOfTolerance = 0.4F;
// The fewest nodes of which the map of a lens does not follow a stray one.
constexpr int kFewestOfMap = 12;
constexpr float kLeastPrecise = 0.35F;  // of the spacing, to which a place must be confirmed

// Whether a node lies in line with the next two of its row and of its column, as well as their
// noise lets one tell: where corners are noisy, differences of more of them tell less.
bool is_in_line(const Lattice& lattice, Cell c) {
  constexpr float kOff = 0.25F;         // of the spacing
  constexpr float kOffInNoise = 0.45F;  // likewise
  const auto is_straight = [&](Cell step) {
    for (int first = -2; first <= 0; ++first) {
      const Cell a = c + first * step;
      if (!lattice.has(a) || !lattice.has(a + step) || !lattice.has(a + 2 * step)) continue;
      const Node& from = lattice.at(a);
      const Node& middle = lattice.at(a + step);
      const Node& to = lattice.at(a + 2 * step);
      const float spacing = 0.5F * std::hypot(to.x - from.x, to.y - from.y);
      // Twice how far the middle one is from the line through the others.
      const float of_to = lattice.length(a, step);
      const float of_from = lattice.length(a + step, step);
      const float noise = std::hypot(of_from * from.sigma, 2 * middle.sigma, of_to * to.sigma);
      const float off = std::hypot(of_from * from.x - 2 * middle.x + of_to * to.x,
                                   of_from * from.y - 2 * middle.y + of_to * to.y);
      if (off < std::min(kOff * spacing + kSigmas * noise, kOffInNoise * spacing)) return true;
    }
    return false;
  };
  return is_straight({1, 0}) && is_straight({0, 1});
}

// Whether a node of a small board is far from where those around it let it be expected.
bool has_suspects(const Lattice& lattice) {
  constexpr int kSmall = 36;    // nodes
  constexpr float kOff = 0.2F;  // of the spacing
  bool any = false;
  if (lattice.count() > kSmall || lattice.count() < kFewestOfMap) return any;
  lattice.for_each([&](Cell c, const Node& node) {
    const auto expected = lattice.expect(c);
    any = any || (expected && std::hypot(node.x - expected->x, node.y - expected->y) >
                                  kOff * expected->spacing);
  });
  return any;
}

}  // namespace

void StrayCorners::add(const Lattice& lattice, Cell first, Cell step, std::span<const int> places) {
  Difference d;
  d.step = step;
  for (const int place : places) d.places |= std::uint64_t{1} << (place & 63);
  d.count = static_cast<int>(places.size());
  if (places.back() - places.front() > kLongest) return;
  const auto at = [&](std::size_t i) {
    const Cell c = first + places[i] * step;
    return step.row == 0 ? lattice.place(c.col, true) : lattice.place(c.row, false);
  };
  float factorial = 1;
  for (int k = 2; k < d.count; ++k) factorial *= static_cast<float>(k);
  float variance = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    float weight = factorial;
    for (std::size_t k = 0; k < places.size(); ++k) {
      if (k != i) weight /= at(i) - at(k);
    }
    d.weights[i] = weight;
    d.cells[i] = first + places[i] * step;
    const Node& node = lattice.at(d.cells[i]);
    d.x += weight * node.x;
    d.y += weight * node.y;
    variance += weight * weight * (node.sigma * node.sigma + slack_ * slack_);
  }
  const Node& from = lattice.at(d.cells[0]);
  const Node& to = lattice.at(d.cells[places.size() - 1]);
  d.spacing = std::hypot(to.x - from.x, to.y - from.y) / (at(places.size() - 1) - at(0));
  d.noise = std::sqrt(variance);
  differences_.push_back(d);
}

void StrayCorners::take_line(const Lattice& lattice, Cell first, Cell step, int count) {
  places_.clear();
  for (int i = 0; i < count; ++i) {
    if (lattice.has(first + i * step)) places_.push_back(i);
  }
  const std::size_t nodes = std::min(places_.size(), few_nodes_ ? kFewest : kMost);
  if (nodes < kFewest) return;
  for (std::size_t i = 0; i + nodes <= places_.size(); ++i) {
    add(lattice, first, step, std::span<const int>(places_).subspan(i, nodes));
  }
}

void StrayCorners::take_differences(const Lattice& lattice) {
  differences_.clear();
  const CellRange e = lattice.extent();
  for (int row = e.first.row; row <= e.last.row; ++row) {
    take_line(lattice, {e.first.col, row}, {1, 0}, e.cols());
  }
  for (int col = e.first.col; col <= e.last.col; ++col) {
    take_line(lattice, {col, e.first.row}, {0, 1}, e.rows());
  }
}

// The median of sorted_, which is not empty.
float StrayCorners::median_of_sorted() {
  const auto middle = sorted_.begin() + static_cast<std::ptrdiff_t>(sorted_.size() / 2);
  std::nth_element(sorted_.begin(), middle, sorted_.end());
  return *middle;
}

// The tolerance of each order is a multiple of its median over the board, which perspective and
// lens make large or small. A small board has few differences of an order: there all of them
// together tell by how much they are larger than presumed.
void StrayCorners::set_tolerances(int nodes) {
  sorted_.clear();
  for (const Difference& d : differences_) {
    sorted_.push_back(std::hypot(d.x, d.y) / d.spacing / kPresumed[d.count - 1]);
  }
  const bool may_be_loose = nodes >= kFewestOfMap && !sorted_.empty();
  const float of_presumed = may_be_loose ? median_of_sorted() : 0;
  are_loose_ = false;
  for (int count = static_cast<int>(kFewest); count <= static_cast<int>(kMost); ++count) {
    sorted_.clear();
    for (const Difference& d : differences_) {
      if (d.count == count) sorted_.push_back(std::hypot(d.x, d.y) / d.spacing);
    }
    const float presumed = kPresumed[count - 1];
    float share = std::clamp(kUnusual * of_presumed * presumed, presumed, kMostUsual[count - 1]);
    if (sorted_.size() < kFewForMedian) {
      are_loose_ = are_loose_ || (!sorted_.empty() && share > presumed);
    } else {
      const float usual = median_of_sorted();
      // A board that fills the picture of a fisheye has squares of very different sizes.
      const float most = std::max(kMostUsual[count - 1], std::min(kHigh * usual, kHighest));
      share = std::clamp(kUnusual * usual, kLeastUsual[count - 1], most);
      // No board is bent by so much that three of its corners would confirm nothing.
      if (count == static_cast<int>(kFewest)) {
        share = std::min(share, std::max(presumed, kRough * usual));
      }
    }
    for (Difference& d : differences_) {
      if (d.count == count) d.tolerance = kSigmas * d.noise + share * d.spacing;
    }
  }
  for (Difference& d : differences_) {
    d.fails = std::hypot(d.x, d.y) > d.tolerance && !is_like_its_neighbours(d);
  }
}

// Whether parallel lines nearby have a similar difference, or the two next to it on one side lead
// to it: towards the rim of a fisheye's picture lines bend ever more, but neighbours alike.
bool StrayCorners::is_like_its_neighbours(const Difference& d) const {
  const Cell aside = {d.step.row, d.step.col};
  const float tolerance = std::max(d.tolerance, kLike * std::hypot(d.x, d.y));
  const Difference* near[2 * kLinesAside + 1] = {};
  int alike = 0;
  for (const Difference& o : differences_) {
    if (!(o.step == d.step) || o.places != d.places) continue;
    const Cell way = o.cells[0] - d.cells[0];
    const int lines = way.col * aside.col + way.row * aside.row;
    if (lines == 0 || std::abs(lines) > kLinesAside) continue;
    near[kLinesAside + lines] = &o;
    alike += std::hypot(o.x - d.x, o.y - d.y) <= tolerance ? 1 : 0;
  }
  const auto leads_to_it = [&](int side) {
    const Difference* const next = near[kLinesAside + side];
    const Difference* const after = near[kLinesAside + 2 * side];
    return next && after &&
           std::hypot(2 * next->x - after->x - d.x, 2 * next->y - after->y - d.y) <= tolerance;
  };
  return alike >= kFewestAlike || leads_to_it(1) || leads_to_it(-1);
}

void StrayCorners::collect_verdicts(const CellRange& extent) {
  verdicts_.assign(static_cast<std::size_t>(extent.cols() * extent.rows()), {});
  for (const Difference& d : differences_) {
    const float w = 1 / (d.tolerance * d.tolerance);
    for (int i = 0; i < d.count; ++i) {
      const Cell c = d.cells[i] - extent.first;
      Verdict& v = verdicts_[static_cast<std::size_t>(c.row * extent.cols() + c.col)];
      v.x += w * d.weights[i] * d.x;
      v.y += w * d.weights[i] * d.y;
      v.weight += w * d.weights[i] * d.weights[i];
      v.accused = v.accused || d.fails;
      v.confirmed = v.confirmed || d.tolerance < kLeastPrecise * d.spacing * std::abs(d.weights[i]);
    }
  }
}

// Whether the nodes of a small board are where perspective alone has them: from close by, it makes
// differences of three nodes as large as a stray one would.
bool StrayCorners::are_in_perspective(const Lattice& lattice) const {
  constexpr int kSmall = 16;     // nodes
  constexpr int kFewest = 8;     // a stray one of fewer would be followed
  constexpr float kOff = 0.04F;  // of the spacing
  if (lattice.count() < kFewest || lattice.count() > kSmall) return false;
  std::vector<Pixel> places;
  std::vector<Pixel> nodes;
  bool certain = true;
  lattice.for_each([&](Cell c, const Node& node) {
    const LatticePlace at = lattice.place(c);
    places.push_back({at.col, at.row});
    nodes.push_back({static_cast<double>(node.x), static_cast<double>(node.y)});
    certain = certain && node.sigma <= std::max(kUncertainTimes * usual_sigma_, kUncertainLeast);
  });
  const auto homography = fit_homography(places, nodes);
  if (!certain || !homography) return false;
  std::size_t i = 0;
  bool all = true;
  lattice.for_each([&](Cell c, const Node& node) {
    const Pixel at = transform(*homography, places[i]);
    const double off = std::hypot(at.u - nodes[i].u, at.v - nodes[i].v);
    const auto noise = static_cast<double>(kSigmas * std::hypot(node.sigma, slack_));
    all = all && off <= static_cast<double>(kOff * spacing_at(lattice, c)) + noise;
    ++i;
  });
  return all;
}

// Where a small board is bent by so much that differences are tolerated that may be those of stray
// corners: removes those that are elsewhere than a lens has the others.
void StrayCorners::remove_outliers(Lattice& lattice, const Pixel& middle) {
  constexpr double kOff = 0.2;  // of the spacing
  std::vector<Cell> cells;
  std::vector<Pixel> places;
  std::vector<Pixel> nodes;
  lattice.for_each([&](Cell c, const Node& node) {
    const LatticePlace at = lattice.place(c);
    cells.push_back(c);
    places.push_back({at.col, at.row});
    nodes.push_back({static_cast<double>(node.x), static_cast<double>(node.y)});
  });
  for (const std::size_t i : grid_outliers(places, nodes, middle, kOff)) {
    lattice.remove(cells[i]);
  }
}

void StrayCorners::remove_from(Lattice& lattice, const Slack& slack, const Pixel& middle) {
  slack_ = std::max(slack.place, kSlack);
  few_nodes_ = slack.of_spacing > kLargeSlack;
  sorted_.clear();
  lattice.for_each([&](Cell /*c*/, const Node& node) { sorted_.push_back(node.sigma); });
  if (sorted_.empty()) return;
  usual_sigma_ = median_of_sorted();
  if (are_in_perspective(lattice)) return;
  for (;;) {
    const CellRange extent = lattice.extent();
    take_differences(lattice);
    set_tolerances(lattice.count());
    collect_verdicts(extent);
    Cell worst;
    float most = -1;
    bool removed = false;
    lattice.for_each([&](Cell c, const Node& node) {
      const Cell at = c - extent.first;
      const Verdict& v = verdicts_[static_cast<std::size_t>(at.row * extent.cols() + at.col)];
      if (!v.confirmed && !is_in_line(lattice, c)) {
        lattice.remove(c);
        removed = true;
        return;
      }
      // By how much the squares of the differences sink if this node alone is to blame.
      const bool accused =
          v.accused || (node.sigma > std::max(kUncertainTimes * usual_sigma_, kUncertainLeast) &&
                        v.error() > kUncertainError && v.of_tolerance() > kUncertainOfTolerance);
      const float explained = accused ? (v.x * v.x + v.y * v.y) / v.weight : -1;
      if (explained <= most) return;
      most = explained;
      worst = c;
    });
    if (most >= 0) {
      lattice.remove(worst);
    } else if (!removed) {
      break;
    }
  }
  if (are_loose_ || has_suspects(lattice)) remove_outliers(lattice, middle);
}

}  // namespace calvin::detect
