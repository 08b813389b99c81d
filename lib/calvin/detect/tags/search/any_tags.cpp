// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Reads every quad in the manner of one dictionary after the other, and numbers the tags of the one
// that most of them are of.

#include "calvin/detect/tags/search/any_tags.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/LU>

#include "calvin/detect/pyramid.hpp"
#include "calvin/detect/smoothing.hpp"
#include "calvin/detect/tags/quads.hpp"
#include "calvin/detect/tags/search/any_readers.hpp"
#include "calvin/detect/tags/search/tag_spacing.hpp"
#include "calvin/detect/tags/tag_fit.hpp"
#include "calvin/geometry/median.hpp"
#include "calvin/target/kinds.hpp"

namespace calvin::detect {

namespace {

constexpr std::size_t kFewestTags = 3;
// Of a tag's side with what belongs to it: the widest gap that a grid is said to have.
constexpr double kWidestGap = 1.5;

// A quad in px of the image.
struct SeenQuad {
  Quad corners;
  bool light = false;
};

// A tag that was read, its corners from the upper left one on.
struct SeenTag {
  int id = 0;
  Quad corners;
  GridPlace place;  // beside the first tag, once it is known
  bool placed = false;
};

std::vector<SeenQuad> quads_of(Pyramid& pyramid, const std::stop_token& stop) {
  constexpr int kContrast = 10;  // grey levels
  constexpr float kNoises = 6;   // 1 sigma of the noise
  constexpr double kNear = 0.3;  // of the shortest side
  std::vector<SeenQuad> all;
  QuadSearch search;
  for (int level = pyramid.levels() - 1; level >= 0 && !stop.stop_requested(); --level) {
    const ImageView& image = pyramid.calm_level(level);
    search.begin(image, std::max(kContrast, static_cast<int>(kNoises * noise_of(image))));
    for (const bool light : {false, true}) {
      for (Quad quad : search.find(light)) {
        for (Point& p : quad) {
          for (double& x : p) {
            x = static_cast<double>(Pyramid::to_image(static_cast<float>(x), level));
          }
        }
        // The finer level has it to a smaller part of a pixel.
        const double near = kNear * shortest_side(quad);
        std::erase_if(all, [&](const SeenQuad& q) {
          return q.light == light && (centre_of(q.corners) - centre_of(quad)).norm() < near;
        });
        all.push_back({quad, light});
      }
    }
  }
  return all;
}

// For each reader the tags that have no wrong bits.
std::vector<std::vector<SeenTag>> read_tags(Pyramid& pyramid, std::span<const SeenQuad> quads,
                                            const Readers& readers) {
  constexpr double kPixels = 3;  // of a bit
  std::vector<std::vector<SeenTag>> tags(readers.all.size());
  for (const SeenQuad& quad : quads) {
    if (quad.light != readers.shape().inverted) continue;
    const double bit = shortest_side(quad.corners) / readers.shape().cells();
    const int fine = std::clamp(static_cast<int>(std::log2(std::max(bit / kPixels, 1.0))), 0,
                                pyramid.levels() - 1);
    Quad in_level = quad.corners;
    for (Point& p : in_level) {
      for (double& x : p) x = Pyramid::to_level(x, fine);
    }
    const auto bits = readers.all.front().bits_of(pyramid.level(fine), in_level);
    for (std::size_t k = 0; bits && k < readers.all.size(); ++k) {
      const auto code = readers.all[k].find(*bits);
      if (!code || code->wrong > 0) continue;
      SeenTag tag{code->id, {}, {}, false};
      for (std::size_t i = 0; i < 4; ++i) {
        tag.corners[i] = quad.corners[(i + static_cast<std::size_t>(code->turns)) % 4];
      }
      tags[k].push_back(tag);
    }
  }
  return tags;
}

// Where another tag's middle lies, in sides of a tag from the middle of this one.
std::optional<Point> place_beside(const SeenTag& tag, const SeenTag& other) {
  const Eigen::Matrix3d from_image = from_cells(tag.corners, 1).inverse();
  const Point middle = centre_of(other.corners);
  const Eigen::Vector3d p = from_image * Eigen::Vector3d(middle.x(), middle.y(), 1);
  if (!(p.z() > 0)) return std::nullopt;
  const Point in_tag = p.head<2>() / p.z();
  return Point(in_tag - Point(0.5, 0.5));
}

// How a tag is numbered after its left and its upper neighbour, and the distance of their middles.
struct Numbering {
  int right = 0;
  int below = 0;
  double pitch = 0;      // sides of a tag
  double least_gap = 0;  // sides of a tag, that there may be
};

// The number that most have.
int most_frequent(const std::vector<int>& numbers) {
  int best = 0;
  std::ptrdiff_t most = 0;
  for (const int n : numbers) {
    const auto count = std::ranges::count(numbers, n);
    if (count > most) best = n;
    most = std::max(most, count);
  }
  return best;
}

// The next tag on a way, if it is one: 0 to the right, 1 below.
std::optional<std::pair<const SeenTag*, double>> next_of(std::span<const SeenTag> tags,
                                                         const SeenTag& tag, int way,
                                                         double least_gap) {
  constexpr double kAside = 0.3;  // of a side
  std::optional<std::pair<const SeenTag*, double>> next;
  for (const SeenTag& other : tags) {
    const auto at = &other == &tag ? std::nullopt : place_beside(tag, other);
    if (!at) continue;
    const double ahead = (*at)[way];
    const double aside = (*at)[1 - way];
    const bool is_next = ahead >= 1 && ahead <= 1 + least_gap + kWidestGap;
    if (!is_next || std::abs(aside) > kAside) continue;
    if (!next || ahead < next->second) next = {&other, ahead};
  }
  return next;
}

std::optional<Numbering> numbering_of(std::span<const SeenTag> tags, double least_gap) {
  std::array<std::vector<int>, 2> steps;
  std::vector<double> pitches;
  for (const SeenTag& tag : tags) {
    for (const int way : {0, 1}) {
      const auto next = next_of(tags, tag, way, least_gap);
      if (!next) continue;
      steps[static_cast<std::size_t>(way)].push_back(next->first->id - tag.id);
      pitches.push_back(next->second);
    }
  }
  if (pitches.size() + 1 < kFewestTags) return std::nullopt;
  return Numbering{most_frequent(steps[0]), most_frequent(steps[1]), median_of(std::move(pitches)),
                   least_gap};
}

// The tags that hang together with one of them, with their places.
std::vector<SeenTag> tags_around(std::vector<SeenTag> tags, std::size_t seed,
                                 const Numbering& numbering) {
  tags[seed].placed = true;
  std::vector<SeenTag*> open = {&tags[seed]};
  while (!open.empty()) {
    SeenTag& tag = *open.back();
    open.pop_back();
    for (SeenTag& other : tags) {
      for (const int way : {0, 1}) {
        const int step = way == 0 ? numbering.right : numbering.below;
        const int ahead = other.id - tag.id == step ? 1 : tag.id - other.id == step ? -1 : 0;
        if (other.placed || step == 0 || ahead == 0) continue;
        const auto next = next_of(tags, ahead > 0 ? tag : other, way, numbering.least_gap);
        if (!next || next->first != (ahead > 0 ? &other : &tag)) continue;
        other.placed = true;
        other.place = tag.place;
        (way == 0 ? other.place.col : other.place.row) += ahead;
        open.push_back(&other);
      }
    }
  }
  std::erase_if(tags, [](const SeenTag& tag) { return !tag.placed; });
  return tags;
}

// The most tags that hang together.
std::vector<SeenTag> largest_part(const std::vector<SeenTag>& tags, const Numbering& numbering) {
  std::vector<SeenTag> best;
  for (std::size_t seed = 0; seed < tags.size() && 2 * best.size() <= tags.size(); ++seed) {
    std::vector<SeenTag> part = tags_around(tags, seed, numbering);
    if (part.size() > best.size()) best = std::move(part);
  }
  return best;
}

// Whether other tags lie among these: those of a ChArUco board do.
bool are_among_others(std::span<const SeenTag> part, std::span<const SeenTag> tags) {
  constexpr double kMost = 1.35;  // times as many
  Point least = centre_of(part.front().corners);
  Point most = least;
  for (const SeenTag& tag : part) {
    least = least.cwiseMin(centre_of(tag.corners));
    most = most.cwiseMax(centre_of(tag.corners));
  }
  const auto within = std::ranges::count_if(tags, [&](const SeenTag& tag) {
    const Point at = centre_of(tag.corners);
    return (at.array() >= least.array()).all() && (at.array() <= most.array()).all();
  });
  return static_cast<double>(within) > kMost * static_cast<double>(part.size());
}

// Whether the middle of a further tag above or below would be in the image, and beside a single
// row: with several of them the ids tell how many columns there are.
bool would_go_on_in_view(const ImageView& image, std::span<const SeenTag> tags, GridPlace size,
                         double pitch) {
  return std::ranges::all_of(tags, [&](const SeenTag& tag) {
    const Eigen::Matrix3d from_tag = from_cells(tag.corners, 1);
    const auto is_in_view = [&](double x, double y) {
      const Eigen::Vector3d p = from_tag * Eigen::Vector3d(0.5 + x, 0.5 + y, 1);
      return p.z() > 0 && is_in(image, p.head<2>() / p.z());
    };
    const bool is_row = size.row == 1;
    return (tag.place.row > 0 || is_in_view(0, -pitch)) &&
           (tag.place.row + 1 < size.row || is_in_view(0, pitch)) &&
           (!is_row || tag.place.col > 0 || is_in_view(-pitch, 0)) &&
           (!is_row || tag.place.col + 1 < size.col || is_in_view(pitch, 0));
  });
}

// Places from the upper left one on, and how many columns and rows there are.
GridPlace count_from_first(std::vector<SeenTag>& tags) {
  const auto [left, right] =
      std::ranges::minmax(tags, {}, [](const SeenTag& t) { return t.place.col; });
  const auto [top, bottom] =
      std::ranges::minmax(tags, {}, [](const SeenTag& t) { return t.place.row; });
  const GridPlace first{left.place.col, top.place.row};
  const GridPlace size{right.place.col - first.col + 1, bottom.place.row - first.row + 1};
  for (SeenTag& tag : tags) {
    tag.place = {tag.place.col - first.col, tag.place.row - first.row};
  }
  return size;
}

// AprilTags that stand on their heads, as OpenCV has them.
void turn_over(std::vector<SeenTag>& tags, Numbering& numbering, TagStyle& style) {
  style.april = false;
  numbering.right = -numbering.right;
  numbering.below = -numbering.below;
  for (SeenTag& tag : tags) {
    std::swap(tag.corners[0], tag.corners[2]);
    std::swap(tag.corners[1], tag.corners[3]);
  }
}

// Moves the corners of tags to where their sides meet: the distance of wide apart tags is told by
// corners that are right to a small part of a pixel. `is_over`: they were turned over.
void fit_corners(const ImageView& image, const TagReader& reader, bool is_over,
                 std::vector<SeenTag>& tags) {
  constexpr double kReach = 0.3;  // of a cell
  for (SeenTag& tag : tags) {
    TagPattern pattern = reader.pattern_of(tag.id);
    if (is_over) pattern.bits = half_turned(pattern.bits, pattern.dictionary->bit_count());
    const double reach = std::max(kReach * shortest_side(tag.corners) / pattern.cells(), 1.5);
    const TagFit fit = fit_tag(image, {tag.corners, reach, unknown_bends(tag.corners)}, pattern);
    if (fit.seen() == 4) tag.corners = fit.corners;
  }
}

std::vector<TagCorner> corners_of(std::span<const SeenTag> tags) {
  std::vector<TagCorner> corners;
  for (const SeenTag& tag : tags) {
    for (std::size_t i = 0; i < 4; ++i) {
      const int right = i == 1 || i == 2 ? 1 : 0;
      corners.push_back({tag.place, right, i < 2 ? 0 : 1, pixel_of(tag.corners[i])});
    }
  }
  return corners;
}

// The board of tags whose ids go by such a numbering, with rows that are counted downwards or, on
// an AprilGrid, upwards.
std::optional<AnyTags> board_of(const ImageView& image, std::vector<SeenTag> tags,
                                const Numbering& numbering, const TagStyle& style, double side) {
  const GridPlace seen = count_from_first(tags);
  const bool is_upwards = numbering.below < 0;
  const int cols = seen.row > 1 ? std::abs(numbering.below) : seen.col;
  const SeenTag& any = tags.front();
  const Grid order{cols, seen.row, side};
  const int first =
      any.id - order.id({any.place.col, is_upwards ? seen.row - 1 - any.place.row : any.place.row});
  if (first < 0 || cols < seen.col) return std::nullopt;
  const Gap gap = gap_of(numbering.pitch, numbering.least_gap);
  const MarkerDictionary* dictionary = smallest_with(*style.dictionary, first + order.count() - 1);
  AnyTags found;
  found.whole =
      gap.is_certain && cols == seen.col && would_go_on_in_view(image, tags, seen, numbering.pitch);
  if (is_upwards) {
    if (!style.april || style.is_board_inverted()) return std::nullopt;
    found.board = AprilGrid{cols, seen.row, side, gap.share, dictionary, style.border, first};
  } else {
    found.board = TagGrid{cols,        seen.row, side,         gap.share * side,         dictionary,
                          style.april, first,    style.border, style.is_board_inverted()};
  }
  if (!found.board.check()) return std::nullopt;
  // With the measures that its text has, so that it is equal to the board of that text.
  const auto exact = parse_board(found.board.text());
  if (!exact) return std::nullopt;
  found.board = *exact;
  return found;
}

}  // namespace

TagsInView find_any_tags(const ImageView& image, double side, const std::stop_token& stop) {
  Pyramid pyramid;
  pyramid.build(image);
  const auto quads = quads_of(pyramid, stop);
  TagsInView seen;
  std::size_t most = kFewestTags - 1;
  for (const Readers& readers : any_readers()) {
    if (stop.stop_requested()) return {};
    const auto all = read_tags(pyramid, quads, readers);
    for (std::size_t k = 0; k < all.size(); ++k) {
      std::vector<SeenTag> tags = all[k];
      TagStyle style = readers.all[k].style();
      seen.of_april_tag = seen.of_april_tag || (style.april && tags.size() >= 2);
      auto numbering =
          tags.size() > most ? numbering_of(tags, style.least_gap_share()) : std::nullopt;
      if (!numbering) continue;
      const bool is_turned =
          numbering->right < 0 || (numbering->right == 0 && numbering->below < 0);
      if (is_turned && !style.april) continue;
      if (is_turned) turn_over(tags, *numbering, style);
      if (numbering->right > 1) continue;
      auto part = largest_part(tags, *numbering);
      if (part.size() <= most || are_among_others(part, tags)) continue;
      fit_corners(pyramid.level(0), readers.all[k], is_turned, part);
      numbering->pitch = fit_pitch(image.size(), corners_of(part), numbering->pitch);
      if (auto found = board_of(pyramid.level(0), part, *numbering, style, side)) {
        seen.grid = *std::move(found);
        most = part.size();
      }
    }
  }
  return seen;
}

}  // namespace calvin::detect
