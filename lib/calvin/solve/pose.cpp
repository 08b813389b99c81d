// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Checks an observation, fits its pose and measures both tilts that a plane leaves open.

#include "calvin/solve/pose.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "calvin/core/text.hpp"
#include "calvin/solve/fit/weights.hpp"
#include "calvin/solve/residuals/board_shape.hpp"
#include "calvin/solve/start/pose_fit.hpp"
#include "calvin/solve/view.hpp"

namespace calvin {

namespace {

// The root mean square distance of the corners in use, not weighted, px.
double rms_of(const PointSet& view, const Camera& camera, const SE3& camera_from_board) {
  double sum = 0;
  double count = 0;
  for (std::size_t i = 0; i < view.size(); ++i) {
    if (!(view.weight[i] > 0)) continue;
    const auto at = camera.project(camera_from_board * view.points[i]);
    if (!at) continue;
    const double du = at->u - view.uv[i].u;
    const double dv = at->v - view.uv[i].v;
    sum += du * du + dv * dv;
    count += 1;
  }
  return count > 0 ? std::sqrt(sum / count) : 0;
}

}  // namespace

Result<SE3> solve_pose(const Camera& camera, const Board& board, const Observation& observation,
                       PoseQuality* quality, const BoardWarp& warp) {
  const ImageSize size = camera.image_size();
  if (const Status status = check_before_camera({observation, board}, size); !status) {
    return tl::unexpected<Error>(status.error());
  }
  std::vector<PointSet> view = {to_points(board, bent_points(board, warp), observation)};
  (void)normalise_weights(view);
  const auto rays = rays_of(view[0], camera);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (rays[i].isZero()) view[0].weight[i] = 0;
  }
  std::optional<PoseFit> fit;
  if (spans_plane(view[0])) fit = fit_pose(view[0], camera, Loss{});
  if (!fit) {
    return make_error(
        ErrorCode::kDegenerate,
        "The corners do not determine the pose of the board: at least 4 that the camera "
        "can see and that do not lie on one line are needed.");
  }
  if (quality != nullptr) {
    const double rms = rms_of(view[0], camera, fit->camera_from_board);
    *quality = {rms, std::max(rms, rms_of(view[0], camera, fit->other))};
  }
  return fit->camera_from_board;
}

bool holds_camera(const SolveOptions& options) {
  return std::ranges::any_of(options.fix,
                             [](const std::string& word) { return trim(word) == "all"; });
}

Status check_held_camera(const SolveOptions& options) {
  if (!options.initial) {
    return make_error(ErrorCode::kInvalidArgument,
                      "'all' cannot be fixed at nothing: give the calibration that is to be held "
                      "(initial).");
  }
  if (!options.method.empty()) {
    return make_error(ErrorCode::kInvalidArgument,
                      fmt::format("With 'all' fixed there is no camera for the method {} to find: "
                                  "leave one of them out.",
                                  options.method));
  }
  return {};
}

namespace {

// What is known of the camera, without what was known of the views that it was made of.
Calibration without_views(Calibration calibration) {
  calibration.views.clear();
  calibration.rms.reset();
  calibration.held_out_rms.reset();
  calibration.chi.reset();
  calibration.split_half_ratio.reset();
  calibration.warp.reset();
  calibration.created.clear();
  calibration.misfit.clear();
  calibration.remarks.clear();
  return calibration;
}

// px^2 over both coordinates of all corners, as the detector has it; absent where it does not.
std::optional<double> noise_of(const Observation& seen) {
  double squares = 0;
  for (std::size_t i = 0; i < seen.ids.size(); ++i) {
    if (i >= seen.sigma.size() || !is_known_sigma(seen.sigma[i])) return std::nullopt;
    squares += 2 * seen.sigma[i] * seen.sigma[i];
  }
  return squares;
}

}  // namespace

Result<Solution> solve_poses(std::span<const View> views, ImageSize size,
                             const SolveOptions& options) {
  if (Status held = check_held_camera(options); !held) return tl::unexpected<Error>(held.error());
  const auto camera = Camera::make(*options.initial);
  if (!camera) return tl::unexpected<Error>(camera.error());
  Solution solution;
  solution.calibration = without_views(*options.initial);
  double squares = 0;
  std::optional<double> noise = 0;
  int points = 0;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const Observation& seen = views[i].observation;
    const bool is_off = is_off_size(seen, size);
    if (!seen.found() || is_off) {
      solution.rejected.push_back({i, is_off ? Reason::kOffSize : Reason::kNotFound});
      continue;
    }
    if (Status has = check_has_pose(views[i].board); !has) {
      return tl::unexpected<Error>(has.error());
    }
    PoseQuality quality;
    const auto pose = solve_pose(*camera, views[i].board, seen, &quality);
    if (!pose && pose.error().code != ErrorCode::kDegenerate) {
      return tl::unexpected<Error>(pose.error());
    }
    if (!pose) {
      solution.rejected.push_back({i, Reason::kTooFewPoints});
      continue;
    }
    const auto count = static_cast<int>(seen.ids.size());
    solution.calibration.views.push_back(
        {seen.timestamp, quality.rms, count, false, to_pose(*pose)});
    squares += count * quality.rms * quality.rms;
    const auto noise_here = noise_of(seen);
    noise = noise && noise_here ? std::optional(*noise + *noise_here) : std::nullopt;
    points += count;
  }
  if (points == 0) {
    return make_error(ErrorCode::kDegenerate,
                      "No view tells where its board is: each needs at least 4 points that do not "
                      "lie on one line.");
  }
  solution.calibration.rms = std::sqrt(squares / points);
  if (noise && *noise > 0) solution.calibration.chi = std::sqrt(squares / *noise);
  return solution;
}

}  // namespace calvin
