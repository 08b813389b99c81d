// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Brightness profiles across the outermost line of corners, and what they say of the margin.

#include "calvin/detect/checkerboard/board_edge.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "calvin/detect/checkerboard/corners/grey_at.hpp"

namespace calvin::detect {

namespace {

// A profile runs from kFrom to the first of kTo (squares beyond the line) that finds an edge.
constexpr int kSamples = 27;  // of a profile
constexpr float kFrom = 0.3F;
constexpr float kTo[] = {1.6F, 1.3F, 1.12F, 1.05F};
constexpr float kLeastMargin = 3;  // px of a profile beyond a square's end
constexpr float kMargin =
    0.45F;  // share of the way from a square's end to the profile's: margin from there
constexpr float kEdgeFrom = 0.8F;  // squares beyond the line, between which the last row may end
constexpr float kEdgeTo = 1.25F;
constexpr float kMostRagged = 0.15F;    // squares, between the nearest end and the farthest
constexpr float kDiffers = 0.65F;       // of the contrast: more is another colour
constexpr float kSame = 0.3F;           // of the contrast: less is the same colour
constexpr float kLeastSeen = 0.5F;      // of the line's squares; a finger hides behind fewer
constexpr std::size_t kLeastEnds = 2;   // squares that differ from the margin
constexpr float kLeastAgreeing = 0.8F;  // of the squares in view that are as they should

struct Point {
  float x = 0;
  float y = 0;
};

std::optional<float> grey(const ImageView& image, Point p) { return grey_at(image, p.x, p.y); }

// The place of the next node outwards of a line, extrapolated from its last two nodes, or from
// three where they are there.
std::optional<Point> next_node(const Lattice& lattice, Cell cell, Cell outwards, int nodes = 3) {
  if (!lattice.has(cell) || !lattice.has(cell - outwards)) return std::nullopt;
  const Node& a = lattice.at(cell);
  const Node& b = lattice.at(cell - outwards);
  Point p = {2 * a.x - b.x, 2 * a.y - b.y};
  if (nodes == 3 && lattice.has(cell - 2 * outwards)) {
    const Node& c = lattice.at(cell - 2 * outwards);
    p = {3 * a.x - 3 * b.x + c.x, 3 * a.y - 3 * b.y + c.y};
  }
  return p;
}

struct Profile {
  float inside = 0;   // grey levels of the square
  float outside = 0;  // of what lies beyond it
  float end = 0;      // where the colour changes, squares beyond the line
};

// The profile outwards through the middle of the square between two nodes of the line.
std::optional<Profile> profile(const ImageView& image, const Lattice& lattice, Cell cell, Cell step,
                               Cell outwards, float reach) {
  const auto a = next_node(lattice, cell, outwards);
  const auto b = next_node(lattice, cell + step, outwards);
  if (!a || !b) return std::nullopt;
  const Node& na = lattice.at(cell);
  const Node& nb = lattice.at(cell + step);
  const Point from = {0.5F * (na.x + nb.x), 0.5F * (na.y + nb.y)};
  const Point way = {0.5F * (a->x + b->x) - from.x, 0.5F * (a->y + b->y) - from.y};
  if ((reach - 1) * std::hypot(way.x, way.y) < kLeastMargin) return std::nullopt;
  std::array<float, kSamples> t{};
  std::array<float, kSamples> v{};
  Profile p;
  float inner = 0;
  float outer = 0;
  for (std::size_t i = 0; i < kSamples; ++i) {
    t[i] = kFrom + (reach - kFrom) * static_cast<float>(i) / (kSamples - 1);
    const auto g = grey(image, {from.x + t[i] * way.x, from.y + t[i] * way.y});
    if (!g) return std::nullopt;
    v[i] = *g;
    if (t[i] < 0.7F) {
      p.inside += v[i];
      inner += 1;
    } else if (t[i] > 1 + kMargin * (reach - 1)) {
      p.outside += v[i];
      outer += 1;
    }
  }
  p.inside /= inner;
  p.outside /= outer;
  const float middle = 0.5F * (p.inside + p.outside);
  for (std::size_t i = 1; i < kSamples; ++i) {
    if ((v[i - 1] < middle) != (v[i] < middle)) {
      p.end = t[i];
      break;
    }
  }
  return p;
}

// Whether the board ends beyond a line, by profiles of `reach` squares.
Edge edge_within(const ImageView& image, const Lattice& lattice, Cell first, Cell step, int count,
                 Cell outwards, float reach) {
  // The squares of one colour: [0] those of even cells, [1] those of odd cells.
  struct Squares {
    std::size_t ending = 0;
    std::size_t continuing = 0;
    float brightness = 0;  // of squares that end less that of the margin, summed
    float from = kEdgeTo;  // the nearest and the farthest end
    float to = kEdgeFrom;
  };
  std::array<Squares, 2> colours;
  int seen = 0;
  for (int i = 0; i + 1 < count; ++i) {
    const Cell cell = first + i * step;
    if (!lattice.has(cell) || !lattice.has(cell + step)) continue;
    const auto p = profile(image, lattice, cell, step, outwards, reach);
    if (!p) continue;
    ++seen;
    const float contrast = std::max(lattice.at(cell).contrast, 1.0F);
    const float differs = std::abs(p->outside - p->inside) / contrast;
    Squares& squares = colours[static_cast<std::size_t>(i & 1)];
    if (differs < kSame) ++squares.continuing;
    if (differs <= kDiffers || p->end <= kEdgeFrom || p->end >= kEdgeTo) continue;
    ++squares.ending;
    squares.brightness += p->inside - p->outside;
    squares.from = std::min(squares.from, p->end);
    squares.to = std::max(squares.to, p->end);
  }
  if (static_cast<float>(seen) < kLeastSeen * static_cast<float>(count - 1)) return Edge::kNotSeen;
  for (std::size_t k = 0; k < 2; ++k) {
    const Squares& squares = colours[k];
    const std::size_t others = colours[1 - k].continuing;
    if (squares.ending >= kLeastEnds && others >= 1 && squares.to - squares.from < kMostRagged &&
        static_cast<float>(squares.ending + others) >= kLeastAgreeing * static_cast<float>(seen)) {
      return squares.brightness > 0 ? Edge::kDarkMargin : Edge::kBrightMargin;
    }
  }
  return Edge::kNotSeen;
}

// The square between two nodes of a line, and how far it goes on beyond the line: to where its
// level has gone a third of the way to that of the square on the other side of the line.
struct OuterSquare {
  Point from;       // in the line, the middle of its side
  Point way;        // a square's length outwards
  float own = 0;    // grey levels of the square
  float other = 0;  // and of the one on the other side
  float end = 0;    // squares beyond the line; the length of the profile, or up to the border of
                    // the image, where it does not end
  [[nodiscard]] float contrast() const { return std::abs(other - own); }
  [[nodiscard]] float pixel() const { return 1 / std::max(std::hypot(way.x, way.y), 1.0F); }
  [[nodiscard]] std::optional<float> level(const ImageView& image, float t) const {
    return grey(image, {from.x + t * way.x, from.y + t * way.y});
  }
  // How much of the way to the other colour there is between two levels, grey levels.
  [[nodiscard]] float change(float before, float after) const {
    return other > own ? after - before : before - after;
  }
};

// The mean of four samples between two shares of the way, squares beyond the line.
std::optional<float> level_between(const ImageView& image, const OuterSquare& square, float begin,
                                   float end) {
  float sum = 0;
  for (int i = 0; i < 4; ++i) {
    const auto g = square.level(image, begin + (end - begin) * static_cast<float>(i) / 3);
    if (!g) return std::nullopt;
    sum += *g / 4;
  }
  return sum;
}

std::optional<OuterSquare> outer_square(const ImageView& image, const Lattice& lattice, Cell cell,
                                        Cell step, Cell outwards, int nodes) {
  constexpr float kBegin = 0.15F;  // squares: beyond the blur of the line
  constexpr float kLevel = 0.3F;
  constexpr float kEnd = 1.6F;
  constexpr int kSteps = 58;
  constexpr float kStep = (kEnd - kBegin) / kSteps;
  constexpr float kLeaves = 0.35F;  // of the contrast
  const auto a = next_node(lattice, cell, outwards, nodes);
  const auto b = next_node(lattice, cell + step, outwards, nodes);
  if (!a || !b) return std::nullopt;
  const Node& na = lattice.at(cell);
  const Node& nb = lattice.at(cell + step);
  OuterSquare square;
  square.from = {0.5F * (na.x + nb.x), 0.5F * (na.y + nb.y)};
  square.way = {0.5F * (a->x + b->x) - square.from.x, 0.5F * (a->y + b->y) - square.from.y};
  const auto own = level_between(image, square, kBegin, kLevel);
  const auto other = level_between(image, square, -kLevel, -kBegin);
  if (!own || !other) return std::nullopt;
  square.own = *own;
  square.other = *other;
  const float least = kLeaves * square.contrast();
  float before = 0;
  for (int i = 1; i <= kSteps; ++i) {
    square.end = kBegin + kStep * static_cast<float>(i);
    const auto g = square.level(image, square.end);
    if (!g) break;
    const float left = square.change(square.own, *g);
    if (left > least) {
      square.end -= kStep * (left - least) / (left - before);
      break;
    }
    before = left;
  }
  return square;
}

// How far a margin is looked at before and beyond the end of a pattern, squares.
float reach_of_margin(const OuterSquare& square) { return std::max(0.1F, 2 * square.pixel()); }

// How much a square that ends changes there to the most, grey levels: a narrow margin is a peak.
float change_at_end(const ImageView& image, const OuterSquare& square) {
  const float reach = reach_of_margin(square);
  const auto before = square.level(image, square.end - reach);
  float most = 0;
  for (int i = 1; i <= 4 && before; ++i) {
    const auto after = square.level(image, square.end + reach * static_cast<float>(i) / 4);
    if (!after) break;
    most = std::max(most, square.change(*before, *after));
  }
  return most;
}

// Whether a square goes on where those beside it end, `change` grey levels brighter or darker. A
// shadow on the margin is no end, for it falls slowly.
bool goes_on(const ImageView& image, const OuterSquare& square, float edge, float change) {
  constexpr float kNarrowest = 0.04F;  // squares, of a margin
  constexpr float kMost = 0.5F;        // of the change of those that end
  const auto before = square.level(image, edge - reach_of_margin(square));
  const auto after = square.level(image, edge + std::max(square.pixel(), kNarrowest));
  return before && after && square.change(square.own, *before) < 0.5F * square.contrast() &&
         square.change(*before, *after) < kMost * change;
}

// Where the squares of one colour end beyond a line, on average by what change of level, and how
// many of them end there. None where they do not end together.
struct CommonEnd {
  float at = 0;
  float change = 0;
  std::size_t squares = 0;
};
CommonEnd common_end(const ImageView& image, std::vector<OuterSquare>& squares) {
  constexpr float kNearest = 0.3F;    // squares beyond the line, where the last squares end
  constexpr float kFarthest = 1.3F;   // a lens may make it more than one
  constexpr float kStraight = 0.06F;  // squares, from the median end
  constexpr float kChange = 0.4F;     // of the contrast
  CommonEnd end;
  const auto middle = squares.begin() + static_cast<std::ptrdiff_t>(squares.size() / 2);
  std::ranges::nth_element(squares, middle, {}, &OuterSquare::end);
  end.at = middle->end;
  if (!(end.at > kNearest && end.at < kFarthest)) return {};
  for (const OuterSquare& square : squares) {
    const float change = change_at_end(image, square);
    if (std::abs(square.end - end.at) >= kStraight || change < kChange * square.contrast()) {
      continue;
    }
    end.change += change;
    ++end.squares;
  }
  end.change /= static_cast<float>(std::max<std::size_t>(end.squares, 1));
  return end;
}

// pattern_ends() with the next nodes extrapolated from so many.
Edge ends_by(const ImageView& image, const Lattice& lattice, Cell first, Cell step, int count,
             Cell outwards, int nodes) {
  constexpr float kInView = 0.9F;  // of the line's squares: what covers the next line is askew
  std::array<std::vector<OuterSquare>, 2> colours;
  for (int i = 0; i + 1 < count; ++i) {
    const Cell cell = first + i * step;
    if (!lattice.has(cell) || !lattice.has(cell + step)) continue;
    const auto square = outer_square(image, lattice, cell, step, outwards, nodes);
    if (square) colours[static_cast<std::size_t>(i & 1)].push_back(*square);
  }
  const std::size_t seen = colours[0].size() + colours[1].size();
  if (static_cast<float>(seen) < kInView * static_cast<float>(count - 1)) return Edge::kNotSeen;
  // Behind a narrow margin the squares of its own colour end too, a little later.
  Edge edge = Edge::kNotSeen;
  float nearest = 0;
  for (std::size_t k = 0; k < 2; ++k) {
    const std::vector<OuterSquare>& others = colours[1 - k];
    if (colours[k].size() < kLeastEnds || others.empty()) continue;
    const CommonEnd end = common_end(image, colours[k]);
    if (end.squares == 0 || (edge != Edge::kNotSeen && end.at >= nearest)) continue;
    const auto beyond = static_cast<std::size_t>(std::ranges::count_if(
        others, [&](const OuterSquare& s) { return goes_on(image, s, end.at, end.change); }));
    if (static_cast<float>(end.squares + beyond) < kLeastAgreeing * static_cast<float>(seen))
      continue;
    edge = others.front().own > others.front().other ? Edge::kBrightMargin : Edge::kDarkMargin;
    nearest = end.at;
  }
  return edge;
}

}  // namespace

Edge pattern_ends(const ImageView& image, const Lattice& lattice, Cell first, Cell step, int count,
                  Cell outwards) {
  if (image.width < 2 || image.height < 2) return Edge::kNotSeen;
  // Close to the border of a wide view neither parabola nor straight line is right everywhere.
  const Edge bent = ends_by(image, lattice, first, step, count, outwards, 3);
  return bent != Edge::kNotSeen ? bent : ends_by(image, lattice, first, step, count, outwards, 2);
}

Edge find_edge(const ImageView& image, const Lattice& lattice, Cell first, Cell step, int count,
               Cell outwards) {
  if (image.width < 2 || image.height < 2) return Edge::kNotSeen;
  // Shorter profiles too: the image may end soon, or the margin.
  for (const float reach : kTo) {
    const Edge edge = edge_within(image, lattice, first, step, count, outwards, reach);
    if (edge != Edge::kNotSeen) return edge;
  }
  return Edge::kNotSeen;
}

bool continues_beyond(const ImageView& image, const Lattice& lattice, Cell first, Cell step,
                      int count, Cell outwards) {
  constexpr float kOuter = 1.35F;    // squares: margin, or half into the second one
  constexpr float kAside = 0.25F;    // squares
  constexpr float kContrast = 0.3F;  // of the corner's
  constexpr int kFewest = 3;
  if (image.width < 2 || image.height < 2) return false;
  int seen = 0;
  int exchanged = 0;
  for (int i = 0; i < count; ++i) {
    const Cell cell = first + i * step;
    const auto next = next_node(lattice, cell, outwards);
    if (!next) continue;
    const Node& node = lattice.at(cell);
    const Point way = {next->x - node.x, next->y - node.y};
    // Along the line to the next node, whichever is there.
    const Cell other = lattice.has(cell + step) ? cell + step : cell - step;
    if (!lattice.has(other)) continue;
    const float sign = lattice.has(cell + step) ? kAside : -kAside;
    const Point aside = {sign * (lattice.at(other).x - node.x),
                         sign * (lattice.at(other).y - node.y)};
    const auto across = [&](float share) -> std::optional<float> {
      const Point at = {node.x + share * way.x, node.y + share * way.y};
      const auto a = grey(image, {at.x + aside.x, at.y + aside.y});
      const auto b = grey(image, {at.x - aside.x, at.y - aside.y});
      if (!a || !b) return std::nullopt;
      return *a - *b;
    };
    const auto inner = across(0.5F);
    const auto outer = across(kOuter);
    if (!inner || !outer) continue;
    ++seen;
    const bool turns = (*inner > 0) != (*outer > 0);
    exchanged += turns && std::abs(*outer) > kContrast * node.contrast ? 1 : 0;
  }
  return seen >= kFewest && 4 * exchanged > 3 * seen;
}

}  // namespace calvin::detect
