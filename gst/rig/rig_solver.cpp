// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Reads intrinsics, asks the session of calibrig what to solve, and publishes what comes of it.

#include "rig/rig_solver.hpp"

#include <utility>

#include <fmt/format.h>

#include "calvin/io/calibration_io.hpp"
#include "calvin/io/rig_io.hpp"
#include "calvin/io/settings.hpp"
#include "calvin/rig/moved_camera.hpp"
#include "rig/rig_messages.hpp"

GST_DEBUG_CATEGORY_EXTERN(calibrig_debug);
#define GST_CAT_DEFAULT calibrig_debug

namespace calvin::gst {

namespace {

constexpr GEnumValue kModes[] = {
    choice(kRigFloor, "floor",
           "One board lies still, and each camera has seen it: its frame is that of the rig"),
    choice(kRigJoint, "joint",
           "A board is carried before two cameras or more at a time: the frame is that of the "
           "first"),
    choice(kRigStereo, "stereo", "As joint, of two cameras"), kNoMoreChoices};

}  // namespace

const Property<RigSolver> kRigProperties[4] = {
    {"board",
     "Board",
     "The board that counts, as the observations have its text; none: every board",
     kept_in<&RigSettings::board>,
     {.flags = kMutableReady}},
    {"mode",
     "Mode",
     "How the places of the cameras are found",
     kept_in<&RigSettings::mode>,
     {.choices = {"GstCalibRigMode", kModes}, .flags = kMutableReady}},
    {"location",
     "Location",
     "The file of the rig; written at the first solve, then at every one. What was there before is "
     "kept as FILE~",
     kept_in<&RigSettings::location>,
     {.flags = kMutableReady}},
    {"tolerance",
     "Tolerance",
     "How far pictures of one instant may be apart (ns)",
     kept_in<&RigSettings::tolerance>,
     {.range = Range{0, 1e10}, .flags = kMutableReady}},
};

Status RigSolver::start() {
  const RigSettings now = settings();
  if (!now.location.empty()) {
    if (const Status writable = can_write(now.location); !writable) {
      post_warning(element_, writable.error());
    }
  }
  {
    const std::lock_guard guard(lock_);
    RigSessionSettings session;
    session.board = now.board;
    session.options.mode = now.mode == kRigFloor ? RigMode::kFloor : RigMode::kJoint;
    session.options.tolerance = now.tolerance;
    session_.start(std::move(session));
    json_.clear();
    error_.reset();
    complained_ = write_failed_ = false;
    unread_.clear();
  }
  if (Status started = reader_.start(); !started) return started;
  if (Status started = worker_.start(); !started) return started;
  file_ = {};  // no job of the run before is left
  return {};
}

Status RigSolver::add_camera(std::size_t camera, const RigCameraSettings& settings) {
  std::optional<Calibration> intrinsics;
  if (!settings.intrinsics.empty()) {
    auto read = parse_calibration_setting(settings.intrinsics);
    if (!read) {
      return make_error(read.error().code, fmt::format("The intrinsics of the camera '{}': {}",
                                                       settings.name, read.error().message));
    }
    intrinsics = *std::move(read);
  }
  const std::lock_guard guard(lock_);
  session_.set_name(camera, settings.name);
  if (intrinsics) session_.set_intrinsics(camera, *intrinsics);
  return {};
}

void RigSolver::add_camera_later(std::size_t camera, const RigCameraSettings& settings) {
  {
    const std::lock_guard guard(lock_);
    session_.set_name(camera, settings.name);
    if (settings.intrinsics.empty()) return;
    unread_.emplace_back(camera, settings);
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
  std::optional<Error> complaint;
  std::optional<RigProgress> progress;
  {
    const std::lock_guard guard(lock_);
    times_ = times;
    const auto kept = session_.offer(camera, std::move(observation));
    if (!kept && !std::exchange(complained_, true)) complaint = kept.error();
    if (kept && *kept) progress = session_.progress();
  }
  if (complaint) post_warning(element_, *complaint);
  if (!progress) return;
  post_message(element_, rig_progress_message(times, *progress));
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

void RigSolver::finish() {
  if (!reader_.drain() || !worker_.drain()) return;
  solve_if_due(true);
  if (!worker_.drain()) return;
  std::optional<Error> error;
  bool files_wanted = false;
  {
    const std::lock_guard guard(lock_);
    files_wanted = !settings_.location.empty();
    error = error_;
    if (!error && json_.empty()) error = session_.lack();
  }
  if (!error) return;
  if (files_wanted) {
    post_error(element_, *error);
  } else {
    post_warning(element_, *error);
  }
}

std::optional<std::string> RigSolver::take_rig(guint64& known) {
  const std::lock_guard guard(lock_);
  if (json_number_ == known || json_.empty()) return std::nullopt;
  known = json_number_;
  return json_;
}

// ---- On the worker ------------------------------------------------------------------------------

void RigSolver::run(const RigJob& job, const std::stop_token& stop) {
  const bool is_pair = settings().mode != kRigStereo || job.cameras.size() == 2;
  auto solution = is_pair ? solve_rig(job.cameras, job.options, stop)
                          : Result<RigSolution>(make_error(
                                ErrorCode::kInvalidArgument,
                                fmt::format("A stereo rig has two cameras, and {} are linked: take "
                                            "mode=joint.",
                                            job.cameras.size())));
  if (solution && job.final) {
    std::string moved = moved_cameras(job.cameras, job.options, stop);
    if (!moved.empty()) solution->remarks.push_back(std::move(moved));
  }
  if (stop.stop_requested()) return;
  {
    const std::lock_guard guard(lock_);
    if (!session_.is_current(job)) return;
    session_.solved(job, solution.has_value());
    error_.reset();
    if (!solution) error_ = solution.error();
  }
  if (!solution) {
    GST_INFO_OBJECT(element_, "no rig: %s", solution.error().message.c_str());
    return;
  }
  publish(job, *solution, stop);
}

void RigSolver::publish(const RigJob& job, const RigSolution& solution,
                        const std::stop_token& stop) {
  const auto json = print_rig(solution.rig);
  if (!json) return;
  const std::string location = settings().location;
  const Status written = location.empty() ? Status() : file_.write(location, solution.rig);
  FrameTimes times;
  bool first_failure = false;
  {
    const std::lock_guard guard(lock_);
    json_ = *json;
    ++json_number_;
    times = times_;
    if (!written) {
      error_ = written.error();
      first_failure = !std::exchange(write_failed_, true);
    }
  }
  GST_INFO_OBJECT(element_, "%s rig of %" G_GSIZE_FORMAT " cameras, rms %.3f px",
                  job.final ? "final" : "intermediate", solution.rig.cameras.size(),
                  solution.rig.rms.value_or(0));
  if (first_failure && !job.final) {
    if (const auto report = worker_.begin_report(stop, element_)) {
      post_warning(element_, written.error());
    }
  }
  if (const auto report = worker_.begin_report(stop, element_)) {
    post_message(element_, rig_result_message(times, solution, location,
                                              job.final ? json->c_str() : nullptr));
  }
}

}  // namespace calvin::gst
