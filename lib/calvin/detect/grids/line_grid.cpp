// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Crossings in the level of the image that shows most of them, and their fits at full resolution.

#include "calvin/detect/grids/line_grid.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "calvin/detect/checkerboard/corners/grey_at.hpp"
#include "calvin/detect/grids/crossing_fit.hpp"
#include "calvin/detect/grids/crossing_points.hpp"
#include "calvin/detect/grids/grid_lattice.hpp"

namespace calvin::detect {

namespace {

// The largest lattice of crossings of any level, in px of the image.
std::optional<DiscLattice> find_lattice(Pyramid& pyramid, bool light, const std::stop_token& stop) {
  constexpr std::size_t kMost = 10000;
  std::optional<DiscLattice> best;
  for (int level = 0; level < pyramid.levels() && !stop.stop_requested(); ++level) {
    auto circles = circles_about(find_crossings(pyramid.calm_level(level), light, kMost));
    const double scale = 1 << level;
    for (Ellipse& e : circles) {
      e.x = static_cast<double>(Pyramid::to_image(static_cast<float>(e.x), level));
      e.y = static_cast<double>(Pyramid::to_image(static_cast<float>(e.y), level));
      for (double* square : {&e.xx, &e.xy, &e.yy}) *square *= scale * scale;
    }
    auto lattice = grid_lattice(circles, image_center(pyramid.level(0).size()), stop);
    if (lattice && (!best || lattice->count() > best->count())) best = std::move(lattice);
  }
  return best;
}

// Whether lines are as dark half way between crossings as there, but for blur: the dark squares of
// a checkerboard, which lie on a lattice along its diagonals, only touch.
bool are_lines(const ImageView& image, const DiscLattice& lattice) {
  constexpr float kDark = 0.65F;  // of the way from the ground in the middle of a cell
  const auto middle = [&](const Ellipse& a, const Ellipse& b) {
    return grey_at(image, static_cast<float>((a.x + b.x) / 2), static_cast<float>((a.y + b.y) / 2));
  };
  int dark = 0;
  int pairs = 0;
  for (const Cell c : lattice.cells()) {
    const Ellipse& here = *lattice.at(c);
    const Ellipse* next = lattice.at(c + Cell{1, 0});
    const Ellipse* below = lattice.at(c + Cell{0, 1});
    if (next == nullptr || below == nullptr) continue;
    const auto own = middle(here, here);
    const auto ground = middle(*next, *below);
    for (const Ellipse* end : {next, below}) {
      const auto line = middle(here, *end);
      if (!own || !ground || !line) continue;
      ++pairs;
      dark += (*line - *ground) / (*own - *ground) > kDark ? 1 : 0;
    }
  }
  return 2 * dark > pairs;
}

// The fits of the crossings of a lattice, and of those that it lets expect.
class Crossings {
 public:
  Crossings(const ImageView& image, DiscLattice lattice, bool light)
      : image_(image), lattice_(std::move(lattice)), light_(light) {}

  void fit() {
    const std::vector<Cell> cells = lattice_.cells();
    for (const Cell c : cells) {
      const Ellipse start = *lattice_.at(c);
      if (!fit_one(c, start)) lattice_.remove(c);
    }
    drop_vague();
  }
  // Adds crossings within the extent and one step beyond it; false where there are none.
  bool grow() {
    const std::size_t before = fits_.size();
    const CellRange range = lattice_.extent();
    for (int row = range.first.row - 1; row <= range.last.row + 1; ++row) {
      for (int col = range.first.col - 1; col <= range.last.col + 1; ++col) {
        const Cell c{col, row};
        if (!lattice_.in_reach(c) || lattice_.at(c) != nullptr) continue;
        if (const auto expected = lattice_.expect(c)) fit_one(c, expected->disc);
      }
    }
    drop_vague();
    return fits_.size() > before;
  }

  [[nodiscard]] bool lie_on_lines() const { return are_lines(image_, lattice_); }

  [[nodiscard]] Observation observe(const Grid& grid) {
    Observation seen;
    std::ranges::sort(fits_, {}, [](const Fitted& f) { return std::pair(f.cell.row, f.cell.col); });
    for (const Fitted& f : fits_) {
      constexpr int kMiddle = UnboundedGrid::kSide / 2;
      seen.ids.push_back(grid.id({f.cell.col + kMiddle, f.cell.row + kMiddle}));
      seen.uv.push_back(f.fit.at);
      seen.sigma.push_back(f.fit.sigma);
    }
    return seen;
  }

 private:
  struct Fitted {
    Cell cell;
    CrossingFit fit;
  };

  // From a crossing to the next one of a row or column, by its neighbours.
  [[nodiscard]] std::optional<Eigen::Vector2d> step_at(Cell c, Cell way,
                                                       const Ellipse& here) const {
    const Ellipse* next = lattice_.at(c + way);
    const Ellipse* last = lattice_.at(c - way);
    if (next == nullptr && last == nullptr) return std::nullopt;
    if (next == nullptr) return Eigen::Vector2d(here.x - last->x, here.y - last->y);
    if (last == nullptr) return Eigen::Vector2d(next->x - here.x, next->y - here.y);
    return Eigen::Vector2d(next->x - last->x, next->y - last->y) / 2;
  }

  bool fit_one(Cell c, const Ellipse& start) {
    const auto along = step_at(c, {1, 0}, start);
    const auto down = step_at(c, {0, 1}, start);
    if (!along || !down) return false;
    const auto found = fit_crossing(image_, {start.x, start.y}, *along, *down, light_);
    if (!found) return false;
    Ellipse there = start;
    there.x = found->at.u;
    there.y = found->at.v;
    lattice_.put(c, there);
    fits_.push_back({c, *found});
    return true;
  }

  // Takes out crossings of which the lines are much less even than those of the others.
  void drop_vague() {
    constexpr double kMuchMore = 6;  // of the median
    constexpr double kAlways = 0.1;  // px: far away lines have few pixels
    if (fits_.empty()) return;
    std::vector<double> sigmas;
    for (const Fitted& f : fits_) sigmas.push_back(f.fit.sigma);
    const auto middle = sigmas.begin() + static_cast<std::ptrdiff_t>(sigmas.size() / 2);
    std::ranges::nth_element(sigmas, middle);
    std::erase_if(fits_, [&](const Fitted& f) {
      if (f.fit.sigma <= kMuchMore * *middle + kAlways) return false;
      lattice_.remove(f.cell);
      return true;
    });
  }

  const ImageView& image_;
  DiscLattice lattice_;
  bool light_;
  std::vector<Fitted> fits_;
};

}  // namespace

Observation find_line_grid(Pyramid& pyramid, const UnboundedGrid& grid,
                           const std::stop_token& stop) {
  auto lattice = find_lattice(pyramid, grid.inverted, stop);
  if (!lattice || stop.stop_requested()) return {};
  Crossings crossings(pyramid.level(0), *std::move(lattice), grid.inverted);
  crossings.fit();
  for (int i = 0; i < kGridReach && !stop.stop_requested() && crossings.grow(); ++i) {
  }
  if (stop.stop_requested() || !crossings.lie_on_lines()) return {};
  return crossings.observe(grid.grid());
}

}  // namespace calvin::detect
