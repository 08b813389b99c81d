// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

#include "calvin/session/session.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calvin/geometry/convex_hull.hpp"

namespace calvin {

namespace {

constexpr std::size_t kFewestCorners = 6;
constexpr double kStill = 0.003;       // of the image diagonal
constexpr double kSmallest = 0.01;     // of the image's area
constexpr double kNewPosition = 0.08;  // of the image diagonal
constexpr double kNewShape = 0.025;    // of the board's size in the image

// How the corners that two observations share have moved, px.
struct Motion {
  std::size_t shared = 0;
  double all = 0;           // mean distance
  double center = 0;        // distance of the centres
  double about_center = 0;  // mean distance about the centres
};

Motion motion(const Observation& from, const Observation& to) {
  std::vector<Pixel> moves;
  Pixel mean;
  for (std::size_t i = 0; i < to.ids.size(); ++i) {
    const auto it = std::find(from.ids.begin(), from.ids.end(), to.ids[i]);
    if (it == from.ids.end()) continue;
    const Pixel& old = from.uv[static_cast<std::size_t>(it - from.ids.begin())];
    moves.push_back({to.uv[i].u - old.u, to.uv[i].v - old.v});
    mean.u += moves.back().u;
    mean.v += moves.back().v;
  }
  Motion m;
  m.shared = moves.size();
  if (moves.empty()) return m;
  const auto n = static_cast<double>(moves.size());
  mean = {mean.u / n, mean.v / n};
  m.center = std::hypot(mean.u, mean.v);
  for (const Pixel& d : moves) {
    m.all += std::hypot(d.u, d.v) / n;
    m.about_center += std::hypot(d.u - mean.u, d.v - mean.v) / n;
  }
  return m;
}

double diagonal(ImageSize size) { return std::hypot(size.width, size.height); }

double hull_area(const Observation& seen) { return polygon_area(convex_hull(seen.uv)); }

}  // namespace

Reason Session::offer(const View& view) {
  const std::optional<Observation> before = take_previous(view.observation.board);
  const Reason reason = usable(view);
  if (reason != Reason::kAccepted) return reason;
  previous_.push_back(view.observation);
  if (!asked_) {
    const Reason worth = worth_keeping(view, before);
    if (worth != Reason::kAccepted) return worth;
  }
  if (full()) return Reason::kTooSimilar;
  keep(view);
  return Reason::kAccepted;
}

Reason Session::usable(const View& view) const {
  const Observation& seen = view.observation;
  if (!seen.found()) return Reason::kNotFound;
  if (seen.image_size.width < 1 || seen.image_size.height < 1) return Reason::kOffSize;
  if (!views_.empty() && seen.image_size != views_.front().observation.image_size) {
    return Reason::kOffSize;
  }
  if (!check(view, seen.image_size)) return Reason::kWrongBoard;
  if (seen.ids.size() < kFewestCorners) return Reason::kTooFewPoints;
  return Reason::kAccepted;
}

Reason Session::worth_keeping(const View& view, const std::optional<Observation>& before) const {
  if (options_.mode == CaptureMode::kAll) return Reason::kAccepted;
  if (options_.mode == CaptureMode::kManual) return Reason::kTooSimilar;
  const Observation& seen = view.observation;
  const ImageSize size = seen.image_size;
  if (hull_area(seen) < kSmallest * size.width * size.height) return Reason::kTooSmall;
  if (!before || before->image_size != size) return Reason::kMoving;
  const Motion moved = motion(*before, seen);
  if (moved.shared < kFewestCorners || moved.all > kStill * diagonal(size)) return Reason::kMoving;
  return is_new(view) ? Reason::kAccepted : Reason::kTooSimilar;
}

std::optional<Observation> Session::take_previous(const std::string& board) {
  const auto it = std::find_if(previous_.begin(), previous_.end(),
                               [&board](const Observation& o) { return o.board == board; });
  if (it == previous_.end()) return std::nullopt;
  Observation observation = std::move(*it);
  previous_.erase(it);
  return observation;
}

bool Session::is_new(const View& view) const {
  const double scale = diagonal(view.observation.image_size);
  const double extent = std::sqrt(hull_area(view.observation));
  return std::all_of(views_.begin(), views_.end(), [&](const View& kept) {
    if (kept.observation.board != view.observation.board) return true;
    const Motion m = motion(kept.observation, view.observation);
    return m.shared < kFewestCorners || m.center > kNewPosition * scale ||
           m.about_center > kNewShape * extent;
  });
}

bool Session::full() const noexcept {
  return options_.max_views > 0 && views_.size() >= static_cast<std::size_t>(options_.max_views);
}

void Session::keep(const View& view) {
  asked_ = false;
  views_.push_back(view);
  spread_.add(view);
}

void Session::reset() {
  views_.clear();
  spread_.clear();
  previous_.clear();
  asked_ = false;
}

bool Session::remove_view(std::size_t index) {
  if (index >= views_.size()) return false;
  views_.erase(views_.begin() + static_cast<std::ptrdiff_t>(index));
  spread_.clear();
  for (const View& view : views_) spread_.add(view);
  return true;
}

Progress Session::progress() const {
  return {static_cast<int>(views_.size()),
          spread_.coverage(),
          spread_.x(),
          spread_.y(),
          spread_.size(),
          spread_.skew(),
          spread_.hint()};
}

bool Session::complete() const {
  if (views_.empty() || static_cast<int>(views_.size()) < options_.min_views) return false;
  return full() || options_.mode != CaptureMode::kAuto || spread_.spans_all();
}

}  // namespace calvin
