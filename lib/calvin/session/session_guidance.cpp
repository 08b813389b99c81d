// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What a session tells its user: how far it is, what to show next, and which views that waits for.

#include <algorithm>
#include <utility>

#include "calvin/session/calibration_session.hpp"
#include "calvin/session/guidance/hint_target.hpp"
#include "calvin/session/guidance/stopping_criterion.hpp"

namespace calvin {

namespace {

constexpr double kFar = 0.25;  // of what the target tells: less is nowhere near it
constexpr const char* kBlurred =
    "The picture is blurred: focus the lens, or give it more light and a shorter exposure.";
constexpr const char* kAskForViews =
    "Views are taken when they are asked for: press the space bar, or send capture-view.";
constexpr std::uint64_t kLost = 700'000'000;  // ns, longer than a board is lost while it moves

// Whether that long has passed; not where a time is unknown.
bool is_past(std::uint64_t since, std::uint64_t time, std::uint64_t now) {
  return now != kNoTimestamp && since != kNoTimestamp && now >= since && now - since >= time;
}

}  // namespace

ViewWorth CalibrationSession::worth(const View& view) {
  if (!guide_) return capture_.worth(std::nullopt, view.observation.timestamp);
  share_ = guide_->share(view);
  const NearView near{share_, guide_->distance(view)};
  ViewWorth worth = capture_.worth(near, view.observation.timestamp);
  if (views_.full() && exchanges_views()) worth.in_place_of = guide_->exchange_for(view);
  return worth;
}

// The view that tells most may be one that a hand does not get to: whoever another view was taken
// of for want of it is asked for something else next. Who does not follow yet gives views of
// anything, while the outline stays where it is for a time: or nobody could begin to follow it.
void CalibrationSession::note_answer() {
  constexpr std::uint64_t kStale = 8'000'000'000;  // ns
  if (!guide_) return;
  const bool is_far = share_ < kFar;
  if (is_far && !capture_.follows() && !is_past(asked_at_, kStale, newest_)) return;
  answered_ = true;
  if (is_far) miss_target();
}

void CalibrationSession::miss_target() {
  constexpr std::size_t kMost = 3;  // then the first one may be asked for again
  if (!guide_->target_view()) return;
  missed_.push_back(guide_->target_view());
  if (missed_.size() > kMost) missed_.erase(missed_.begin());
}

void CalibrationSession::leave_stale_target(std::uint64_t now) {
  constexpr std::uint64_t kTry = 3'500'000'000;  // ns, in which a hand gets there and rests
  if (!guide_ || !hint_.target || now == kNoTimestamp) return;
  if (!is_past(asked_at_, kTry, now)) return;
  const bool is_lost = is_past(times_.timestamp, kLost, now);
  const bool is_held = std::ranges::find(last_reasons_, Reason::kTooSimilar) != last_reasons_.end();
  const bool in_vain = is_held && share_ < kFar;
  if (guide_->has_another() && (is_lost || in_vain)) {
    miss_target();
    guide_->ask_for_another();
    answered_ = false;
    share_ = 0;
    asked_at_ = now;
    capture_.change_target(now);
  } else if (is_lost) {
    // A camera that is known badly may ask for what it cannot see.
    guide_.reset();
  } else {
    return;
  }
  renew_hint();
}

void CalibrationSession::change_hint(Hint next) {
  if (next != hint_) hint_since_ = newest_;
  hint_ = std::move(next);
}

// Words that change with every twitch of a hand cannot be followed.
void CalibrationSession::guide_from(const View& view) {
  constexpr std::uint64_t kReadable = 2'000'000'000;  // ns
  if (!guide_ || !guide_->footprint() || !hint_.target) return;
  const auto seen = footprint_of(view);
  if (!seen) return;
  Hint next = hint_towards(*guide_->footprint(), *seen);
  next.target = hint_.target;
  if (leads_ && next == hint_) return;
  const bool is_timed = newest_ != kNoTimestamp && hint_since_ != kNoTimestamp;
  if (is_timed && newest_ >= hint_since_ && newest_ - hint_since_ < kReadable) return;
  hint_ = next;
  hint_since_ = newest_;
  leads_ = true;
}

void CalibrationSession::compare_with_target() {
  const double target = plan_.settings.target_error;
  is_accurate_ = calibration_ && is_accurate(*calibration_, target);
  is_good_enough_ = calibration_ && is_good_enough(*calibration_, target);
}

Progress CalibrationSession::progress() const {
  Progress now = views_.progress();
  now.hint = hint_text();
  now.target = hint_.target;
  if (guide_ && hint_.target) {
    for (const Pixel& at : guide_->outline()) {
      now.ghost.push_back({(at.u + 0.5) / size_.width, (at.v + 0.5) / size_.height});
    }
    now.ghost_share = std::min(share_, 1.0);
  }
  if (calibration_) {
    now.rms = calibration_->rms;
    now.expected_error = calibration_->expected_error;
    now.expected_error_anywhere = calibration_->expected_error_anywhere;
    now.wanted_error_anywhere = wanted_error_anywhere(plan_.settings.target_error);
    now.parameters =
        parameter_groups(parameter_errors_, wanted_error_anywhere(plan_.settings.target_error));
  }
  now.points = points_.placed(Progress::kMostPoints);
  now.done = calibration_ && (finished_ || is_good_enough_);
  if (now.done) now.summary = parameter_lines(*calibration_);
  return now;
}

void CalibrationSession::notify(std::string words) {
  constexpr std::uint64_t kReadable = 4'000'000'000;  // ns
  notice_ = std::move(words);
  notice_until_ = newest_ == kNoTimestamp ? kNoTimestamp : newest_ + kReadable;
}

// Each of them counts, but words and outline are for one. Whoever shows several on purpose hears it
// once a session and no more.
void CalibrationSession::note_twin_boards(const Board& seen, const Observation& observation,
                                          std::size_t place) {
  if (board_ != seen) return;
  const bool is_twin = place > 0 && observation.timestamp != kNoTimestamp &&
                       observation.timestamp == guided_board_at_;
  guided_board_at_ = observation.timestamp;
  if (!is_twin || std::exchange(twins_told_, true)) return;
  notify("two boards of this kind are in view: both count, but put one away to follow the hints");
  notice_is_new_ = true;
}

std::string CalibrationSession::hint_text() const {
  if (!finished_ && !point_words_.empty()) return point_words_;
  if (!finished_ && clicks_choose()) return points_.hint();
  // As long as another board is in view, or it is dark, nothing else helps.
  if (!obstacle_.empty()) return obstacle_;
  const bool is_told = notice_until_ != kNoTimestamp && newest_ <= notice_until_;
  if (is_told) return notice_;
  if (!finished_ && is_blurred()) {
    return kBlurred;
  }
  // More views of the kind do not help where the views contradict what is solved.
  const bool is_doubted = !finished_ && is_accurate_ && !is_good_enough_;
  if (is_doubted) return advice(misfit_);
  if (views_.views().empty()) return first_hint();
  const bool is_saved = !plan_.settings.location.empty() && writes_.is_written();
  if (finished_ && is_saved) return done_text(plan_.settings.location);
  if (!leads_) return to_text(hint_);
  // Nobody knows which way it is from a board that is not seen.
  const bool is_lost = is_past(times_.timestamp, kLost, newest_);
  return is_lost ? "Show the board where the outline is." : text_to_outline(hint_);
}

// Whether that is why nothing is taken. A board on its way may be blurred for a moment, and where
// nothing more is needed it does not matter.
bool CalibrationSession::is_blurred() const {
  constexpr std::uint64_t kLong = 1'000'000'000;  // ns
  return hint_.kind != HintKind::kGood && is_past(blurred_since_, kLong, newest_);
}

// Whoever shows the board and has no view of it yet has to know why.
std::string CalibrationSession::first_hint() const {
  const bool is_asked_for = views_.options().mode == CaptureMode::kManual;
  for (const Reason reason : last_reasons_) {
    if (reason == Reason::kMoving) return to_text({HintKind::kHoldStill});
    if (reason == Reason::kTooSmall) return to_text({HintKind::kComeCloser});
    if (reason == Reason::kBlurred) return kBlurred;
    if (reason == Reason::kTooSimilar && is_asked_for) return kAskForViews;
  }
  return to_text(hint_);
}

void CalibrationSession::renew_hint() {
  const bool has_target = guide_ && guide_->target();
  leads_ = leads_ && has_target;
  if (finished_) {
    change_hint({HintKind::kDone});
    leads_ = false;
    return;
  }
  if (guide_ && is_good_enough_) {
    change_hint({HintKind::kGood});
    leads_ = false;
    return;
  }
  if (has_target) {
    if (!leads_) change_hint(views_.hint());
    hint_.target = to_pose(*guide_->target());
    const Observation* seen = board_ && !leads_ ? views_.newest(board_->text()) : nullptr;
    if (seen) guide_from({*seen, *board_});
    return;
  }
  change_hint(views_.hint());
  if (!board_) return;
  if (const auto now = camera()) hint_.target = hint_target(views_.coverage(), *board_, *now);
}

}  // namespace calvin
