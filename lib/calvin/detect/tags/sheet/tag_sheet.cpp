// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Grows a sheet from tag to tag by homographies of the nearest ones.

#include "calvin/detect/tags/sheet/tag_sheet.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "calvin/detect/checkerboard/code/evidence.hpp"
#include "calvin/geometry/homography.hpp"

namespace calvin::detect {

namespace {

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
bool TagSheet::take_if_seen(const ImageView& image, const TagReader& reader, GridPlace place,
                            const TagGuess& guess) {
  constexpr double kSmallSigma = 0.3;  // px
  constexpr double kLeastBits = 5;     // nats; a tag at another place is none of these
  constexpr double kOfOthers = 0.7;    // of the bits: as many are alike by chance
  const TagPattern tag = pattern(reader, place);
  const TagFit fit = fit_tag(image, guess, tag);
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
  tags_.push_back({place, std::nullopt, by_bits >= kLeastBits, fit, std::nullopt});
  return true;
}

bool TagSheet::look_at(const ImageView& image, const TagReader& reader, GridPlace place,
                       const LensMap* map) {
  constexpr double kReach = 0.08;      // of the shortest side
  constexpr double kSmallestSide = 8;  // px
  const auto expected = map != nullptr ? image_of(*map, place) : expect(place);
  if (!expected ||
      std::ranges::none_of(*expected, [&](const Point& p) { return is_in(image, p); })) {
    return false;
  }
  const double side = shortest_side(*expected);
  if (side < kSmallestSide) return false;
  TagGuess guess{*expected, std::max(kReach * side, 1.0), unknown_bends(*expected), width()};
  if (map != nullptr) guess.bends = bends_of(*map, place, true);
  guess.care = SideCare::kRough;
  return take_if_seen(image, reader, place, guess);
}

bool TagSheet::follow(const ImageView& image, const TagReader& reader,
                      std::span<const PlacedQuad> expected) {
  constexpr double kReach = 0.8;  // of a cell: what is farther away may be another edge
  for (const PlacedQuad& tag : expected) {
    const double cell = shortest_side(tag.corners) / board_->cells();
    const TagGuess guess{tag.corners, std::max(kReach * cell, 1.0),
                         tag.bends.value_or(unknown_bends(tag.corners)), width()};
    if (!take_if_seen(image, reader, tag.place, guess)) return false;
    tags_.back().bends = tag.bends;
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

// The blur of one tag is likely to be that of the next.
double TagSheet::width() const { return tags_.empty() ? kUsualWidth : tags_.back().fit.width; }

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

}  // namespace calvin::detect
