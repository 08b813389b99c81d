// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Reads intrinsics, asks the session of calibrig what to solve, and publishes what comes of it.

#include "rig/rig_solver.hpp"

#include <utility>

#include <fmt/format.h>

#include "calvin/io/calibration_io.hpp"
#include "calvin/io/settings.hpp"
#include "rig/rig_messages.hpp"

GST_DEBUG_CATEGORY_EXTERN(calibrig_debug);
#define GST_CAT_DEFAULT calibrig_debug

namespace calvin::gst {

void RigSolver::begin(const RigSettings& now, RigSessionSettings session) {
  const std::lock_guard guard(lock_);
  in_use_ = now;
  session_.start(std::move(session));
  json_.clear();
  solution_.reset();
  is_final_ = false;
  solve_error_.reset();
  write_error_.reset();
  complained_ = write_failed_ = false;
  unread_.clear();
  waiting_points_.clear();
}

Status RigSolver::start(const RigNames& names) {
  const RigSettings now = settings();
  auto session = session_settings(now);
  if (!session) return tl::unexpected(session.error());
  for (Status possible : {check_cameras(now.mode, session->options, names.cameras),
                          check_named(session->options, names.pads)}) {
    if (!possible) return possible;
  }
  if (!now.location.empty()) {
    if (const Status writable = can_write(now.location); !writable) {
      post_warning(element_, writable.error());
    }
  }
  begin(now, *std::move(session));
  if (Status started = reader_.start(); !started) return started;
  if (Status started = worker_.start(); !started) return started;
  if (Status started = watcher_.start(); !started) return started;
  file_ = {};  // no job of the run before is left
  return {};
}

void RigSolver::give_way() {
  worker_.give_way();
  watcher_.give_way();
}

namespace {

struct CameraFiles {
  std::optional<Calibration> intrinsics;
  std::optional<KnownPoints> points;
};

Result<CameraFiles> read_files(const RigCameraSettings& settings) {
  CameraFiles files;
  if (!settings.intrinsics.empty()) {
    auto read = parse_calibration_setting(settings.intrinsics);
    if (!read) {
      return make_error(read.error().code, fmt::format("The intrinsics of the camera '{}': {}",
                                                       settings.name, read.error().message));
    }
    files.intrinsics = *std::move(read);
  }
  if (!settings.points.empty()) {
    auto read = read_known_points(settings.points);
    if (!read) {
      return make_error(read.error().code, fmt::format("For the camera '{}': {}", settings.name,
                                                       read.error().message));
    }
    files.points = *std::move(read);
  }
  return files;
}

}  // namespace

Status RigSolver::check_camera(const RigCameraSettings& settings) {
  const auto files = read_files(settings);
  return files ? Status() : tl::unexpected<Error>(files.error());
}

Status RigSolver::add_camera(std::size_t camera, const RigCameraSettings& settings) {
  auto files = read_files(settings);
  if (!files) return tl::unexpected<Error>(files.error());
  {
    const std::lock_guard guard(lock_);
    session_.set_name(camera, settings.name);
    if (files->intrinsics) session_.set_intrinsics(camera, *files->intrinsics);
    if (files->points) session_.set_points(camera, *std::move(files->points));
  }
  post_points_report(camera);
  return {};
}

void RigSolver::add_camera_later(std::size_t camera, const RigCameraSettings& settings) {
  Status possible;
  {
    const std::lock_guard guard(lock_);
    std::vector<std::string> names = session_.names();
    names.push_back(settings.name);
    possible = check_cameras(in_use_.mode, session_.options(), names);
    if (possible) session_.set_name(camera, settings.name);
    if (possible && settings.intrinsics.empty() && settings.points.empty()) return;
    if (possible) unread_.emplace_back(camera, settings);
  }
  if (!possible) {
    post_warning(element_,
                 {possible.error().code,
                  fmt::format("The camera of the pad sink_{}, which came later, is left out. {}",
                              camera, possible.error().message)});
    return;
  }
  reader_.offer([this](const std::stop_token& stop) { read_intrinsics(stop); });
}

// Those of all cameras that wait: a job that comes later takes the place of one that has not begun.
void RigSolver::read_intrinsics(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    std::pair<std::size_t, RigCameraSettings> next;
    {
      const std::lock_guard guard(lock_);
      if (unread_.empty()) return;
      next = std::move(unread_.front());
      unread_.erase(unread_.begin());
    }
    const Status added = add_camera(next.first, next.second);
    if (added) continue;
    const auto report = reader_.begin_report(stop, element_);
    if (report) post_warning(element_, added.error());
  }
}

void RigSolver::remove_camera(std::size_t camera) {
  const std::lock_guard guard(lock_);
  session_.remove(camera);
}

