// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What a session takes in: frames, views of boards, and commands. session_update.cpp brings other
// settings into force, session_solves.cpp says what is solved and what is made of the results.

#include "calvin/session/calibration_session.hpp"

#include <cmath>
#include <utility>

#include "calvin/geometry/convex_hull.hpp"
#include "calvin/session/guidance/hint_target.hpp"
#include "calvin/target/board.hpp"

namespace calvin {

namespace {

bool covers_most(const Calibration& calibration) {
  constexpr double kMost = 0.8;  // of the picture
  const ImageSize size = calibration.image_size;
  return polygon_area(calibration.covered) >= kMost * size.width * size.height;
}

// Whether a calibration is as good as `target` px where corners were seen, and that is most of the
// picture, or the rest is not much worse: a board that is held in the middle is never done.
bool reaches(const Calibration& calibration, double target) {
  constexpr double kMuchWorse = 5;  // times the target
  if (calibration.expected_error.value_or(HUGE_VAL) > target) return false;
  return covers_most(calibration) ||
         calibration.expected_error_anywhere.value_or(0) <= kMuchWorse * target;
}

// Whether there is nothing to ask for any more; `target` px, 0 where the user has set none.
bool is_good_enough(const Calibration& calibration, double target) {
  constexpr double kAnywhere = 0.15;  // px
  if (target > 0) return reaches(calibration, target);
  return covers_most(calibration) &&
         calibration.expected_error_anywhere.value_or(HUGE_VAL) <= kAnywhere;
}

}  // namespace

bool CalibrationSession::set_size(ImageSize size, std::optional<Error>& warning) {
  if (std::exchange(size_, size) == size) return false;
  auto fitted = fit_initial(plan_, size);
  initial_ = std::move(fitted.calibration);
  warning = std::move(fitted.warning);
  change_views(size);
  renew_hint();
  return true;
}

void CalibrationSession::change_views(ImageSize size) {
  constexpr std::size_t kMostAside = 3000;  // a stream may change its size for ever
  const Session::Views before = views_.views();
  if (!before.empty()) begin_session();
  Session::Views candidates = std::exchange(set_aside_, {});
  candidates.insert(candidates.end(), before.begin(), before.end());
  for (const auto& view : candidates) {
    if (view->observation.image_size != size) {
      set_aside_.push_back(view);
    } else if (views_.restore(view) == Reason::kAccepted) {
      camera_ = view->observation.camera;
      board_ = view->board;
      note_taken({.timestamp = view->observation.timestamp});
    }
  }
  if (set_aside_.size() > kMostAside) {
    set_aside_.erase(set_aside_.begin(),
                     set_aside_.end() - static_cast<std::ptrdiff_t>(kMostAside));
  }
  // Only the first frame tells whether the source is live, and with it what is solved for.
  taken_up_ = !views_.views().empty();
  if (taken_up_) ++revision_;
  const std::size_t taken_up = views_.views().size();
  if (auto notice = other_frames(size, taken_up, set_aside_)) say_later(*std::move(notice));
}

void CalibrationSession::note_taken(const FrameTimes& times) {
  if (const auto gone = views_.replaced()) {
    taken_.erase(taken_.begin() + static_cast<std::ptrdiff_t>(*gone));
  }
  taken_.push_back({times});
  ++accepted_;
}

void CalibrationSession::set_live(bool live) {
  live_ = live;
  const CaptureMode before = views_.options().mode;
  views_.set_options(plan_.session_options(live));
  if (views_.options().mode != before) next_solve_ = 0;
  // The hint tells where a limit is reached.
  if (!std::exchange(taken_up_, false) || views_.views().empty()) return;
  (void)consider();
  waits_for_readout_ = !views_.readout();
}

// Views that were taken up may move, and are mended only where the time of a frame is known.
void CalibrationSession::solve_with_readout() {
  if (!waits_for_readout_ || !views_.readout()) return;
  waits_for_readout_ = false;
  ++revision_;
  if (enough_views()) ask(finished_);
}

// ---- Views --------------------------------------------------------------------------------------

Result<Board> CalibrationSession::board_of(const std::string& text) {
  constexpr std::size_t kMany = 16;
  if (const auto known = boards_.find(text); known != boards_.end()) return known->second;
  auto board = parse_board(text);
  if (!board) return board;
  if (boards_.size() >= kMany) boards_.clear();
  boards_.emplace(text, *board);
  return board;
}

bool CalibrationSession::first_complaint() { return !std::exchange(complained_, true); }

Offered CalibrationSession::offer(const Observation& observation, const FrameTimes& times,
                                  std::size_t place) {
  Offered offered;
  drop_stale_guide(observation.timestamp);
  if (observation.timestamp != kNoTimestamp) newest_ = observation.timestamp;
  solve_with_readout();
  if (!observation.found()) {
    views_.pass(observation);
    if (camera_.empty()) camera_ = observation.camera;
    if (wrong_board_) offered.reason = Reason::kWrongBoard;
    report(offered, place);
    return offered;
  }
  last_obstacle_ = obstacle_;
  const auto board = board_of(observation.board);
  if (!board) {
    if (first_complaint()) offered.complaint = board.error();
    return offered;
  }
  offered.reason = observation.image_size != size_ ? Reason::kOffSize : Reason::kTooSimilar;
  if (finished_ || observation.image_size != size_) {
    views_.pass(observation);
    return offered;
  }
  const bool new_board = choose_board(*board, times);
  if (new_board) guide_.reset();
  camera_ = observation.camera;
  times_ = times;
  View view = {observation, *board};
  if (plan_.settings.runs < 2) view.observation.patches.reset();
  const Status fine = check(view, observation.image_size);
  const Reason reason = views_.offer(view, fine ? worth(view) : ViewWorth{});
  if (reason == Reason::kAccepted) {
    note_taken(times);
    write_down(false, {views_.views().back()});
    accepted_at_ = observation.timestamp;
    capture_.restart(accepted_at_);
    offered.reached = consider();
  }
  offered.reason = reason;
  if (reason != Reason::kAccepted) ++refused_[reason];
  if (board_ == *board && fine) guide_from(view);
  if (new_board || reason == Reason::kAccepted) renew_hint();
  report(offered, place);
  if (offered.report && !fine && first_complaint()) offered.complaint = fine.error();
  return offered;
}

void CalibrationSession::report(Offered& offered, std::size_t place) {
  if (place >= last_reasons_.size()) last_reasons_.resize(place + 1, Reason::kAccepted);
  const bool is_new = std::exchange(last_reasons_[place], offered.reason) != offered.reason;
  const bool is_hindered = !obstacle_.empty() && obstacle_ != told_obstacle_;
  offered.report = offered.reason == Reason::kAccepted || is_new || is_hindered;
  if (!offered.report) return;
  told_obstacle_ = obstacle_;
  offered.camera = camera_name();
  offered.progress = progress();
}

void CalibrationSession::hear_detector(const std::string& words, bool wrong_board) {
  obstacle_ = words;
  wrong_board_ = wrong_board && !words.empty();
  if (!words.empty()) last_obstacle_ = words;
}

ViewWorth CalibrationSession::worth(const View& view) {
  if (!guide_) return capture_.worth(std::nullopt, view.observation.timestamp);
  share_ = guide_->share(view);
  return capture_.worth(NearView{share_, guide_->distance(view)}, view.observation.timestamp);
}

// A camera that is known badly may ask for what it cannot see.
void CalibrationSession::drop_stale_guide(std::uint64_t now) {
  constexpr std::uint64_t kLong = 10'000'000'000;  // ns
  const bool known = now != kNoTimestamp && accepted_at_ != kNoTimestamp && now >= accepted_at_;
  if (!guide_ || !known || now - accepted_at_ < kLong || !hint_.target) return;
  guide_.reset();
  renew_hint();
}

// Words that change with every twitch of a hand cannot be followed.
void CalibrationSession::guide_from(const View& view) {
  constexpr std::uint64_t kReadable = 2'000'000'000;  // ns
  if (!guide_ || !guide_->footprint() || !hint_.target) return;
  const auto seen = footprint_of(view);
  if (!seen) return;
  Hint next = hint_towards(*guide_->footprint(), *seen);
  next.target = hint_.target;
  const std::uint64_t now = view.observation.timestamp;
  const bool known = now != kNoTimestamp && hint_since_ != kNoTimestamp && now >= hint_since_;
  if (next == hint_ || (known && now - hint_since_ < kReadable)) return;
  hint_ = next;
  hint_since_ = now;
}

bool CalibrationSession::choose_board(const Board& seen, const FrameTimes& times) {
  constexpr int kGone = 15;  // frames with other boards alone
  const bool next = times.timestamp == kNoTimestamp || times.timestamp != times_.timestamp;
  if (board_ == seen) {
    frames_without_board_ = 0;
  } else if (next) {
    ++frames_without_board_;
  }
  if (board_ && (board_ == seen || frames_without_board_ <= kGone)) return false;
  board_ = seen;
  frames_without_board_ = 0;
  return true;
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
  }
  return now;
}

