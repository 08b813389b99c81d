// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Where the board was seen, how large and how tilted, as shares of what the image has room for; the
// hint names the least of them.

#include "calvin/session/guidance/view_coverage.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "calvin/camera/image_transform.hpp"
#include "calvin/geometry/convex_hull.hpp"
#include "calvin/geometry/homography.hpp"
#include "calvin/geometry/pixels.hpp"
#include "calvin/target/points/id_index.hpp"

namespace calvin {

namespace {

// A span of this much counts as the whole range: the board need not reach every border.
constexpr double kRangeX = 0.7;
constexpr double kRangeY = 0.7;
constexpr double kRangeSize = 0.4;
constexpr double kRangeTilt = 0.5;

// Beyond this ratio of opposite edges the board counts as tilted to that side.
constexpr double kTiltRatio = 0.06;

// A long lens sees both edges equally long. Where a board of this size, at least, is foreshortened
// by a tilt of 30 degrees, and still no edge looks longer, either of them counts as nearer.
constexpr double kForeshortened = 0.87;
constexpr double kLargeEnough = 0.2;

constexpr std::array kEdges = {HintDirection::kLeft, HintDirection::kRight, HintDirection::kTop,
                               HintDirection::kBottom};

// The largest difference of an angle of the quadrangle from a right one, rad.
double farthest_from_square(const std::vector<Pixel>& corner) {
  double most = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const Pixel at = corner[i];
    const Pixel a = {corner[(i + 1) % 4].u - at.u, corner[(i + 1) % 4].v - at.v};
    const Pixel b = {corner[(i + 3) % 4].u - at.u, corner[(i + 3) % 4].v - at.v};
    const double angle = std::atan2(std::abs(a.u * b.v - a.v * b.u), a.u * b.u + a.v * b.v);
    most = std::max(most, std::abs(std::numbers::pi / 2 - angle));
  }
  return most;
}

// Where the centre is in the room it has to move in: a large board has little room to move.
double within_room(double center, double extent, double length) {
  const double room = length - extent;
  return room > 0 ? std::clamp((center - extent / 2) / room, 0.0, 1.0) : 0.5;
}

}  // namespace

Result<BoardFootprint> footprint_of(const View& view) {
  const Observation& seen = view.observation;
  const auto points = view.board.points();
  std::vector<Pixel> xy;
  const IdIndex board_ids(view.board);
  for (const int id : seen.ids) {
    const auto index = board_ids.of(id);
    if (!index) return make_error(ErrorCode::kInvalidArgument, "A corner is not on the board.");
    xy.push_back({points[*index].x(), points[*index].y()});
  }
  const auto h = fit_homography(xy, seen.uv);
  if (!h) return tl::unexpected<Error>(h.error());
  const BoardArea all = view.board.extent();
  const std::vector<Pixel> corner = {
      transform(*h, {all.left, all.top}), transform(*h, {all.right, all.top}),
      transform(*h, {all.right, all.bottom}), transform(*h, {all.left, all.bottom})};
  const double area = std::abs(polygon_area(corner));
  const double width = seen.image_size.width;
  const double height = seen.image_size.height;
  BoardFootprint p;
  for (const Pixel& uv : seen.uv) {
    p.x += uv.u / static_cast<double>(seen.uv.size());
    p.y += uv.v / static_cast<double>(seen.uv.size());
  }
  p.center = {(p.x + 0.5) / width, (p.y + 0.5) / height};
  p.x = within_room(p.x, std::sqrt(area), width);
  p.y = within_room(p.y, std::sqrt(area), height);
  p.size = std::clamp(std::sqrt(area / (width * height)), 0.0, 1.0);
  p.tilt = std::min(1.0, 2 * farthest_from_square(corner));
  const auto nearer = [](double one, double other) { return (one - other) / (one + other); };
  p.left_nearer = nearer(distance(corner[0], corner[3]), distance(corner[1], corner[2]));
  p.top_nearer = nearer(distance(corner[0], corner[1]), distance(corner[3], corner[2]));
  p.aspect = (distance(corner[0], corner[1]) + distance(corner[3], corner[2])) /
             (distance(corner[0], corner[3]) + distance(corner[1], corner[2])) *
             (all.bottom - all.top) / (all.right - all.left);
  for (const double value : {p.x, p.y, p.size, p.tilt, p.left_nearer, p.top_nearer, p.aspect}) {
    if (!std::isfinite(value)) {
      return make_error(ErrorCode::kDegenerate, "The board is seen edge on.");
    }
  }
  return p;
}