void RigSolver::set_intrinsics(std::size_t camera, const std::string& json) {
  const auto calibration = parse_calibration(json);
  if (!calibration) return;  // an empty one: there is none any more, and the last one stays
  GST_INFO_OBJECT(element_, "the intrinsics of camera %" G_GSIZE_FORMAT " came from upstream",
                  camera);
  const std::lock_guard guard(lock_);
  session_.set_intrinsics(camera, *calibration);
}

// ---- Streaming threads --------------------------------------------------------------------------

void RigSolver::offer(std::size_t camera, Observation observation, const FrameTimes& times,
                      GstClockTime shared_clock) {
  observation.timestamp = shared_clock;
  bool is_kept = false;
  std::optional<Error> complaint;
  std::optional<RigProgress> progress;
  {
    const std::lock_guard guard(lock_);
    times_ = times;
    const auto kept = session_.offer(camera, std::move(observation));
    is_kept = kept.value_or(false);
    if (!kept && !std::exchange(complained_, true)) complaint = kept.error();
    if (is_kept && session_.take_progress()) progress = session_.progress();
  }
  if (complaint) post_warning(element_, *complaint);
  watch_if_due();
  if (!is_kept) return;
  if (progress) post_message(element_, rig_progress_message(times, *progress));
  solve_if_due(false);
}

void RigSolver::solve_if_due(bool final) {
  const std::lock_guard guard(lock_);
  auto due = session_.take_solve(final);
  if (!due) return;
  GST_DEBUG_OBJECT(element_, "%s solve of %" G_GSIZE_FORMAT " cameras asked for",
                   final ? "final" : "intermediate", due->cameras.size());
  const auto job = std::make_shared<const RigJob>(*std::move(due));
  worker_.offer([this, job](const std::stop_token& stop) { run(*job, stop); });
}

void RigSolver::watch_if_due() {
  if (!watcher_.idle()) return;
  std::shared_ptr<const WatchJob> job;
  {
    const std::lock_guard guard(lock_);
    auto due = session_.take_watch();
    if (!due) return;
    job = std::make_shared<const WatchJob>(*std::move(due));
  }
  watcher_.offer([this, job](const std::stop_token& stop) { watch(*job, stop); });
}

bool RigSolver::reinsert(const std::string& camera) {
  bool is_known = false;
  {
    const std::lock_guard guard(lock_);
    is_known = session_.reinsert(camera);
  }
  if (!is_known) {
    post_warning(element_, {ErrorCode::kInvalidArgument,
                            fmt::format("No camera '{}' is linked that could be inserted again: "
                                        "name one as its pad does.",
                                        camera)});
    return false;
  }
  GST_INFO_OBJECT(element_, "the camera '%s' is inserted again", camera.c_str());
  solve_if_due(false);
  return true;
}

bool RigSolver::reinsert(std::size_t camera) {
  std::string name;
  {
    const std::lock_guard guard(lock_);
    name = session_.name(camera);
  }
  return reinsert(name);
}

void RigSolver::finish() {
  if (reader_.drain() && solve_last()) tell_end();
}

void RigSolver::finish_later(std::function<void()> then) {
  reader_.offer([this, then = std::move(then)](const std::stop_token& stop) {
    read_intrinsics(stop);
    if (!solve_last()) return;
    const auto report = reader_.begin_report(stop, element_);
    if (!report) return;
    tell_end();
    then();
  });
}

bool RigSolver::solve_last() {
  if (!watcher_.drain() || !worker_.drain()) return false;
  solve_if_due(true);
  return worker_.drain();
}

void RigSolver::tell_end() {
  std::optional<Error> error;
  std::optional<Error> write_error;
  bool has_rig = false;
  bool files_wanted = false;
  {
    const std::lock_guard guard(lock_);
    files_wanted = !in_use_.location.empty() || !in_use_.exports.empty();
    has_rig = solution_ != nullptr;
    error = solve_error_;
    if (!error && !is_final_) error = session_.lack();
    write_error = write_error_;
  }
  if (error && has_rig) {
    keep_last(*error);
    error = write_error;
  } else if (!error) {
    error = write_error;
  }
  if (!error) return;
  if (files_wanted) {
    post_error(element_, *error);
  } else {
    post_warning(element_, *error);
  }
}

void RigSolver::keep_last(const Error& error) {
  std::shared_ptr<const RigSolution> solution;
  FrameTimes times;
  std::string json;
  {
    const std::lock_guard guard(lock_);
    solution = solution_;
    times = times_;
    json = json_;
  }
  post_warning(element_,
               {error.code, fmt::format("The last solve failed, and the rig before it stays: {}",
                                        error.message)});
  post_message(element_, rig_result_message(times, *solution, in_use().location, json.c_str()));
}

std::optional<std::string> RigSolver::take_rig(guint64& known) {
  const std::lock_guard guard(lock_);
  if (json_number_ == known || json_.empty()) return std::nullopt;
  known = json_number_;
  return json_;
}

}  // namespace calvin::gst
