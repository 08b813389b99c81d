// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What a session takes in: frames, views of boards, and commands. session_update.cpp brings other
// settings into force, session_solves.cpp says what is solved and what is made of the results, and
// session_guidance.cpp what the user is told.

#include "calvin/session/calibration_session.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "calvin/session/guidance/hint_target.hpp"
#include "calvin/session/guidance/stopping_criterion.hpp"
#include "calvin/solve/pose.hpp"
#include "calvin/target/board.hpp"

namespace calvin {

void CalibrationSession::note_taken(const FrameTimes& times) {
  if (const auto gone = views_.replaced()) {
    taken_.erase(taken_.begin() + static_cast<std::ptrdiff_t>(*gone));
  }
  taken_.push_back({times});
  ++accepted_;
}

SessionOptions CalibrationSession::capture_options() const {
  SessionOptions options = plan_.session_options(live_);
  if (options.max_views > 0) options.max_views += views_beyond_;
  return options;
}

void CalibrationSession::set_live(bool live) {
  live_ = live;
  const CaptureMode before = views_.options().mode;
  views_.set_options(capture_options());
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
  is_detector_heard_ = true;
  leave_stale_target(observation.timestamp);
  if (observation.timestamp != kNoTimestamp) newest_ = observation.timestamp;
  board_in_view_ = observation.found() || (place > 0 && board_in_view_);
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
    useless_board_ = board.error();
    if (first_complaint()) offered.complaint = board.error();
    return offered;
  }
  if (const Status tells = check_has_pose(*board); !tells) {
    useless_board_ = tells.error();
    return note_light(observation, *board);
  }
  useless_board_.reset();
  offered.reason = observation.image_size != size_ ? Reason::kOffSize : Reason::kTooSimilar;
  if (finished_ || is_of_points_alone() || observation.image_size != size_) {
    views_.pass(observation);
    if (finished_) views_.forget_capture();  // nothing more is captured
    if (capture_unanswered_) report(offered, place);
    return offered;
  }
  const bool new_board = choose_board(*board, times);
  if (new_board) guide_.reset();
  note_twin_boards(*board, observation, place);
  camera_ = observation.camera;
  times_ = times;
  View view = {observation, *board};
  if (plan_.settings.runs < 2) view.observation.patches.reset();
  const Status fine = check(view, observation.image_size);
  const Reason reason = views_.offer(view, fine ? worth(view) : ViewWorth{});
  if (reason == Reason::kAccepted) {
    note_taken(times);
    lens_.view_taken();
    write_down_newest();
    note_answer();
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

// The journal has it, for whoever solves several cameras together.
Offered CalibrationSession::note_light(const Observation& observation, const Board& board) {
  Offered offered;
  views_.pass(observation);
  if (!journaling_) {
    if (first_complaint()) offered.complaint = useless_board_;
    return offered;
  }
  useless_board_->message += " What was seen of it is in the journal.";
  camera_ = observation.camera;
  if (!check({observation, board}, observation.image_size)) return offered;
  const bool timed = observation.timestamp != kNoTimestamp && newest_light_ != kNoTimestamp;
  if (timed && observation.timestamp == newest_light_) return offered;
  const bool anew = timed && observation.timestamp < newest_light_;
  newest_light_ = observation.timestamp;
  View view = {observation, board};
  view.observation.patches.reset();
  Session::Views lines;
  if (anew) lines = all_views();
  lines.push_back(std::make_shared<const View>(std::move(view)));
  write_down(anew, std::move(lines));
  return offered;
}

void CalibrationSession::report(Offered& offered, std::size_t place) {
  if (place >= last_reasons_.size()) last_reasons_.resize(place + 1, Reason::kAccepted);
  const bool is_new = std::exchange(last_reasons_[place], offered.reason) != offered.reason;
  if (place == 0) {
    const std::uint64_t since = blurred_since_ == kNoTimestamp ? newest_ : blurred_since_;
    blurred_since_ = offered.reason == Reason::kBlurred ? since : kNoTimestamp;
  }
  const bool is_answer = std::exchange(capture_unanswered_, false);
  // Whoever chooses the views has rejected no other; before the first one, the hint says how to.
  const bool is_chosen = views_.options().mode == CaptureMode::kManual && !views_.views().empty();
  const bool is_told =
      is_answer || (is_new && !(is_chosen && offered.reason == Reason::kTooSimilar));
  const bool is_hindered = !obstacle_.empty() && obstacle_ != told_obstacle_;
  const bool is_noticed = std::exchange(notice_is_new_, false);
  offered.report = offered.reason == Reason::kAccepted || is_told || is_hindered || is_noticed;
  if (!offered.report) return;
  told_obstacle_ = obstacle_;
  offered.camera = camera_name();
  offered.progress = progress();
}

void CalibrationSession::hear_detector(const std::string& words, bool wrong_board) {
  is_detector_heard_ = true;
  obstacle_ = words;
  wrong_board_ = wrong_board && !words.empty();
  if (!words.empty()) last_obstacle_ = words;
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

std::optional<Camera> CalibrationSession::camera() const {
  for (const std::optional<Calibration>* known : {&calibration_, &initial_}) {
    if (!*known) continue;
    if (auto camera = Camera::make(**known)) return *std::move(camera);
  }
  return nominal_camera(size_);
}

int CalibrationSession::least_views() const {
  return holds_camera(plan_.options) ? 1 : plan_.settings.min_views;
}

bool CalibrationSession::enough_views() const {
  if (manual_view_ && points_suffice_) return true;
  return !is_of_points_alone() && views_.views().size() >= static_cast<std::size_t>(least_views());
}

Error CalibrationSession::too_few() const {
  if (has_points()) return too_few_points(points_.hint());
  if (useless_board_ && views_.views().empty()) return *useless_board_;
  if (!is_detector_heard_) return size_ == ImageSize{} ? no_frames() : nothing_detected();
  return too_few_views(views_.views().size(), least_views(), refused_, last_obstacle_);
}

std::string CalibrationSession::camera_name() const {
  return plan_.settings.camera.empty() ? camera_ : plan_.settings.camera;
}

std::string_view CalibrationSession::limit_reached() const {
  if (!enough_views()) return {};
  const bool good = plan_.settings.target_error > 0 && published_ && is_good_enough_;
  if (good) return "target-error";
  return views_.full() && !exchanges_views() ? "max-views" : "";
}

bool CalibrationSession::exchanges_views() const {
  constexpr std::size_t kTurns = 2;  // each place is taken anew once: then more of it is in vain
  return plan_.settings.target_error > 0 && views_.options().mode == CaptureMode::kAuto &&
         accepted_ < kTurns * views_.views().size() && (!guide_ || guide_->has_exchange());
}

std::string_view CalibrationSession::end_at_limit(bool solve) {
  const std::string_view limit = limit_reached();
  finished_ = !limit.empty();
  if (finished_ && solve) {
    answer_owed_ = true;
    ask(true);
  }
  return limit;
}

std::string_view CalibrationSession::consider() {
  ++revision_;
  if (!enough_views()) return {};
  if (const std::string_view limit = end_at_limit(); !limit.empty()) return limit;
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
  answer_owed_ = true;
  solve_when_up_to_date(now);
  return {};
}

void CalibrationSession::reset() {
  const bool any = !views_.views().empty() || !set_aside_.empty();
  begin_session();
  set_aside_.clear();
  aside_owed_ = false;
  of_other_sizes_.clear();
  begin_points();
  if (any) write_down(true, {});
}

void CalibrationSession::begin_session() {
  ++generation_;
  ++session_;
  ++revision_;
  views_.reset();
  taken_.clear();
  calibration_.reset();
  compare_with_target();
  announcement_.reset();
  published_ = finished_ = complained_ = false;
  asked_ = final_owed_ = answer_owed_ = solve_waits_ = capture_unanswered_ = false;
  if (std::exchange(views_beyond_, 0) > 0) views_.set_options(capture_options());
  last_reasons_.clear();
  refused_.clear();
  obstacle_.clear();
  wrong_board_ = false;
  told_obstacle_.clear();
  last_obstacle_.clear();
  useless_board_.reset();
  solve_error_.clear();
  accepted_ = next_solve_ = 0;
  writes_.reset();
  guide_.reset();
  missed_.clear();
  accepted_at_ = asked_at_ = kNoTimestamp;
  blurred_since_ = kNoTimestamp;
  answered_ = false;
  notice_until_ = guided_board_at_ = kNoTimestamp;
  twins_told_ = notice_is_new_ = false;
  waits_for_readout_ = false;
  capture_ = {};
  lens_.begin();
  board_in_view_ = false;
  forget_points();
  renew_hint();
}

void CalibrationSession::outdate_results() {
  ++generation_;
  ++revision_;
  published_ = false;
  announcement_.reset();
  writes_.forget();
}

void CalibrationSession::write_down_all() { write_down(true, all_views()); }

Session::Views CalibrationSession::all_views() const {
  Session::Views all = set_aside_;
  // Manual points are chosen anew: no journal knows their places.
  std::ranges::copy_if(views_.views(), std::back_inserter(all),
                       [this](const auto& view) { return view != manual_view_; });
  return all;
}

// A view that was given up for a better one is not to come back with the next run. Those that had
// to go because there were too many may: they go again.
void CalibrationSession::write_down_newest() {
  if (views_.exchanged()) return write_down_all();
  write_down(false, {views_.views().back()});
}

bool CalibrationSession::remove_view(std::size_t index) {
  const auto& all = views_.views();
  if (manual_view_ && index < all.size() && all[index] == manual_view_) {
    forget_points();
  } else {
    if (!views_.remove_view(index)) return false;
    write_down_all();
    taken_.erase(taken_.begin() + static_cast<std::ptrdiff_t>(index));
  }
  views_changed();
  return true;
}

void CalibrationSession::views_changed() {
  outdate_results();
  finished_ = !limit_reached().empty();
  next_solve_ = 0;
  guide_.reset();
  if (enough_views()) {
    ask(finished_);
  } else {
    calibration_.reset();
    compare_with_target();
    solve_error_.clear();
  }
  renew_hint();
}

}  // namespace calvin