std::string CalibrationSession::hint_text() const {
  // As long as another board is in view, or it is dark, nothing else helps.
  if (!obstacle_.empty()) return obstacle_;
  const bool is_told = verdict_until_ != kNoTimestamp && newest_ <= verdict_until_;
  if (is_told) return verdict_words_;
  return to_text(views_.views().empty() ? first_hint() : hint_);
}

// Whoever shows the board and has no view of it yet has to know why.
Hint CalibrationSession::first_hint() const {
  for (const Reason reason : last_reasons_) {
    if (reason == Reason::kMoving) return {HintKind::kHoldStill};
    if (reason == Reason::kTooSmall) return {HintKind::kComeCloser};
  }
  return hint_;
}

std::optional<Camera> CalibrationSession::camera() const {
  for (const std::optional<Calibration>* known : {&calibration_, &initial_}) {
    if (!*known) continue;
    if (auto camera = Camera::make(**known)) return *std::move(camera);
  }
  return nominal_camera(size_);
}

void CalibrationSession::renew_hint() {
  if (finished_) {
    hint_ = {HintKind::kDone};
    return;
  }
  if (guide_ && calibration_ && is_good_enough(*calibration_, plan_.settings.target_error)) {
    hint_ = {HintKind::kGood};
    return;
  }
  if (guide_ && guide_->target()) {
    if (!hint_.target) hint_ = views_.hint();
    hint_.target = to_pose(*guide_->target());
    return;
  }
  hint_ = views_.hint();
  if (!board_) return;
  if (const auto now = camera()) hint_.target = hint_target(views_.coverage(), *board_, *now);
}

