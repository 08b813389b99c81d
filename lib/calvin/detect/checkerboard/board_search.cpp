// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Corners of one level grouped by the graph, laid out as lattices and completed.

#include "calvin/detect/checkerboard/board_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "calvin/detect/checkerboard/corners/grey_at.hpp"
#include "calvin/geometry/convex_hull.hpp"

namespace calvin::detect {

namespace {

constexpr int kPasses = 14;              // rows or columns that may be missing side by side
constexpr float kAsymmetry = 0.55F;      // of check_ring(), for any corner
constexpr float kAsymmetryInGap = 0.8F;  // of check_ring(), for a corner that is expected
constexpr int kWeakResponse = 3;         // grey levels, for a corner that is expected
constexpr float kLeastSpacing = 4.5F;    // px
constexpr float kFarOff = 0.45F;         // of the spacing, from where a node is expected
constexpr int kFewestToBuildOn = 6;      // nodes

// The ring of the response to corners: a marker leaves little of a square between itself and them.
RingSize response_ring(const Surroundings& surroundings) {
  return surroundings.has_markers() ? RingSize::kSmall : RingSize::kLarge;
}

// Sets the place of a corner to the centroid of the response around its peak.
void refine_place(const ImageView& image, const SaddlePoint& p, RingSize ring, Corner& corner) {
  constexpr int kReach = 2;
  ResponsePatch patch;
  saddle_responses(image, p.x - kReach, p.y - kReach, 2 * kReach + 1, ring, patch);
  int sum = 0;
  int x = 0;
  int y = 0;
  for (int dy = -kReach; dy <= kReach; ++dy) {
    for (int dx = -kReach; dx <= kReach; ++dx) {
      const int r = patch.at[dy + kReach][dx + kReach];
      sum += r;
      x += r * dx;
      y += r * dy;
    }
  }
  const auto share = [&](int moment) {
    return sum > 0 ? static_cast<float>(moment) / static_cast<float>(sum) : 0;
  };
  corner.x = static_cast<float>(p.x) + share(x);
  corner.y = static_cast<float>(p.y) + share(y);
}

// Whether there is a corner at a pixel, by either ring.
bool check_rings(const ImageView& image, int x, int y, float asymmetry, Corner& corner) {
  return check_ring(image, x, y, RingSize::kLarge, asymmetry, corner) ||
         check_ring(image, x, y, RingSize::kSmall, asymmetry, corner);
}

// The same at a peak of the response, which what is printed beside the edges may have moved by a
// pixel. Moves the peak to the strongest pixel around it that is a corner.
bool check_around(const ImageView& image, float asymmetry, SaddlePoint& p, Corner& corner) {
  constexpr float kLeast = 0.4F;  // of the peak's response
  ResponsePatch patch;
  saddle_responses(image, p.x - 1, p.y - 1, 3, RingSize::kSmall, patch);
  const auto least = static_cast<int>(kLeast * static_cast<float>(p.response));
  SaddlePoint best;
  for (int dy = 0; dy < 3; ++dy) {
    for (int dx = 0; dx < 3; ++dx) {
      const std::uint8_t r = patch.at[dy][dx];
      Corner trial;
      if (r <= std::max<int>(least, best.response) ||
          !check_rings(image, p.x - 1 + dx, p.y - 1 + dy, asymmetry, trial)) {
        continue;
      }
      best = {p.x - 1 + dx, p.y - 1 + dy, r};
      corner = trial;
    }
  }
  if (best.response == 0) return false;
  p = best;
  return true;
}

// Whether the edges of a corner go on, in all four ways, farther than those between the bits of a
// marker do. Where the lines of a board are not alike far apart, the longer way of each edge tells.
bool has_long_edges(const ImageView& image, const Corner& corner, bool even_steps) {
  constexpr float kFar = 6;        // px along the edge
  constexpr float kNear = 3;       // px, the shorter way
  constexpr float kAside = 1.2F;   // px
  constexpr float kLeast = 0.25F;  // of the contrast, between the two sides of the edge
  const auto goes_on = [&](int way, float far) {
    const bool is_rising = way < 2;
    const Direction edge = is_rising ? corner.rising : corner.falling;
    if ((way & 1) != 0) far = -far;
    // Going from +x to +y it is brighter behind a rising edge, also where that is left backwards.
    const float side = (is_rising ? kAside : -kAside) * ((way & 1) == 0 ? 1.0F : -1.0F);
    const Direction at = {corner.x + far * edge.x, corner.y + far * edge.y};
    const auto bright = grey_at(image, at.x - side * edge.y, at.y + side * edge.x);
    const auto dark = grey_at(image, at.x + side * edge.y, at.y - side * edge.x);
    return !bright || !dark || *bright - *dark >= kLeast * corner.contrast;
  };
  for (int way = 0; way < kWays; way += 2) {
    const bool ahead = goes_on(way, kFar);
    const bool behind = goes_on(way + 1, kFar);
    if (ahead && behind) continue;
    if (even_steps || !(ahead || behind) || !goes_on(ahead ? way + 1 : way, kNear)) return false;
  }
  return true;
}

Direction towards(Direction reference, Direction line) {
  return dot(reference, line) >= 0 ? line : -line;
}

// The corner as a node of a cell of known colours, its edges in the directions nearest to those
// of a neighbour.
Node node_of(const Corner& corner, bool even, Direction along, Direction down) {
  Node node;
  node.x = corner.x;
  node.y = corner.y;
  node.contrast = corner.contrast;
  node.along = towards(along, even ? corner.rising : corner.falling);
  node.down = towards(down, even ? corner.falling : corner.rising);
  return node;
}

// The step to the next cell when the corner of a node is left on a way.
Cell step_of(const Corner& corner, const Node& node, int way, bool even) {
  const bool is_rising = way < 2;
  const Direction line = is_rising ? corner.rising : corner.falling;
  const int sign = (way & 1) == 0 ? 1 : -1;
  if (is_rising == even) return {dot(line, node.along) > 0 ? sign : -sign, 0};
  return {0, dot(line, node.down) > 0 ? sign : -sign};
}

// Whether a corner lies where the nodes so far let it be expected. Colours alone do not tell:
// across a finger, which hides two corners, the next corner has the right colours too.
bool is_expected(const Lattice& lattice, Cell cell, const Corner& corner) {
  const auto expected = lattice.expect(cell);
  return !expected || std::hypot(corner.x - expected->x, corner.y - expected->y) <=
                          kFarOff * std::max(expected->spacing, kLeastSpacing);
}

// Whether a corner's edges run as those of the lattice next to it.
bool runs_along(const Corner& corner, bool even, const Node& near) {
  constexpr float kTurn = 0.5F;  // sine of the angle between them
  const Direction along = even ? corner.rising : corner.falling;
  const Direction down = even ? corner.falling : corner.rising;
  return std::abs(cross(along, near.along)) < kTurn && std::abs(cross(down, near.down)) < kTurn;
}

// The strongest response near an expected place.
SaddlePoint strongest(const ImageView& image, const Expected& expected, RingSize ring) {
  const int reach = std::clamp(static_cast<int>(std::lround(0.22F * expected.spacing)), 1, 6);
  const int x = static_cast<int>(std::lround(expected.x));
  const int y = static_cast<int>(std::lround(expected.y));
  ResponsePatch patch;
  saddle_responses(image, x - reach, y - reach, 2 * reach + 1, ring, patch);
  SaddlePoint best;
  for (int dy = 0; dy <= 2 * reach; ++dy) {
    for (int dx = 0; dx <= 2 * reach; ++dx) {
      const std::uint8_t r = patch.at[dy][dx];
      if (r > best.response) best = {x - reach + dx, y - reach + dy, r};
    }
  }
  return best;
}

bool near_border(const ImageView& image, const Expected& at) {
  constexpr float kBorder = kResponseRadius + 3;
  return at.x < kBorder || at.y < kBorder || at.x > static_cast<float>(image.width - 1) - kBorder ||
         at.y > static_cast<float>(image.height - 1) - kBorder;
}

bool inside(const ImageView& image, const Expected& at) {
  return at.x >= 0.5F && at.y >= 0.5F && at.x <= static_cast<float>(image.width) - 1.5F &&
         at.y <= static_cast<float>(image.height) - 1.5F;
}

// A node at an expected place where nothing can be seen at this level, copied from a neighbour.
bool guess_at(const Lattice& lattice, Cell cell, const Expected& expected, Node& node) {
  if (lattice.was_refused(cell, expected)) return false;
  for (const Cell step : kAround) {
    if (!lattice.has(cell + step) || lattice.at(cell + step).guessed) continue;
    node = lattice.at(cell + step);
    node.x = expected.x;
    node.y = expected.y;
    node.guessed = true;
    return true;
  }
  return false;
}

bool find_node(const ImageView& image, const Lattice& lattice, Cell cell, Node& node) {
  const auto expected = lattice.expect(cell);
  if (!expected || expected->spacing < kLeastSpacing || !inside(image, *expected)) return false;
  if (near_border(image, *expected)) return guess_at(lattice, cell, *expected, node);
  SaddlePoint peak = strongest(image, *expected, response_ring(lattice.surroundings()));
  if (peak.response < kWeakResponse) return false;
  Corner corner;
  if (!check_rings(image, peak.x, peak.y, kAsymmetryInGap, corner) &&
      !(lattice.surroundings().has_markers() &&
        check_around(image, kAsymmetryInGap, peak, corner))) {
    return false;
  }
  corner.x = static_cast<float>(peak.x);
  corner.y = static_cast<float>(peak.y);
  for (const Cell step : kAround) {
    if (!lattice.has(cell + step)) continue;
    const Node& near = lattice.at(cell + step);
    if (corner.contrast < 0.25F * near.contrast ||
        !runs_along(corner, Lattice::is_even(cell), near)) {
      return false;
    }
    node = node_of(corner, Lattice::is_even(cell), near.along, near.down);
  }
  return true;
}

// A node between neighbours on two sides or more: where ink or light has parted the squares, no
// corner can be seen from close up.
bool guess_between(const ImageView& image, const Lattice& lattice, Cell cell, Node& node) {
  const auto sides = std::count_if(kAround.begin(), kAround.end(),
                                   [&](Cell step) { return lattice.has(cell + step); });
  if (sides < 2) return false;
  const auto expected = lattice.expect(cell);
  return expected && expected->spacing >= kLeastSpacing && inside(image, *expected) &&
         guess_at(lattice, cell, *expected, node);
}

// Whether what is expected in a cell may depend on one of these: by three nodes in a row at most.
bool is_near_any(Cell cell, std::span<const Cell> nodes) {
  constexpr int kReach = 3;
  return std::ranges::any_of(nodes, [&](Cell c) {
    return std::abs(c.col - cell.col) <= kReach && std::abs(c.row - cell.row) <= kReach;
  });
}

// Whether a node stands where another does: a lattice that was bent wrongly comes round to itself.
bool is_doubled(const Lattice& lattice, Cell cell, const Node& node) {
  const auto expected = lattice.expect(cell);
  const float reach = kFarOff * (expected ? expected->spacing : kLeastSpacing);
  bool found = false;
  lattice.for_each([&](Cell, const Node& other) {
    const float dx = other.x - node.x;
    const float dy = other.y - node.y;
    found = found || dx * dx + dy * dy < reach * reach;
  });
  return found;
}

bool is_taken(const SearchOptions& options, const SaddlePoint& p) {
  const Pixel at = {static_cast<double>(p.x), static_cast<double>(p.y)};
  return std::ranges::any_of(options.taken,
                             [&](const auto& polygon) { return contains(polygon, at); });
}

}  // namespace

void BoardSearch::detect_corners(const ImageView& image, const SearchOptions& options) {
  options_ = options;
  corners_.clear();
  groups_.clear();
  next_group_ = 0;
  image_ = image;
  const bool markers = options.surroundings.has_markers();
  const RingSize ring = response_ring(options.surroundings);
  for (SaddlePoint p : saddle_search_.find(image, ring, options.threshold,
                                           static_cast<std::size_t>(options.most_points))) {
    if (is_taken(options, p)) continue;
    Corner corner;
    if (!check_rings(image, p.x, p.y, kAsymmetry, corner) &&
        !(markers && check_around(image, kAsymmetry, p, corner))) {
      continue;
    }
    refine_place(image, p, ring, corner);
    if (markers && !has_long_edges(image, corner, options.surroundings.gap == 1)) continue;
    corners_.push_back(corner);
  }
  // Too few corners for a board: this test makes images without one cheap.
  if (static_cast<int>(corners_.size()) < options.least_nodes) return;
  graph_.build(image, corners_, options.reach, options.surroundings);
  find_groups();
}

void BoardSearch::find_groups() {
  seen_.assign(corners_.size(), false);
  for (std::size_t i = 0; i < corners_.size(); ++i) {
    if (seen_[i]) continue;
    seen_[i] = true;
    queue_.assign(1, static_cast<int>(i));
    for (std::size_t head = 0; head < queue_.size(); ++head) {
      for (const int other : graph_.neighbours(queue_[head])) {
        if (other == kNoCorner || seen_[static_cast<std::size_t>(other)]) continue;
        seen_[static_cast<std::size_t>(other)] = true;
        queue_.push_back(other);
      }
    }
    Group group = {static_cast<int>(i), static_cast<int>(queue_.size()), {}};
    if (group.size < options_.least_nodes) continue;
    if (options_.surroundings.gap < 1) group.first = clearest_corner();
    for (const int k : queue_) {
      const Corner& corner = corners_[static_cast<std::size_t>(k)];
      group.box.add(corner.x, corner.y);
    }
    groups_.push_back(group);
  }
  std::sort(groups_.begin(), groups_.end(),
            [](const Group& a, const Group& b) { return a.size > b.size; });
  if (groups_.size() > options_.most_groups) groups_.resize(options_.most_groups);
  seen_.assign(corners_.size(), false);
  cell_.resize(corners_.size());
}

int BoardSearch::clearest_corner() const {
  const float usual = std::log(options_.surroundings.step_ratio());
  int clearest = queue_.front();
  float least = std::numeric_limits<float>::infinity();
  for (const int corner : queue_) {
    const auto [rising, falling] = graph_.step_ratios(corners_, corner);
    // Both say the same, and as much as they should.
    const float off = std::min(std::abs(rising - usual) + std::abs(falling - usual),
                               std::abs(rising + usual) + std::abs(falling + usual));
    if (off >= least) continue;
    least = off;
    clearest = corner;
  }
  return clearest;
}

void BoardSearch::fill(const Group& group, Lattice& lattice) {
  lattice.clear();
  if (!lattice.has_even_steps()) {
    const auto [rising, falling] = graph_.step_ratios(corners_, group.first);
    lattice.set_long_first(rising + falling > 0);
  }
  const auto start = static_cast<std::size_t>(group.first);
  const Corner& first = corners_[start];
  lattice.put({0, 0}, node_of(first, true, first.rising, first.falling));
  cell_[start] = {0, 0};
  seen_[start] = true;
  queue_.assign(1, group.first);
  for (std::size_t head = 0; head < queue_.size(); ++head) {
    const auto from = static_cast<std::size_t>(queue_[head]);
    const Cell cell = cell_[from];
    const Node node = lattice.at(cell);
    for (int way = 0; way < kWays; ++way) {
      const int other = graph_.neighbours(queue_[head])[static_cast<std::size_t>(way)];
      if (other == kNoCorner || seen_[static_cast<std::size_t>(other)]) continue;
      const bool even = Lattice::is_even(cell);
      const Corner& next = corners_[static_cast<std::size_t>(other)];
      const Cell to = cell + step_of(corners_[from], node, way, even);
      if (!lattice.in_reach(to) || lattice.has(to) || !is_expected(lattice, to, next)) continue;
      seen_[static_cast<std::size_t>(other)] = true;
      cell_[static_cast<std::size_t>(other)] = to;
      lattice.put(to, node_of(next, !even, node.along, node.down));
      queue_.push_back(other);
    }
  }
}

void BoardSearch::complete(const ImageView& image, Lattice& lattice, int enough, bool guessing) {
  std::vector<Cell> last;   // what the last pass has added
  std::vector<Cell> added;  // by this one
  for (int pass = 0; pass < kPasses && lattice.count() < enough; ++pass) {
    const CellRange e = lattice.extent();
    last.swap(added);
    added.clear();
    for (int row = e.first.row - 1; row <= e.last.row + 1; ++row) {
      for (int col = e.first.col - 1; col <= e.last.col + 1; ++col) {
        Node node;
        const Cell cell = {col, row};
        if (!lattice.in_reach(cell) || lattice.has(cell)) continue;
        if (pass > 0 && !is_near_any(cell, last) && !is_near_any(cell, added)) continue;
        if (!find_node(image, lattice, cell, node) &&
            !(guessing && guess_between(image, lattice, cell, node))) {
          continue;
        }
        if (is_doubled(lattice, cell, node)) continue;
        lattice.put(cell, node);
        added.push_back(cell);
      }
    }
    if (added.empty()) break;
  }
  lattice.prune(kFarOff);
}

bool BoardSearch::next(Lattice& lattice) {
  while (next_group_ < groups_.size()) {
    fill(groups_[next_group_++], lattice);
    // What markers hide at the ends of rows would be pruned before it is looked for.
    if (options_.surroundings.has_markers()) complete(image_, lattice, options_.most_points, false);
    lattice.prune(kFarOff);
    if (lattice.count() >= std::min(options_.least_nodes, kFewestToBuildOn)) return true;
  }
  return false;
}

}  // namespace calvin::detect
