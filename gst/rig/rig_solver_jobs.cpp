// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What calibrig does beside the streams: solves, publishes what comes of it, and watches whether
// the cameras stay where they are.

#include <utility>

#include <fmt/format.h>

#include "calvin/io/rig_io.hpp"
#include "calvin/rig/moved_camera.hpp"
#include "calvin/session/rig/light_rig.hpp"
#include "calvin/session/rig/rig_exports.hpp"
#include "rig/rig_messages.hpp"
#include "rig/rig_solver.hpp"

GST_DEBUG_CATEGORY_EXTERN(calibrig_debug);
#define GST_CAT_DEFAULT calibrig_debug

namespace calvin::gst {

namespace {

// Rejected views are by the cameras of the rig, which are some of those that have views.
void log_rejected(GstElement* element, const RigSolution& solution,
                  const std::vector<RigCameraViews>& views) {
  const std::vector<RigCameraViews> own = views_of_rig(solution.rig, views);
  for (const RigView& of : solution.rejected) {
    GST_DEBUG_OBJECT(element, "what '%s' saw at %" GST_TIME_FORMAT " contradicts the others",
                     own[of.camera].calibration.camera.c_str(),
                     GST_TIME_ARGS(own[of.camera].views[of.view].observation.timestamp));
  }
}

}  // namespace

Result<RigSolution> RigSolver::solve(const RigJob& job, const std::vector<RigCameraViews>& views,
                                     const std::stop_token& stop) {
  // That it is a light may be known only now.
  const Status possible = job.light ? check_light(job.options, *job.light) : Status();
  if (!possible) return tl::unexpected(possible.error());
  auto solution = job.light ? solve_light_rig(job, stop) : solve_rig(views, job.options, stop);
  if (!solution) return solution;
  if (!job.light) log_rejected(element_, *solution, views);
  solution->left_out.insert(solution->left_out.end(), job.left_out.begin(), job.left_out.end());
  solution->remarks.insert(solution->remarks.end(), job.remarks.begin(), job.remarks.end());
  // A camera of which that was said has no views since then among these.
  if (!job.final || job.light) return solution;
  std::string moved = moved_cameras(views_of_rig(solution->rig, views), job.options, stop);
  if (!moved.empty()) solution->remarks.push_back(std::move(moved));
  return solution;
}

void RigSolver::run(const RigJob& job, const std::stop_token& stop) {
  const std::vector<RigCameraViews> views =
      job.light ? std::vector<RigCameraViews>() : views_of(job);
  auto solution = solve(job, views, stop);
  std::shared_ptr<const WatchedRig> watched;
  if (solution && !job.light && !stop.stop_requested()) {
    watched = std::make_shared<const WatchedRig>(
        watched_rig(in_board_lengths(*solution), views, job.options));
  }
  if (stop.stop_requested()) return;
  {
    const std::lock_guard guard(lock_);
    if (!session_.is_current(job)) return;
    if (solution) session_.solved(job, watched);
    solve_error_.reset();
    if (!solution) solve_error_ = solution.error();
  }
  if (!solution) {
    GST_INFO_OBJECT(element_, "no rig: %s", solution.error().message.c_str());
    return;
  }
  publish(job, std::make_shared<const RigSolution>(*std::move(solution)), stop);
}

// All that can be; the first error.
Status RigSolver::write_files(const Rig& rig) {
  const RigSettings now = in_use();
  Status all = now.location.empty() ? Status() : file_.write(now.location, rig);
  const auto exports = parse_rig_exports(now.exports);
  for (const RigExport& to : exports.value_or(std::vector<RigExport>())) {
    Status written = write_rig_export(to, rig);
    if (all && !written) all = std::move(written);
  }
  return all;
}

void RigSolver::publish(const RigJob& job, std::shared_ptr<const RigSolution> solution,
                        const std::stop_token& stop) {
  const auto json = print_rig(solution->rig);
  if (!json) return;
  const std::string location = in_use().location;
  const Status written = write_files(solution->rig);
  FrameTimes times;
  bool first_failure = false;
  {
    const std::lock_guard guard(lock_);
    json_ = *json;
    ++json_number_;
    solution_ = solution;
    is_final_ = job.final;
    times = times_;
    write_error_.reset();
    if (!written) {
      write_error_ = written.error();
      first_failure = !std::exchange(write_failed_, true);
    }
  }
  GST_INFO_OBJECT(element_, "%s rig of %" G_GSIZE_FORMAT " cameras, rms %.3f px",
                  job.final ? "final" : "intermediate", solution->rig.cameras.size(),
                  solution->rig.rms.value_or(0));
  const auto report = [&](const auto& post) {
    if (const auto allowed = worker_.begin_report(stop, element_)) post();
  };
  if (first_failure && !job.final) report([&] { post_warning(element_, written.error()); });
  for (const LeftOutCamera& camera : solution->left_out) {
    if (!job.final) break;
    report([&] {
      post_warning(element_,
                   {ErrorCode::kDegenerate, fmt::format("The camera '{}' is not in the rig. {}",
                                                        camera.camera, camera.reason)});
    });
  }
  report([&] {
    post_message(element_, rig_result_message(times, *solution, location,
                                              job.final ? json->c_str() : nullptr));
  });
}

void RigSolver::watch(const WatchJob& job, const std::stop_token& stop) {
  if (std::exchange(watched_generation_, job.generation) != job.generation) watch_.start();
  const auto all = watch_.look(*job.rig, job.left_out, views_of(job), job.tolerance);
  for (const MovedCamera& moved : all) {
    // A job that may say nothing any more changes nothing either: it would never be known.
    if (const auto report = watcher_.begin_report(stop, element_)) {
      FrameTimes times;
      {
        const std::lock_guard guard(lock_);
        if (!session_.moved(job, moved)) continue;
        times = times_;
      }
      post_message(element_, rig_moved_message(times, moved));
    } else {
      return;
    }
    if (const auto report = watcher_.begin_report(stop, element_)) {
      post_warning(element_,
                   {ErrorCode::kDegenerate,
                    fmt::format("{} What it sees is left out from now on, until it is inserted "
                                "again (reinsert).",
                                to_text(moved))});
    }
  }
}

}  // namespace calvin::gst
