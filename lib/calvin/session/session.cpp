// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Judges each observation (usable, still, unlike the views before) and keeps the views that add to
// what is known.

#include "calvin/session/session.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calvin/geometry/convex_hull.hpp"

namespace calvin {

namespace {

constexpr std::size_t kFewestCorners = 6;
constexpr double kStill = 0.1;           // px while a frame is read out
constexpr double kMostSigma = 1e6;       // px; above it counts as not known, as in solve()
constexpr double kSharp = 0.0015;        // of the image diagonal, 1 sigma of the edges
constexpr double kSharpEnough = 2;       // px
constexpr double kSmallest = 0.01;       // of the image's area
constexpr double kNewPosition = 0.08;    // of the image diagonal
constexpr double kNewShape = 0.025;      // of the board's size in the image
constexpr double kSameSheet = 0.5;       // of the board's size in the image, between two frames
constexpr std::size_t kMostSheets = 16;  // of a board that are remembered
constexpr std::size_t kMostBoards = 16;  // by their texts, likewise
constexpr std::size_t kMostTimes = 16;   // between frames, likewise

// How the corners that two observations share have moved, px.
struct Motion {
  std::size_t shared = 0;
  double all = 0;           // RMS distance, less the noise of the corners
  double center = 0;        // distance of the centres
  double about_center = 0;  // mean distance about the centres
};

Motion motion(const Observation& from, const Observation& to) {
  std::vector<Pixel> moves;
  Pixel mean;
  double square = 0;
  const auto variance = [](const Observation& o, std::size_t i) {
    return i < o.sigma.size() && o.sigma[i] <= kMostSigma ? 2 * o.sigma[i] * o.sigma[i] : 0;
  };
  for (std::size_t i = 0; i < to.ids.size(); ++i) {
    const auto it = std::find(from.ids.begin(), from.ids.end(), to.ids[i]);
    if (it == from.ids.end()) continue;
    const auto before = static_cast<std::size_t>(it - from.ids.begin());
    const Pixel& old = from.uv[before];
    moves.push_back({to.uv[i].u - old.u, to.uv[i].v - old.v});
    square += moves.back().u * moves.back().u + moves.back().v * moves.back().v;
    square -= variance(to, i) + variance(from, before);
    mean.u += moves.back().u;
    mean.v += moves.back().v;
  }
  Motion m;
  m.shared = moves.size();
  if (moves.empty()) return m;
  const auto n = static_cast<double>(moves.size());
  mean = {mean.u / n, mean.v / n};
  m.center = std::hypot(mean.u, mean.v);
  m.all = std::sqrt(std::max(square, 0.0) / n);
  for (const Pixel& d : moves) {
    m.about_center += std::hypot(d.u - mean.u, d.v - mean.v) / n;
  }
  return m;
}

double diagonal(ImageSize size) { return std::hypot(size.width, size.height); }

// 0 where it is not known.
double seconds_between(const Observation& from, const Observation& to) {
  if (from.timestamp == kNoTimestamp || to.timestamp == kNoTimestamp) return 0;
  return to.timestamp > from.timestamp ? 1e-9 * static_cast<double>(to.timestamp - from.timestamp)
                                       : 0;
}

double hull_area(const Observation& seen) { return polygon_area(convex_hull(seen.uv)); }

// Whether a sheet was seen on a frame already; equal sheets lie beside each other. One that is
// mostly covered is as small as what is seen of it.
bool seen_on(const std::vector<Observation>& frame, const Observation& sheet) {
  const double area = frame.empty() ? 0 : hull_area(sheet);
  return std::ranges::any_of(frame, [&sheet, area](const Observation& other) {
    const Motion m = motion(other, sheet);
    return m.shared > 0 && m.center <= kSameSheet * std::sqrt(std::min(area, hull_area(other)));
  });
}

// Whether both are of one frame, or of copies of it.
bool is_same(const Observation& a, const Observation& b) {
  return a.timestamp != kNoTimestamp && a.timestamp == b.timestamp && a.board == b.board &&
         a.ids == b.ids && std::ranges::equal(a.uv, b.uv, [](Pixel one, Pixel other) {
           return one.u == other.u && one.v == other.v;
         });
}

}  // namespace

void Session::pass(const Observation& seen) {
  begin_frame(seen);
  if (seen.timestamp == kNoTimestamp) recent(seen.board).before.clear();
}

Reason Session::offer(const View& view, bool informs) {
  begin_frame(view.observation);
  const Reason reason = usable(view);
  if (reason != Reason::kAccepted) return reason;
  Recent& r = recent(view.observation.board);
  const auto is_this = [&view](const Observation& o) { return is_same(o, view.observation); };
  if (std::ranges::none_of(r.now, is_this)) return r.reason = judge(view, r, informs);
  const bool kept =
      std::ranges::any_of(views_, [&](const auto& v) { return is_this(v->observation); });
  if (asked_ && !kept && !full()) {
    keep(view);
    r.reason = Reason::kAccepted;
    return r.reason;
  }
  return r.reason == Reason::kAccepted ? Reason::kTooSimilar : r.reason;
}

Reason Session::judge(const View& view, Recent& r, bool informs) {
  // A timestamp that stands still does not make two frames one.
  if (seen_on(r.now, view.observation)) r.before = std::exchange(r.now, {});
  const std::optional<Observation> before = take_previous(view.observation);
  if (r.now.size() >= kMostSheets) r.now.erase(r.now.begin());
  r.now.push_back(view.observation);
  if (!asked_) {
    const Reason worth = worth_keeping(view, before, informs);
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
  if (!views_.empty() && seen.image_size != views_.front()->observation.image_size) {
    return Reason::kOffSize;
  }
  if (!check(view, seen.image_size)) return Reason::kWrongBoard;
  if (seen.ids.size() < kFewestCorners) return Reason::kTooFewPoints;
  return Reason::kAccepted;
}

Reason Session::worth_keeping(const View& view, const std::optional<Observation>& before,
                              bool informs) const {
  if (options_.mode == CaptureMode::kAll) return Reason::kAccepted;
  if (options_.mode == CaptureMode::kManual) return Reason::kTooSimilar;
  const Observation& seen = view.observation;
  const ImageSize size = seen.image_size;
  if (hull_area(seen) < kSmallest * size.width * size.height) return Reason::kTooSmall;
  if (!before || before->image_size != size) return Reason::kMoving;
  const Motion moved = motion(*before, seen);
  if (moved.shared < kFewestCorners || readout_share(*before, seen) * moved.all > kStill) {
    return Reason::kMoving;
  }
  if (seen.blur > std::max(kSharp * diagonal(size), kSharpEnough)) return Reason::kBlurred;
  return informs && is_new(view) ? Reason::kAccepted : Reason::kTooSimilar;
}

void Session::time_frame(std::uint64_t timestamp) {
  const std::uint64_t last = std::exchange(last_frame_, timestamp);
  if (last == kNoTimestamp || timestamp <= last) return;
  if (frame_times_.size() >= kMostTimes) frame_times_.erase(frame_times_.begin());
  frame_times_.push_back(1e-9 * static_cast<double>(timestamp - last));
}

// Neither a burst of frames nor frames that were left out change it.
double Session::frame_time() const {
  if (frame_times_.empty()) return 0;
  std::vector<double> sorted = frame_times_;
  std::ranges::sort(sorted);
  return sorted[(sorted.size() - 1) / 4];
}

double Session::readout_share(const Observation& before, const Observation& now) const {
  const double between = seconds_between(before, now);
  const double readout = options_.readout > 0 ? options_.readout : frame_time();
  return between > 0 && readout > 0 ? readout / between : 1;
}

Session::Recent& Session::recent(const std::string& board) {
  const auto it = std::ranges::find(recent_, board, &Recent::board);
  if (it != recent_.end()) return *it;
  if (recent_.size() >= kMostBoards) recent_.erase(recent_.begin());
  recent_.push_back({board, kNoTimestamp, {}, {}});
  return recent_.back();
}

void Session::begin_frame(const Observation& seen) {
  Recent& r = recent(seen.board);
  const bool timed = seen.timestamp != kNoTimestamp;
  if (timed && seen.timestamp != last_frame_) time_frame(seen.timestamp);
  if (timed && seen.timestamp == r.frame) return;
  if (timed) r.before.clear();
  r.before.insert(r.before.end(), r.now.begin(), r.now.end());
  r.now.clear();
  // Without timestamps a board that was not seen is all that tells of a gap.
  if (!timed && !seen.found()) r.before.clear();
  while (r.before.size() > kMostSheets) r.before.erase(r.before.begin());
  r.frame = seen.timestamp;
}

std::optional<Observation> Session::take_previous(const Observation& now) {
  std::vector<Observation>& before = recent(now.board).before;
  auto nearest = before.end();
  double least = 0;
  for (auto it = before.begin(); it != before.end(); ++it) {
    const Motion m = motion(*it, now);
    if (m.shared == 0 || (nearest != before.end() && m.center >= least)) continue;
    nearest = it;
    least = m.center;
  }
  if (nearest == before.end()) return std::nullopt;
  // Another sheet of the board, or one that has moved too far to tell.
  if (least > kSameSheet * std::sqrt(hull_area(now))) return std::nullopt;
  Observation observation = std::move(*nearest);
  before.erase(nearest);
  return observation;
}

bool Session::is_new(const View& view) const {
  const double scale = diagonal(view.observation.image_size);
  const double extent = std::sqrt(hull_area(view.observation));
  return std::all_of(views_.begin(), views_.end(), [&](const auto& kept) {
    if (kept->observation.board != view.observation.board) return true;
    const Motion m = motion(kept->observation, view.observation);
    return m.shared < kFewestCorners || m.center > kNewPosition * scale ||
           m.about_center > kNewShape * extent;
  });
}

bool Session::full() const noexcept {
  return options_.max_views > 0 && views_.size() >= static_cast<std::size_t>(options_.max_views);
}

void Session::keep(const View& view) {
  asked_ = false;
  views_.push_back(std::make_shared<const View>(view));
  coverage_.add(view);
}

void Session::reset() {
  views_.clear();
  coverage_.clear();
  recent_.clear();
  asked_ = false;
  last_frame_ = kNoTimestamp;
  frame_times_.clear();
}

bool Session::remove_view(std::size_t index) {
  if (index >= views_.size()) return false;
  views_.erase(views_.begin() + static_cast<std::ptrdiff_t>(index));
  coverage_.clear();
  for (const auto& view : views_) coverage_.add(*view);
  return true;
}

Progress Session::progress() const {
  Progress p;
  p.views = static_cast<int>(views_.size());
  p.coverage = coverage_.coverage();
  p.x = coverage_.x();
  p.y = coverage_.y();
  p.size = coverage_.size();
  p.tilt = coverage_.tilt();
  p.hint = to_text(hint());
  return p;
}

bool Session::complete() const {
  if (views_.empty() || static_cast<int>(views_.size()) < options_.min_views) return false;
  return full() || options_.mode != CaptureMode::kAuto || coverage_.spans_all();
}

}  // namespace calvin