namespace {

// From one place in the image to another.
HintDirection direction_of(double right, double down) {
  using enum HintDirection;
  if (std::abs(right) < 0.5 * std::abs(down)) return down > 0 ? kBottom : kTop;
  if (std::abs(down) < 0.5 * std::abs(right)) return right > 0 ? kRight : kLeft;
  if (down > 0) return right > 0 ? kLowerRight : kLowerLeft;
  return right > 0 ? kUpperRight : kUpperLeft;
}

// The edge that is to be nearer than it is; kNone where the board is tilted about as wanted.
HintDirection tilt_towards(const BoardFootprint& wanted, const BoardFootprint& now) {
  using enum HintDirection;
  constexpr double kAsTilted = 0.08;  // of BoardFootprint::left_nearer
  const double left = wanted.left_nearer - now.left_nearer;
  const double top = wanted.top_nearer - now.top_nearer;
  if (std::max(std::abs(left), std::abs(top)) <= kAsTilted) return kNone;
  if (std::abs(left) > std::abs(top)) return left > 0 ? kLeft : kRight;
  return top > 0 ? kTop : kBottom;
}

// Whether it is to come nearer or farther, if either.
std::optional<HintKind> distance_towards(const BoardFootprint& wanted, const BoardFootprint& now) {
  constexpr double kAsLarge = 1.2;  // ratio of sizes
  if (wanted.size > kAsLarge * now.size) return HintKind::kComeCloser;
  if (now.size > kAsLarge * wanted.size) return HintKind::kMoveBack;
  return std::nullopt;
}

}  // namespace

Hint hint_towards(const BoardFootprint& wanted, const BoardFootprint& now) {
  constexpr double kThere = 0.1;  // of the image
  const double right = wanted.center.u - now.center.u;
  const double down = wanted.center.v - now.center.v;
  const auto distance = distance_towards(wanted, now);
  if (std::max(std::abs(right), std::abs(down)) > kThere) {
    return {HintKind::kMove, direction_of(right, down), distance};
  }
  const HintDirection tilt = tilt_towards(wanted, now);
  const bool is_tilted = tilt == HintDirection::kNone;
  if (distance && is_tilted) return {*distance};
  if (distance) return {*distance, tilt, HintKind::kTilt};
  if (!is_tilted) return {HintKind::kTilt, tilt};
  return {HintKind::kHoldStill};
}

void ViewCoverage::Range::add(double value) {
  low = std::min(low, value);
  high = std::max(high, value);
}

double ViewCoverage::Range::share_of(double whole) const {
  return std::clamp((high - low) / whole, 0.0, 1.0);
}

void ViewCoverage::add(const View& view) {
  const auto footprint = footprint_of(view);
  if (!footprint) return;
  empty_ = false;
  x_.add(footprint->x);
  y_.add(footprint->y);
  largest_ = std::max(largest_, footprint->size);
  most_tilted_ = std::max(most_tilted_, footprint->tilt);
  add_nearer_edges(*footprint);
  const auto hull = convex_hull(view.observation.uv);
  const ImageSize size = view.observation.image_size;
  for (int row = 0; row < kRows; ++row) {
    for (int column = 0; column < kColumns; ++column) {
      const Pixel center = {coordinate_at((column + 0.5) / kColumns, size.width),
                            coordinate_at((row + 0.5) / kRows, size.height)};
      if (contains(hull, center))
        covered_[static_cast<std::size_t>(row * kColumns + column)] = true;
    }
  }
}

double ViewCoverage::coverage() const {
  return static_cast<double>(std::count(covered_.begin(), covered_.end(), true)) /
         static_cast<double>(covered_.size());
}

CoverageMap ViewCoverage::map() const {
  return {kColumns, std::vector<bool>(covered_.begin(), covered_.end())};
}

double ViewCoverage::x() const { return x_.share_of(kRangeX); }
double ViewCoverage::y() const { return y_.share_of(kRangeY); }
double ViewCoverage::size() const { return std::clamp(largest_ / kRangeSize, 0.0, 1.0); }
double ViewCoverage::tilt() const { return std::clamp(most_tilted_ / kRangeTilt, 0.0, 1.0); }

bool ViewCoverage::spans_all() const { return std::min({x(), y(), size(), tilt()}) >= 1; }

void ViewCoverage::add_nearer_edges(const BoardFootprint& p) {
  const bool large = p.size >= kLargeEnough;
  const bool sideways = large && p.aspect < kForeshortened && std::abs(p.left_nearer) <= kTiltRatio;
  const bool upright =
      large && p.aspect > 1 / kForeshortened && std::abs(p.top_nearer) <= kTiltRatio;
  seen_nearer_[0] |= p.left_nearer > kTiltRatio || sideways;
  seen_nearer_[1] |= p.left_nearer < -kTiltRatio || sideways;
  seen_nearer_[2] |= p.top_nearer > kTiltRatio || upright;
  seen_nearer_[3] |= p.top_nearer < -kTiltRatio || upright;
}

Hint ViewCoverage::hint() const {
  using enum HintKind;
  using enum HintDirection;
  if (empty_) return {kShowBoard};
  if (spans_all()) return {kGood};
  if (size() < 0.5) return {kComeCloser};
  for (std::size_t i = 0; i < seen_nearer_.size(); ++i) {
    if (!seen_nearer_[i]) return {kTilt, kEdges[i]};
  }
  if (x() < 1) return {kMove, x_.low > 1 - x_.high ? kLeft : kRight};
  if (y() < 1) return {kMove, y_.low > 1 - y_.high ? kTop : kBottom};
  if (tilt() < 1) return {kTilt};
  if (size() < 1) return {kComeCloser};
  return {kGood};
}

}  // namespace calvin
