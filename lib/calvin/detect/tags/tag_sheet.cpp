// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Grows a sheet from tag to tag by homographies of the nearest ones.

#include "calvin/detect/tags/tag_sheet.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>
#include <utility>

#include "calvin/detect/checkerboard/code/evidence.hpp"
#include "calvin/detect/tags/corner_scatter.hpp"
#include "calvin/geometry/homography.hpp"

namespace calvin::detect {

namespace {

Pixel pixel_of(const Point& p) { return {p.x(), p.y()}; }
Point point_of(const Pixel& p) { return {p.u, p.v}; }

bool is_inside(const Quad& quad, ImageSize size, double margin) {
  return std::ranges::all_of(quad, [&](const Point& p) {
    return p.x() >= margin && p.y() >= margin && p.x() <= size.width - 1 - margin &&
           p.y() <= size.height - 1 - margin;
  });
}

// px, how far the gap between two tags is not what their sides say: the second one is to the right
// of the first one, or below it. `gap` in sides of a tag.
double gap_error(const Quad& first, const Quad& second, bool below, double gap) {
  const std::size_t after = below ? 3 : 1;
  const auto off = [&](std::size_t from, std::size_t to) {
    const Point sides = (first[to] - first[from]) + (second[to] - second[from]);
    return (second[from] - first[to] - 0.5 * gap * sides).norm();
  };
  return std::max(off(0, after), off(below ? 1 : 3, 2));
}

double median_of(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

}  // namespace

bool TagSheet::has(GridPlace place) const {
  return std::ranges::find(tags_, place, &SheetTag::place) != tags_.end();
}

// Whether the sheet has a tag within two columns and rows.
bool TagSheet::is_beside(GridPlace place) const {
  constexpr int kNear = 2;
  return std::ranges::any_of(tags_, [&](const SheetTag& t) {
    return std::abs(t.place.col - place.col) <= kNear && std::abs(t.place.row - place.row) <= kNear;
  });
}

// The corners of a tag in the board frame, in sides of a tag.
Quad TagSheet::on_board(GridPlace place) const {
  const Grid grid = board_->grid();
  const double left = grid.distance_to(2 * place.col) / grid.pitch;
  const double top = grid.distance_to(2 * place.row) / grid.pitch;
  return {Point(left, top), Point(left + 1, top), Point(left + 1, top + 1), Point(left, top + 1)};
}

// With the tags that the board has around it.
TagPattern TagSheet::pattern(const TagReader& reader, GridPlace place) const {
  TagPattern tag = reader.pattern_of(board_->tag_in(place.col, place.row));
  if (tag.outside() > 0) return tag;  // its neighbours lie farther away than its own bits
  tag.gap = board_->gap / board_->tag * board_->cells();
  tag.neighbours = {place.row > 0, place.col + 1 < board_->cols, place.row + 1 < board_->rows,
                    place.col > 0};
  return tag;
}

// Where a tag is by the nearest ones.
std::optional<Quad> TagSheet::expect(GridPlace place) const {
  constexpr std::size_t kNearest = 5;  // tags
  std::vector<const SheetTag*> near;
  for (const SheetTag& t : tags_) near.push_back(&t);
  const auto far = [place](const SheetTag* t) {
    const int col = t->place.col - place.col;
    const int row = t->place.row - place.row;
    return std::pair(col * col + row * row, t->place.row * 1000 + t->place.col);
  };
  std::ranges::sort(near, {}, far);
  near.resize(std::min(near.size(), kNearest));
  std::vector<Pixel> plane;
  std::vector<Pixel> image;
  for (const SheetTag* t : near) {
    const Quad corners = on_board(t->place);
    for (std::size_t i = 0; i < 4; ++i) {
      plane.push_back(pixel_of(corners[i]));
      image.push_back(pixel_of(t->fit.corners[i]));
    }
  }
  const auto h = fit_homography(plane, image);
  if (!h) return std::nullopt;
  Quad expected;
  const Quad corners = on_board(place);
  for (std::size_t i = 0; i < 4; ++i) {
    expected[i] = point_of(transform(*h, pixel_of(corners[i])));
    if (!expected[i].allFinite()) return std::nullopt;
  }
  if (!is_convex(expected)) return std::nullopt;
  return expected;
}

// Whether a tag lies as the board says: beside its direct neighbours, by the gap between them,
// whatever the lens; without one, where the nearest tags let it be expected.
bool TagSheet::fits(GridPlace place, const Quad& corners) const {
  constexpr double kOff = 0.2;  // of the shortest side
  const double gap = board_->gap / board_->tag;
  int near = 0;
  int right = 0;
  for (const SheetTag& t : tags_) {
    const int cols = place.col - t.place.col;
    const int rows = place.row - t.place.row;
    if (std::abs(cols) + std::abs(rows) != 1) continue;
    ++near;
    const bool is_first = cols + rows < 0;
    const Quad& first = is_first ? corners : t.fit.corners;
    const Quad& second = is_first ? t.fit.corners : corners;
    right += gap_error(first, second, rows != 0, gap) <
                     kOff * std::max(gap, 1.0) * shortest_side(corners)
                 ? 1
                 : 0;
  }
  if (near > 0) return 2 * right > near;
  const auto expected = expect(place);
  if (!expected) return false;
  double off = 0;
  for (std::size_t k = 0; k < 4; ++k) off = std::max(off, (corners[k] - (*expected)[k]).norm());
  return off <= kOff * shortest_side(*expected);
}

void TagSheet::grow(std::span<const ReadTag> tags, std::size_t seed) {
  tags_ = {{*board_->place_of(tags[seed].id), seed, true, tags[seed].fit, std::nullopt}};
  for (bool grown = true; grown;) {
    grown = false;
    for (std::size_t i = 0; i < tags.size(); ++i) {
      const auto place = board_->place_of(tags[i].id);
      if (tags[i].taken || !place || has(*place) || !is_beside(*place)) continue;
      if (!fits(*place, tags[i].fit.corners)) continue;
      tags_.push_back({*place, i, true, tags[i].fit, std::nullopt});
      grown = true;
    }
  }
}

// Takes a tag where its sides and its bits are.
bool TagSheet::take_if_seen(const ImageView& image, const TagReader& reader,
                            const PlacedQuad& expected, const TagBends& bends, double reach) {
  constexpr double kSmallSigma = 0.3;  // px
  constexpr double kLeastBits = 5;     // nats; a tag at another place is none of these
  constexpr double kOfOthers = 0.7;    // of the bits: as many are alike by chance
  const TagPattern tag = pattern(reader, expected.place);
  const double width = tags_.empty() ? kUsualWidth : tags_.back().fit.width;
  const TagFit fit = fit_tag(image, expected.corners, tag, reach, bends, width);
  if (fit.sides < 2 || fit.seen() < 1) return false;
  const bool is_clear = std::ranges::all_of(fit.sigma, [](double s) { return s < kSmallSigma; });
  const TagMatch match = reader.match(image, fit.corners, tag);
  const bool has_border = is_clear && match.border_right >= kLeastRight * match.border_seen;
  // One that is cut by the border of the image shows what it is badly.
  if (has_border && fit.seen() == 4 && match.right < kOfOthers * match.seen) ++others_;
  const double by_bits = evidence_of(match.seen, match.right);
  const double by_border = evidence_of(match.border_seen, match.border_right);
  if (!has_border || match.right < kLeastRight * match.seen ||
      by_bits + by_border < kLeastEvidence) {
    return false;
  }
  tags_.push_back({expected.place, std::nullopt, by_bits >= kLeastBits, fit, expected.bends});
  return true;
}

bool TagSheet::look_at(const ImageView& image, const TagReader& reader, GridPlace place,
                       const LensMap* map) {
  constexpr double kReach = 0.08;   // of the shortest side
  constexpr double kLeastSide = 8;  // px
  const auto expected = map != nullptr ? image_of(*map, place) : expect(place);
  if (!expected ||
      std::ranges::none_of(*expected, [&](const Point& p) { return is_in(image, p); })) {
    return false;
  }
  const double side = shortest_side(*expected);
  if (side < kLeastSide) return false;
  const TagBends bends = map != nullptr ? bends_of(*map, place, true) : unknown_bends(*expected);
  return take_if_seen(image, reader, {place, *expected, std::nullopt}, bends,
                      std::max(kReach * side, 1.0));
}

bool TagSheet::follow(const ImageView& image, const TagReader& reader,
                      std::span<const PlacedQuad> expected) {
  constexpr double kReach = 0.8;  // of a cell: what is farther away may be another edge
  for (const PlacedQuad& tag : expected) {
    const double cell = shortest_side(tag.corners) / board_->cells();
    const TagBends bends = tag.bends.value_or(unknown_bends(tag.corners));
    if (!take_if_seen(image, reader, tag, bends, std::max(kReach * cell, 1.0))) return false;
  }
  return !tags_.empty() && certain_tags() > 0;
}

int TagSheet::certain_tags() const {
  return static_cast<int>(std::ranges::count(tags_, true, &SheetTag::is_certain));
}

void TagSheet::complete(const ImageView& image, const TagReader& reader, const LensMap* map) {
  std::set<std::pair<int, int>> looked;
  for (bool grown = true; grown;) {
    grown = false;
    for (int row = 0; row < board_->rows; ++row) {
      for (int col = 0; col < board_->cols; ++col) {
        const GridPlace place{col, row};
        if (has(place) || !is_beside(place) || !looked.insert({col, row}).second) continue;
        grown = look_at(image, reader, place, map) || grown;
      }
    }
  }
}

// From the board, in sides of a tag, to the image; absent where few tags are seen.
std::optional<LensMap> TagSheet::map(ImageSize size) const {
  constexpr std::size_t kFewest = 12;  // corners
  constexpr double kMostMisfit = 0.1;  // of a tag's side: light may have run over all sides
  std::vector<Pixel> plane;
  std::vector<Pixel> seen;
  for (const SheetTag& t : tags_) {
    const Quad corners = on_board(t.place);
    for (std::size_t i = 0; i < 4; ++i) {
      if (t.fit.sigma[i] == 0) continue;
      plane.push_back(pixel_of(corners[i]));
      seen.push_back(pixel_of(t.fit.corners[i]));
    }
  }
  if (plane.size() < kFewest) return std::nullopt;
  auto found = LensMap::fit(plane, seen, image_center(size));
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

// Those from a place in the list on.
void TagSheet::fit_again(const ImageView& image, const TagReader& reader, const LensMap& map,
                         std::size_t from) {
  constexpr double kReach = 1;  // px
  for (std::size_t k = from; k < tags_.size(); ++k) {
    SheetTag& t = tags_[k];
    const bool was_known = t.bends.has_value();
    t.bends = bends_of(map, t.place, t.fit.seen() < 4);
    if (was_known) continue;  // bends change little from frame to frame
    const TagFit again =
        fit_tag(image, t.fit.corners, pattern(reader, t.place), kReach, *t.bends, t.fit.width);
    if (again.seen() >= t.fit.seen()) t.fit = again;
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
  const double most = kVague * median_of(std::move(sigmas));
  for (SheetTag& t : tags_) {
    for (double& sigma : t.fit.sigma) sigma = sigma > most ? 0 : sigma;
  }
}

void TagSheet::refine(const ImageView& image, const TagReader& reader) {
  const auto first = map(image.size());
  if (!first) return;
  fit_again(image, reader, *first, 0);
  // Tags that the border of the image cuts are found by the lens, not by their neighbours.
  const std::size_t before = tags_.size();
  complete(image, reader, &*first);
  drop_vague_corners();
  const auto second = tags_.size() > before ? map(image.size()) : std::nullopt;
  if (second) fit_again(image, reader, *second, before);
  compare_corners(second ? *second : *first);
}

double TagSheet::mean_side() const {
  double sum = 0;
  for (const SheetTag& t : tags_) sum += shortest_side(t.fit.corners);
  return sum / static_cast<double>(std::max<std::size_t>(tags_.size(), 1));
}

Point TagSheet::centre() const {
  Point sum = Point::Zero();
  for (const SheetTag& t : tags_) sum += centre_of(t.fit.corners);
  return sum / static_cast<double>(std::max<std::size_t>(tags_.size(), 1));
}

double TagSheet::evidence(std::span<const ReadTag> read, const TagReader& reader,
                          std::size_t quads) const {
  // Any tag of the board may have been the first, any way round.
  double sum = -std::log(4.0 * board_->cols * board_->rows) -
               std::log(static_cast<double>(std::max<std::size_t>(quads, 1)));
  for (const SheetTag& t : tags_) {
    if (t.read) sum += reader.evidence(read[*t.read].wrong);
  }
  return sum;
}

bool TagSheet::is_complete(ImageSize size) const {
  for (int row = 0; row < board_->rows; ++row) {
    for (int col = 0; col < board_->cols; ++col) {
      if (has({col, row})) continue;
      const auto expected = expect({col, row});
      if (!expected || is_inside(*expected, size, 2)) return false;
    }
  }
  return true;
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
