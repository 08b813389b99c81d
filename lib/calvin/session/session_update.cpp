// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// How the settings of a session, and frames of another size, come into force.

#include <algorithm>
#include <utility>

#include "calvin/session/calibration_session.hpp"

namespace calvin {

void CalibrationSession::start(SessionPlan plan, bool writable) {
  plan_ = std::move(plan);
  seen_ = plan_.settings;
  ++plan_serial_;
  size_ = {};
  board_.reset();
  initial_.reset();
  views_beyond_ = 0;
  views_.set_options(capture_options());
  writes_.begin_files(writable);
  set_aside_.clear();
  aside_owed_ = false;
  of_other_sizes_.clear();
  journaling_ = false;
  taken_up_ = false;
  earlier_.reset();
  lens_ = LensWatch(plan_.settings.device);
  stream_ = {};
  times_ = {};
  newest_ = kNoTimestamp;
  entries_.clear();
  begin_session();
}

void CalibrationSession::begin_journal(Session::Views earlier, std::uint64_t newest_light) {
  newest_light_ = newest_light;
  set_aside_ = std::move(earlier);
  journaling_ = true;
}

std::optional<SettingsUpdate> CalibrationSession::begin_update(const SessionSettings& now) {
  if (!is_up_to_date(now)) return SettingsUpdate{now, seen_, plan_, plan_serial_};
  solve_when_up_to_date(now);
  return std::nullopt;
}

std::optional<std::vector<Error>> CalibrationSession::end_update(const SettingsUpdate& update,
                                                                 SettingsRead read,
                                                                 const SessionSettings& now) {
  if (update.serial != plan_serial_) return std::nullopt;
  ++plan_serial_;
  seen_ = update.now;
  std::optional<Error> warning;
  if (read.change.plan.settings != update.plan.settings) {
    warning = adopt(std::move(read.change.plan), read.writable.has_value());
  }
  solve_when_up_to_date(now);
  std::vector<Error> warnings;
  for (Error& error : read.change.refused) warnings.push_back(refused_setting(std::move(error)));
  if (!read.writable) warnings.push_back(read.writable.error());
  if (warning) warnings.push_back(*std::move(warning));
  return warnings;
}

std::optional<Error> CalibrationSession::adopt(SessionPlan plan, bool writable) {
  const bool solve = solves_differently(plan.settings, plan_.settings);
  const bool write = writes_elsewhere(plan.settings, plan_.settings);
  const bool other_points = points_text(plan.settings.points, plan.settings.board) !=
                            points_text(plan_.settings.points, plan_.settings.board);
  const bool other_files = names_other_files(plan.settings, plan_.settings);
  plan_ = std::move(plan);
  compare_with_target();
  if (solve) views_beyond_ = 0;
  views_.set_options(capture_options());
  if (views_.options().mode != CaptureMode::kAuto) guide_.reset();
  std::optional<Error> warning;
  if (solve) {
    auto fitted = fit_initial(plan_, size_);
    initial_ = std::move(fitted.calibration);
    warning = std::move(fitted.warning);
    published_ = false;  // the calibration is one of the old way
    of_other_sizes_.clear();
    solve_error_.clear();
  }
  if (other_points) begin_points();
  weigh_points();
  finished_ = !limit_reached().empty();
  renew_hint();  // `initial` is the camera until there is a solution
  if (other_files) writes_.begin_files(writable);
  if (solve || write) outdate_results();
  const bool final = finished_ && final_revision_ != revision_;
  if (enough_views() && (solve || write || final)) {
    answer_owed_ |= solve;
    ask(final);
  }
  return warning;
}

void CalibrationSession::solve_when_up_to_date(const SessionSettings& now) {
  if (!is_up_to_date(now) || !std::exchange(solve_waits_, false)) return;
  if (enough_views()) ask(true);
}

bool CalibrationSession::set_size(ImageSize size, std::optional<Error>& warning) {
  if (std::exchange(size_, size) == size) return false;
  auto fitted = fit_initial(plan_, size);
  initial_ = std::move(fitted.calibration);
  warning = std::move(fitted.warning);
  change_views(size);
  begin_points();
  renew_hint();
  return true;
}

void CalibrationSession::change_views(ImageSize size) {
  constexpr std::size_t kMostAside = 3000;  // a stream may change its size for ever
  drop_manual_view();                       // its pixels are of pictures of the size before
  const Session::Views before = views_.views();
  const auto known = calibration_of(size);
  aside_owed_ = enough_views() ? final_revision_ != revision_ : aside_owed_;
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
      lens_.views_restored();
    }
  }
  if (set_aside_.size() > kMostAside) {
    set_aside_.erase(set_aside_.begin(),
                     set_aside_.end() - static_cast<std::ptrdiff_t>(kMostAside));
  }
  // Only the first frame tells whether the source is live, and with it what is solved for.
  taken_up_ = !views_.views().empty();
  if (taken_up_) ++revision_;
  // Until they are solved anew, downstream goes on with what they told before.
  if (taken_up_) announcement_ = known;
  const std::size_t taken_up = views_.views().size();
  if (auto notice = other_frames(size, taken_up, set_aside_)) say_later(*std::move(notice));
}

void CalibrationSession::take_up_others() {
  if (!aside_owed_) return;
  const auto size_of = [](const auto& view) { return view->observation.image_size; };
  const auto count = [&](ImageSize size) { return std::ranges::count(set_aside_, size, size_of); };
  const auto most = std::ranges::max_element(
      set_aside_, [&](ImageSize a, ImageSize b) { return count(a) < count(b); }, size_of);
  const auto needed = static_cast<std::ptrdiff_t>(least_views());
  if (most == set_aside_.end() || count(size_of(*most)) < needed) return;
  std::optional<Error> warning;
  if (!set_size(size_of(*most), warning)) return;
  if (warning) say_later({Notice::Kind::kWarning, *std::move(warning)});
}

// What was published of frames of that size; what was of the size before is kept.
std::optional<Calibration> CalibrationSession::calibration_of(ImageSize size) {
  constexpr std::size_t kMost = 8;  // sizes
  if (published_ && calibration_) {
    std::erase_if(of_other_sizes_, [this](const Calibration& of) {
      return of.image_size == calibration_->image_size;
    });
    if (of_other_sizes_.size() >= kMost) of_other_sizes_.erase(of_other_sizes_.begin());
    of_other_sizes_.push_back(*calibration_);
  }
  const auto known = std::ranges::find(of_other_sizes_, size, &Calibration::image_size);
  if (known == of_other_sizes_.end()) return std::nullopt;
  return *known;
}

}  // namespace calvin
