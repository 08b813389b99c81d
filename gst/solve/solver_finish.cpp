// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calibsolve at the end of the stream: waits for what its session still asks for, and says what
// came of it.

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

// Without a journal the syncer was never started.
bool CalibSolver::drain() {
  return worker_.drain() && writer_.drain() && (!journal() || syncer_.drain());
}

void CalibSolver::finish() {
  expect_no_frame();
  if (!update_and_wait() || !drain()) return;
  take_points({}, [](Pixel, double) { return std::nullopt; });
  LastWork last;
  {
    const std::lock_guard guard(lock_);
    last = session_.end_of_stream();
    obey();
  }
  if (last == LastWork::kWrite) GST_DEBUG_OBJECT(element_, "the files are tried again");
  // A START outside PLAYING would make applications wait for it during preroll.
  const bool announce = last == LastWork::kSolve && GST_STATE(element_) == GST_STATE_PLAYING;
  if (announce) post_solve_progress(GST_PROGRESS_TYPE_START, "Solving the camera");
  if (last != LastWork::kNone && !drain()) {
    if (announce) post_solve_progress(GST_PROGRESS_TYPE_CANCELED, "The solve was cancelled");
    return;
  }
  Verdict verdict;
  {
    const std::lock_guard guard(lock_);
    verdict = session_.verdict();
  }
  post_notices();
  const auto& [status, files_wanted] = verdict;
  if (announce && status) post_solve_progress(GST_PROGRESS_TYPE_COMPLETE, "The camera is solved");
  if (announce && !status) post_solve_progress(GST_PROGRESS_TYPE_ERROR, status.error().message);
  if (!status && files_wanted) post_error(element_, status.error());
  if (!status && !files_wanted) post_warning(element_, status.error());
}

}  // namespace calvin::gst
