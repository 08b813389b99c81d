// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The corners of a sheet: fitted again with what all of them tell of the lens, and compared.

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "calvin/detect/tags/sheet/corner_scatter.hpp"
#include "calvin/detect/tags/sheet/tag_sheet.hpp"
#include "calvin/geometry/median.hpp"

namespace calvin::detect {

// From the board, in sides of a tag, to the image; absent where few tags are seen.
std::optional<LensMap> TagSheet::map(ImageSize size) const {
  constexpr std::size_t kFewest = 12;  // corners
  constexpr double kMostMisfit = 0.1;  // of a tag's side: light may have run over all sides
  constexpr double kRough = 2.5;       // times less is known of a corner that was fitted roughly
  std::vector<Pixel> plane;
  std::vector<Pixel> seen;
  double square = 0;
  for (const SheetTag& t : tags_) {
    const Quad corners = on_board(t.place);
    for (std::size_t i = 0; i < 4; ++i) {
      if (t.fit.sigma[i] == 0) continue;
      square += std::pow((t.fit.is_rough ? kRough : 1) * t.fit.sigma[i], 2);
      plane.push_back(pixel_of(corners[i]));
      seen.push_back(pixel_of(t.fit.corners[i]));
    }
  }
  if (plane.size() < kFewest) return std::nullopt;
  const double sigma = std::sqrt(square / static_cast<double>(plane.size()));
  auto found = LensMap::fit(plane, seen, image_center(size), sigma);
  if (found && found->misfit() > kMostMisfit * mean_side()) return std::nullopt;
  return found;
}

// The corners of a tag, seen or not.
std::optional<Quad> TagSheet::image_of(const LensMap& map, GridPlace place) const {
  Quad corners = on_board(place);
  for (Point& p : corners) p = point_of(map.image_of(pixel_of(p)));
  if (!is_convex(corners)) return std::nullopt;
  return corners;
}

// The map knows bends well where it was made, and less well outside.
TagBends TagSheet::bends_of(const LensMap& map, GridPlace place, bool is_outside) const {
  constexpr double kShare = 0.1;  // of a bend, 1 sigma
  constexpr double kShareOutside = 0.5;
  constexpr double kLeast = 0.004;  // px
  constexpr double kLeastOutside = 0.1;
  const Quad corners = on_board(place);
  TagBends bends;
  for (std::size_t i = 0; i < 4; ++i) {
    const Point& a = corners[i];
    const Point& b = corners[(i + 1) % 4];
    const Point from = point_of(map.image_of(pixel_of(a)));
    const Point to = point_of(map.image_of(pixel_of(b)));
    const Point middle = point_of(map.image_of(pixel_of(0.5 * (a + b))));
    const Point along = (to - from).normalized();
    bends.at[i] = Point(along.y(), -along.x()).dot(middle - 0.5 * (from + to));
    bends.sigma[i] = is_outside ? kShareOutside * std::abs(bends.at[i]) + kLeastOutside
                                : kShare * std::abs(bends.at[i]) + kLeast;
  }
  return bends;
}

// Those from a place in the list on; without a map those that were fitted roughly.
void TagSheet::fit_again(const ImageView& image, const TagReader& reader, const LensMap* map,
                         std::size_t from) {
  constexpr double kReach = 1;  // px
  for (std::size_t k = from; k < tags_.size(); ++k) {
    SheetTag& t = tags_[k];
    const bool was_known = t.bends.has_value();
    const bool is_whole = t.fit.seen() == 4;
    if (map != nullptr) t.bends = bends_of(*map, t.place, !is_whole);
    if (was_known) continue;  // bends change little from frame to frame
    const TagPattern tag = pattern(reader, t.place);
    const TagGuess guess{t.fit.corners, kReach, unknown_bends(t.fit.corners), t.fit.width};
    if (map != nullptr) {
      TagGuess with_bends = guess;
      with_bends.bends = *t.bends;
      if (t.fit.is_rough && is_whole) with_bends.care = SideCare::kAgain;
      // The other tags tell better where a corner is that was not found.
      if (!is_whole) with_bends.corners = image_of(*map, t.place).value_or(t.fit.corners);
      const TagFit again = fit_tag(image, with_bends, tag);
      if (again.seen() >= t.fit.seen()) t.fit = again;
    }
    if (t.fit.is_rough) t.fit = fit_tag(image, guess, tag);
  }
}

// Takes off what light that runs over sides has moved, and corners that do not lie as the others.
void TagSheet::compare_corners(const LensMap& map) {
  constexpr double kMostGrowth = 0.35;  // of a cell, or of a gap
  std::vector<SheetCorner> all;
  std::vector<std::pair<std::size_t, std::size_t>> places;  // tag, and which of its corners
  double most = 1e9;
  const double scale = mean_side();
  for (std::size_t k = 0; k < tags_.size(); ++k) {
    const SheetTag& t = tags_[k];
    const double side = shortest_side(t.fit.corners);
    most = std::min(
        most, kMostGrowth * side * std::min(1.0 / board_->cells(), board_->gap / board_->tag));
    const Quad corners = on_board(t.place);
    for (std::size_t i = 0; i < 4; ++i) {
      if (t.fit.sigma[i] == 0) continue;
      const Point& at = t.fit.corners[i];
      const Point before = (at - t.fit.corners[(i + 3) % 4]).normalized();
      const Point after = (at - t.fit.corners[(i + 1) % 4]).normalized();
      SheetCorner corner;
      corner.plane = pixel_of(corners[i]);
      corner.image = pixel_of(at);
      corner.sigma = t.fit.sigma[i];
      // Sides at an angle meet farther away.
      corner.outwards = (before + after) / std::max(std::abs(cross(before, after)), 0.1);
      const Point outside = corners[i] + (corners[i] - corners[(i + 2) % 4]) / scale;
      corner.outwards_plane =
          point_of(map.image_of(pixel_of(outside))) - point_of(map.image_of(corner.plane));
      all.push_back(corner);
      places.emplace_back(k, i);
    }
  }
  const auto scatter = corner_scatter(all, map, most);
  if (!scatter) return;
  scatter_ = scatter->factor;
  for (std::size_t i = 0; i < all.size(); ++i) {
    TagFit& fit = tags_[places[i].first].fit;
    fit.corners[places[i].second] -= scatter->growth[i];
    if (all[i].is_off) fit.sigma[places[i].second] = 0;
  }
}

// Takes off corners of which far less is known than of the others: those of sides that are hardly
// in view.
void TagSheet::drop_vague_corners() {
  constexpr double kVague = 6;  // times the usual sigma
  std::vector<double> sigmas;
  for (const SheetTag& t : tags_) {
    std::ranges::copy_if(t.fit.sigma, std::back_inserter(sigmas), [](double s) { return s > 0; });
  }
  if (sigmas.empty()) return;
  const double most = kVague * median_of(std::move(sigmas));
  for (SheetTag& t : tags_) {
    for (double& sigma : t.fit.sigma) sigma = sigma > most ? 0 : sigma;
  }
}

void TagSheet::refine(const ImageView& image, const TagReader& reader) {
  const auto first = map(image.size());
  fit_again(image, reader, first ? &*first : nullptr, 0);
  if (!first) return;
  // Tags that the border of the image cuts are found by the lens, not by their neighbours.
  const std::size_t before = tags_.size();
  complete(image, reader, &*first);
  drop_vague_corners();
  const auto second = tags_.size() > before ? map(image.size()) : std::nullopt;
  const LensMap& best = second ? *second : *first;
  fit_again(image, reader, &best, before);
  compare_corners(best);
}

Observation TagSheet::observe() const {
  Observation seen;
  const Grid grid = board_->grid();
  std::vector<std::pair<int, std::pair<Pixel, double>>> all;
  std::vector<double> widths;
  for (const SheetTag& t : tags_) {
    widths.push_back(t.fit.width);
    for (std::size_t i = 0; i < 4; ++i) {
      if (t.fit.sigma[i] == 0) continue;
      const int right = i == 1 || i == 2 ? 1 : 0;
      const int down = i >= 2 ? 1 : 0;
      const int id = grid.id({2 * t.place.col + right, 2 * t.place.row + down});
      all.push_back({id, {pixel_of(t.fit.corners[i]), scatter_ * t.fit.sigma[i]}});
    }
  }
  std::ranges::sort(all, {}, [](const auto& point) { return point.first; });
  for (const auto& [id, point] : all) {
    seen.ids.push_back(id);
    seen.uv.push_back(point.first);
    seen.sigma.push_back(point.second);
  }
  seen.blur = median_of(std::move(widths));
  return seen;
}

}  // namespace calvin::detect