bool CalibrationSession::enough_views() const {
  return views_.views().size() >= static_cast<std::size_t>(plan_.settings.min_views);
}

std::string CalibrationSession::camera_name() const {
  return plan_.settings.camera.empty() ? camera_ : plan_.settings.camera;
}

std::string_view CalibrationSession::limit_reached() const {
  if (!enough_views()) return {};
  const std::size_t views = views_.views().size();
  const bool full =
      plan_.settings.max_views > 0 && views >= static_cast<std::size_t>(plan_.settings.max_views);
  if (full) return "max-views";
  const bool good = plan_.settings.target_error > 0 && published_ && calibration_ &&
                    reaches(*calibration_, plan_.settings.target_error);
  return good ? "target-error" : "";
}

std::string_view CalibrationSession::consider() {
  ++revision_;
  if (!enough_views()) return {};
  if (const std::string_view limit = limit_reached(); !limit.empty()) {
    finished_ = true;
    ask(true);
    return limit;
  }
  if (accepted_ >= next_solve_) {
    // When every frame is a view, each solve waits for a quarter more of them.
    const bool all = views_.options().mode == CaptureMode::kAll;
    next_solve_ = accepted_ + (all ? views_.views().size() / 4 : 0) + 1;
    ask(false);
  }
  return {};
}

// ---- Commands -----------------------------------------------------------------------------------

Status CalibrationSession::solve_now(const SessionSettings& now) {
  solve_waits_ = enough_views();
  if (!solve_waits_) return tl::unexpected<Error>(too_few());
  solve_when_up_to_date(now);
  return {};
}

void CalibrationSession::reset() {
  const bool any = !views_.views().empty() || !set_aside_.empty();
  begin_session();
  set_aside_.clear();
  if (any) write_down(true, {});
}

void CalibrationSession::begin_session() {
  ++generation_;
  ++session_;
  ++revision_;
  views_.reset();
  taken_.clear();
  calibration_.reset();
  announcement_.reset();
  published_ = finished_ = complained_ = false;
  asked_ = final_owed_ = solve_waits_ = false;
  last_reasons_.clear();
  refused_.clear();
  obstacle_.clear();
  wrong_board_ = false;
  told_obstacle_.clear();
  last_obstacle_.clear();
  solve_error_.clear();
  accepted_ = next_solve_ = 0;
  writes_.reset();
  guide_.reset();
  accepted_at_ = kNoTimestamp;
  verdict_until_ = kNoTimestamp;
  waits_for_readout_ = false;
  capture_ = {};
  renew_hint();
}

void CalibrationSession::outdate_results() {
  ++generation_;
  ++revision_;
  published_ = false;
  announcement_.reset();
  writes_.forget();
}

bool CalibrationSession::remove_view(std::size_t index) {
  if (!views_.remove_view(index)) return false;
  Session::Views left = set_aside_;
  left.insert(left.end(), views_.views().begin(), views_.views().end());
  write_down(true, std::move(left));
  taken_.erase(taken_.begin() + static_cast<std::ptrdiff_t>(index));
  outdate_results();  // what is being solved has the view in it, and the files have it
  finished_ = !limit_reached().empty();
  next_solve_ = 0;
  guide_.reset();
  if (enough_views()) {
    ask(finished_);
  } else {
    calibration_.reset();
    solve_error_.clear();
  }
  renew_hint();
  return true;
}

}  // namespace calvin
