// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Solves what a session asks for.

#include "calvin/session/session_jobs.hpp"

#include <utility>

#include "calvin/session/refine_with_camera.hpp"

namespace calvin {

Result<Solution> solve_job(const SolveJob& job, const std::stop_token& stop) {
  std::vector<View> views;
  views.reserve(job.views.size());
  for (const auto& view : job.views) views.push_back(*view);
  auto solution = solve_in_runs(views, job.size, job.options, job.runs, stop);
  if (solution && job.lens) {
    solution->calibration.device = job.lens->device;
    solution->calibration.focus = job.lens->focus;
    solution->calibration.zoom = job.lens->zoom;
  }
  return solution;
}

std::shared_ptr<ViewGuide> guide_job(const SolveJob& job, const Solution& solution) {
  if (!job.next_board) return nullptr;
  const auto camera = Camera::make(solution.calibration);
  if (!camera) return nullptr;
  auto guide = ViewGuide::make(*camera, job.options, job.views, *job.next_board, job.missed);
  return guide ? std::make_shared<ViewGuide>(*std::move(guide)) : nullptr;
}

}  // namespace calvin
