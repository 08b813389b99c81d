// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The session behind calibsolve at the end of the stream: the last solve, or what is missing.

#include <fmt/format.h>

#include "common/values.hpp"
#include "solve/calib_solver.hpp"

GST_DEBUG_CATEGORY_EXTERN(calibsolve_debug);
#define GST_CAT_DEFAULT calibsolve_debug

namespace calvin::gst {

void CalibSolver::post_solve_progress(GstProgressType type, const std::string& text) {
  gst_element_post_message(
      element_,
      gst_message_new_progress(GST_OBJECT(element_), type, "calibrate", displayed(text).c_str()));
}

Error CalibSolver::too_few_views() const {
  const std::size_t views = session_.views().size();
  return {
      ErrorCode::kDegenerate,
      fmt::format("No calibration: {} taken, at least {} are needed. Show the whole board, flat "
                  "and sharp, in different places and tilts, and check that the property "
                  "`board` tells its inner corners.",
                  views == 0   ? "no view of the board was"
                  : views == 1 ? "only one view of the board was"
                               : fmt::format("only {} views of the board were", views),
                  plan_.settings.min_views)};
}

Status CalibSolver::verdict() const {
  if (!solve_error_.empty()) {
    return make_error(ErrorCode::kDegenerate,
                      (calibration_ ? "The final solve failed and the one before it stays: "
                                    : "No calibration: ") +
                          solve_error_);
  }
  if (calibration_) return written_;
  return tl::unexpected<Error>(too_few_views());
}

void CalibSolver::finish() {
  if (!update_and_wait() || !drain()) return;
  bool solving = false;
  bool writing = false;  // what a disk that was full may have room for now
  {
    const std::lock_guard guard(lock_);
    solving = final_revision_ != revision_ && enough_views();
    if (solving) request(true);
    writing = !solving && unwritten_;
    if (writing) {
      GST_DEBUG_OBJECT(element_, "the files are tried again");
      request_write(plan_.files, true);
    }
  }
  // A START outside PLAYING would make applications wait for it during preroll.
  const bool announce = solving && GST_STATE(element_) == GST_STATE_PLAYING;
  if (announce) post_solve_progress(GST_PROGRESS_TYPE_START, "Solving the camera");
  if (solving && !drain()) {
    if (announce) post_solve_progress(GST_PROGRESS_TYPE_CANCELED, "The solve was cancelled");
    return;
  }
  if (writing && !drain()) return;
  Status status;
  bool wanted = false;
  {
    const std::lock_guard guard(lock_);
    status = verdict();
    wanted = !plan_.files.empty();
  }
  if (announce && status) post_solve_progress(GST_PROGRESS_TYPE_COMPLETE, "The camera is solved");
  if (announce && !status) post_solve_progress(GST_PROGRESS_TYPE_ERROR, status.error().message);
  if (!status && wanted) post_error(element_, status.error());
  if (!status && !wanted) post_warning(element_, status.error());
}

}  // namespace calvin::gst
