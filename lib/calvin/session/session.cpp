// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Judges each observation (usable, still, unlike the views before) and keeps the views that add to
// what is known.

#include "calvin/session/session.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "calvin/geometry/convex_hull.hpp"

namespace calvin {

namespace {

constexpr std::size_t kFewestCorners = 6;
constexpr double kStill = 0.1;                      // px while a frame is read out
constexpr double kSharp = 0.0015;                   // of the image diagonal, 1 sigma of the edges
constexpr double kSharpEnough = 2;                  // px
constexpr double kSmallest = 0.01;                  // of the image's area
constexpr double kNewPosition = 0.08;               // of the image diagonal
constexpr double kNewShape = 0.025;                 // of the board's size in the image
constexpr std::size_t kMostSheets = 16;             // of a board that are remembered
constexpr std::size_t kMostTexts = 16;              // by their texts, likewise
constexpr std::uint64_t kRestless = 2'200'000'000;  // ns, longer than a board is on its way
constexpr std::size_t kMostTimes = 16;              // between frames, likewise

double diagonal(ImageSize size) { return std::hypot(size.width, size.height); }

double hull_area(const Observation& seen) { return polygon_area(convex_hull(seen.uv)); }

// Whether both can be of one sheet; equal sheets lie beside each other. One that is mostly covered
// is as small as what is seen of it.
bool is_on(const Observation& other, const Observation& sheet) {
  const CornerMotion m = corner_motion(other, sheet);
  return m.shared > 0 &&
         m.center <= kSameSheet * std::sqrt(std::min(hull_area(sheet), hull_area(other)));
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

Reason Session::offer(const View& view, ViewWorth worth) {
  begin_frame(view.observation);
  const Reason reason = usable(view);
  if (reason != Reason::kAccepted) return reason;
  Recent& r = recent(view.observation.board);
  const auto shows_this = [&view](const Sighting& s) { return is_same(s.seen, view.observation); };
  if (std::ranges::none_of(r.now, shows_this)) return r.reason = judge(view, r, worth);
  if (asked_ && !is_kept(view.observation, views_.size()) && !full()) {
    return r.reason = keep(std::make_shared<const View>(view));
  }
  return r.reason == Reason::kAccepted ? Reason::kTooSimilar : r.reason;
}

Reason Session::judge(const View& view, Recent& r, ViewWorth worth) {
  // A timestamp that stands still does not make two frames one.
  const auto is_known = [&view](const Sighting& s) { return is_on(s.seen, view.observation); };
  if (std::ranges::any_of(r.now, is_known)) r.before = std::exchange(r.now, {});
  const std::optional<Sighting> before = take_previous(view.observation);
  if (r.now.size() >= kMostSheets) r.now.erase(r.now.begin());
  r.now.push_back({view.observation, std::nullopt, std::nullopt});
  const auto velocities = before ? velocities_of(r.now.back(), *before) : std::nullopt;
  const Pace pace = pace_of(view.observation, before ? &before->seen : nullptr, velocities);
  // Nobody knows what a board did that was not seen before.
  const std::uint64_t now = view.observation.timestamp;
  if (!before || pace == Pace::kStill) r.rested = now;
  const bool restless = now != kNoTimestamp && now > r.rested && now - r.rested > kRestless;
  if (!asked_) {
    const bool worth_it =
        pace == Pace::kStill ? worth.still : worth.moving || (restless && worth.restless);
    const Reason reason = worth_keeping(view, pace, worth_it, worth.in_place_of);
    if (reason != Reason::kAccepted) return reason;
  }
  const auto place = full() ? place_of(worth.in_place_of) : std::nullopt;
  if ((full() && !place) || is_kept(view.observation, restored_)) return Reason::kTooSimilar;
  // A copy of a picture says nothing of its own.
  const auto is_copy = [&view](const std::shared_ptr<const View>& kept) {
    return shows_same_picture(kept->observation, view.observation);
  };
  if (std::ranges::any_of(views_, is_copy)) return Reason::kTooSimilar;
  const bool mend = velocities && is_significant(*velocities);
  return keep(
      std::make_shared<const View>(mend ? moving(view, *velocities, longest_readout()) : view),
      place);
}

std::optional<std::size_t> Session::place_of(const View* view) const {
  const auto found = std::ranges::find(views_, view, [](const auto& kept) { return kept.get(); });
  if (found == views_.end()) return std::nullopt;
  return static_cast<std::size_t>(found - views_.begin());
}

Reason Session::add(const std::shared_ptr<const View>& view) {
  const bool asked = std::exchange(asked_, false);
  const Reason reason = keep(view);
  asked_ = asked;
  return reason;
}

Reason Session::restore(const std::shared_ptr<const View>& view) {
  const Reason reason = add(view);
  if (reason == Reason::kAccepted) ++restored_;
  return reason;
}

bool Session::is_kept(const Observation& seen, std::size_t count) const {
  return std::ranges::any_of(std::span(views_).first(count), [&seen](const auto& view) {
    return is_same(view->observation, seen);
  });
}

void Session::erase_view(std::size_t index) {
  views_.erase(views_.begin() + static_cast<std::ptrdiff_t>(index));
  if (index < restored_) --restored_;
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

Session::Pace Session::pace_of(const Observation& seen, const Observation* before,
                               const std::optional<CornerVelocities>& velocities) const {
  if (before == nullptr || before->image_size != seen.image_size) return Pace::kUnknown;
  const CornerMotion moved = corner_motion(*before, seen);
  if (moved.shared < kFewestCorners) return Pace::kUnknown;
  if (readout_share(*before, seen) * moved.all <= kStill) return Pace::kStill;
  const bool steady =
      velocities && left_of_motion(seen, velocities->sigma, longest_readout()) <= kStill;
  return steady ? Pace::kSteady : Pace::kUnknown;
}

Reason Session::worth_keeping(const View& view, Pace pace, bool worth_it,
                              const View* in_place_of) const {
  if (options_.mode == CaptureMode::kAll) return Reason::kAccepted;
  if (options_.mode == CaptureMode::kManual) return Reason::kTooSimilar;
  const Observation& seen = view.observation;
  const ImageSize size = seen.image_size;
  if (hull_area(seen) < kSmallest * size.width * size.height) return Reason::kTooSmall;
  if (pace == Pace::kUnknown) return Reason::kMoving;
  if (seen.blur > std::max(kSharp * diagonal(size), kSharpEnough)) return Reason::kBlurred;
  // A board that moves evenly waits until it is held still: there is nothing that it is similar to.
  if (!worth_it && pace == Pace::kSteady && views_.empty()) return Reason::kMoving;
  return worth_it && is_new(view, in_place_of) ? Reason::kAccepted : Reason::kTooSimilar;
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

std::optional<ReadoutTime> Session::readout() const {
  if (options_.readout != 0) return ReadoutTime{options_.readout, 0};
  const double most = frame_time();
  return most > 0 && most <= kFarApart ? std::optional(ReadoutTime{0, most}) : std::nullopt;
}

std::optional<std::string> Session::readout_doubt() const {
  constexpr double kLonger = 1.1;  // times of frames jitter
  const double given = std::abs(options_.readout);
  const double frame = frame_time();
  if (frame <= 0 || given <= kLonger * frame) return std::nullopt;
  return fmt::format(
      "No frame is read for {:.3g} ms where one comes every {:.3g} ms: give readout-time in "
      "nanoseconds, or 0 to have it estimated where the board moves.",
      1e3 * given, 1e3 * frame);
}

double Session::longest_readout() const {
  return options_.readout != 0 ? std::abs(options_.readout) : frame_time();
}

double Session::readout_share(const Observation& before, const Observation& now) const {
  const double between = seconds_between(before, now);
  const double readout = longest_readout();
  return between > 0 && readout > 0 ? readout / between : 1;
}

Session::Recent& Session::recent(const std::string& board) {
  const auto it = std::ranges::find(recent_, board, &Recent::board);
  if (it != recent_.end()) return *it;
  if (recent_.size() >= kMostTexts) recent_.erase(recent_.begin());
  recent_.push_back({board, kNoTimestamp, {}, {}});
  return recent_.back();
}

const Observation* Session::newest(std::string_view board) const {
  const auto of = std::ranges::find(recent_, board, &Recent::board);
  if (of == recent_.end()) return nullptr;
  const auto& sightings = of->now.empty() ? of->before : of->now;
  return sightings.empty() ? nullptr : &sightings.front().seen;
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

std::optional<Sighting> Session::take_previous(const Observation& now) {
  std::vector<Sighting>& before = recent(now.board).before;
  auto nearest = before.end();
  double least = 0;
  for (auto it = before.begin(); it != before.end(); ++it) {
    const CornerMotion m = corner_motion(it->seen, now);
    if (m.shared == 0 || (nearest != before.end() && m.center >= least)) continue;
    nearest = it;
    least = m.center;
  }
  if (nearest == before.end()) return std::nullopt;
  // Another sheet of the board, or one that has moved too far to tell.
  if (least > kSameSheet * std::sqrt(hull_area(now))) return std::nullopt;
  Sighting sighting = std::move(*nearest);
  before.erase(nearest);
  return sighting;
}

bool Session::is_new(const View& view, const View* in_place_of) const {
  const double scale = diagonal(view.observation.image_size);
  const double extent = std::sqrt(hull_area(view.observation));
  return std::all_of(views_.begin(), views_.end(), [&](const auto& kept) {
    if (kept.get() == in_place_of || kept->observation.board != view.observation.board) return true;
    const CornerMotion m = corner_motion(kept->observation, view.observation);
    return m.shared < kFewestCorners || m.center > kNewPosition * scale ||
           m.about_center > kNewShape * extent;
  });
}

bool Session::full() const noexcept {
  return options_.max_views > 0 && views_.size() >= static_cast<std::size_t>(options_.max_views);
}

std::size_t Session::most_views(const View& like) const noexcept {
  constexpr int kMostOfAll = 1000;                 // where every view of a recording is one
  constexpr int kMostChosen = 300;                 // of those that were new when they came
  constexpr std::size_t kMostCorners = 1'000'000;  // of large boards fewer
  constexpr std::size_t kEnough = 50;
  if (options_.mode == CaptureMode::kManual) return std::numeric_limits<std::size_t>::max();
  const int most = options_.mode == CaptureMode::kAll ? kMostOfAll : kMostChosen;
  const std::size_t held =
      std::max(kEnough, kMostCorners / std::max<std::size_t>(1, like.observation.ids.size()));
  return std::max(std::min(static_cast<std::size_t>(most), held),
                  static_cast<std::size_t>(std::max(options_.min_views, options_.max_views)));
}

Reason Session::keep(const std::shared_ptr<const View>& view,
                     std::optional<std::size_t> in_place_of) {
  replaced_.reset();
  exchanged_ = in_place_of.has_value();
  spacing_.add(view);
  auto gone = in_place_of;
  if (!gone && views_.size() >= most_views(*view)) {
    gone = spacing_.most_crowded(asked_ ? views_.size() : views_.size() + 1);
  }
  if (gone) {
    spacing_.remove(*gone);
    if (*gone == views_.size()) return Reason::kTooSimilar;
    erase_view(*gone);
    replaced_ = gone;
  }
  asked_ = false;
  coverage_.add(*view);
  views_.push_back(view);
  return Reason::kAccepted;
}

void Session::reset() {
  views_.clear();
  restored_ = 0;
  spacing_.clear();
  coverage_.clear();
  recent_.clear();
  asked_ = false;
  last_frame_ = kNoTimestamp;
  frame_times_.clear();
}

bool Session::remove_view(std::size_t index) {
  if (index >= views_.size()) return false;
  erase_view(index);
  spacing_.remove(index);
  coverage_.clear();
  for (const auto& view : views_) coverage_.add(*view);
  return true;
}

Progress Session::progress() const {
  Progress p;
  p.views = static_cast<int>(views_.size());
  p.coverage = coverage_.coverage();
  p.coverage_map = coverage_.map();
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
