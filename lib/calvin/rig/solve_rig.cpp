// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The steps of a solve: views, links, tree, least squares, and what is said of the result.

#include "calvin/rig/solve_rig.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <iterator>
#include <numbers>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Core>

#include "calvin/core/text.hpp"
#include "calvin/rig/board_views.hpp"
#include "calvin/rig/clocks/solve_with_clocks.hpp"
#include "calvin/rig/clocks/timing.hpp"
#include "calvin/rig/fixed/solve_with_boards.hpp"
#include "calvin/rig/floor.hpp"
#include "calvin/rig/joint/board_scale.hpp"
#include "calvin/rig/lenses/lens_check.hpp"
#include "calvin/rig/lenses/solve_with_lenses.hpp"
#include "calvin/rig/pose_unknowns.hpp"
#include "calvin/rig/result/fixed_board_result.hpp"
#include "calvin/rig/result/rig_frame.hpp"
#include "calvin/rig/result/rig_links.hpp"
#include "calvin/rig/result/rig_result.hpp"
#include "calvin/rig/result/shown_boards.hpp"
#include "calvin/rig/start/given_views.hpp"
#include "calvin/rig/start/links.hpp"
#include "calvin/rig/start/rig_start.hpp"

namespace calvin {

namespace {

using rig::BoardView;
using rig::Link;

using rig::kPose;

Status check_count(std::size_t cameras, RigMode mode) {
  const std::size_t least = mode == RigMode::kFloor ? 1 : 2;
  if (cameras >= least) return {};
  return make_error(ErrorCode::kInvalidArgument,
                    mode == RigMode::kFloor
                        ? "A camera before a floor board has to be named."
                        : "A rig has two cameras or more: name them. Where one stands is found "
                          "by a board on the floor.");
}

std::vector<std::string> names_of(const std::vector<RigCameraViews>& seen) {
  std::vector<std::string> names;
  for (const RigCameraViews& one : seen) names.push_back(one.calibration.camera);
  return names;
}

Status check_options(const RigOptions& options, const std::vector<std::string>& names) {
  if (!(options.board_sigma >= 0 && options.board_sigma <= 1)) {
    return make_error(ErrorCode::kInvalidArgument,
                      fmt::format("The size of boards is not known to {} of it: give 0, where it "
                                  "is known exactly, to 1 (board_sigma).",
                                  options.board_sigma));
  }
  return options.world ? rig::check_world(*options.world, names) : Status();
}

std::vector<Calibration> calibrations_of(const std::vector<RigCameraViews>& seen) {
  std::vector<Calibration> all;
  for (const RigCameraViews& one : seen) all.push_back(one.calibration);
  return all;
}

// A length on a board that people measure: of the first board that was seen, m.
double cell_of(const std::vector<RigCameraViews>& seen) {
  for (const RigCameraViews& camera : seen) {
    for (const View& view : camera.views) {
      if (view.board.point_count() > 0) return view.board.cell_size(0);
    }
  }
  return 0;
}

// Moves the cameras to where known distances have them, if there are any.
Status set_scale(const std::vector<RigCameraViews>& seen, const RigOptions& options,
                 rig::PlacedCameras& frames, RigSolution& solution) {
  if (options.baselines.empty()) return {};
  const std::vector<std::string> names = names_of(seen);
  const auto distances = rig::known_distances(options.baselines, names);
  if (!distances) return tl::unexpected<Error>(distances.error());
  const auto scaled = rig::scale_by(frames, *distances, options.board_sigma);
  if (!scaled) {
    return make_error(ErrorCode::kInvalidArgument,
                      "The known distances between cameras contradict each other: give them "
                      "sigmas, or leave some out.");
  }
  frames = scaled->cameras;
  solution.board_scale = BoardScale{scaled->scale, scaled->sigma};
  const auto remarks = rig::scale_remarks(*scaled, *distances, names, cell_of(seen));
  solution.remarks.insert(solution.remarks.end(), remarks.begin(), remarks.end());
  return {};
}

// The frame that is asked for, of a rig whose cameras stand as `frames` has them.
void set_frame(const RigOptions& options, rig::PlacedCameras frames, RigSolution& solution) {
  if (!options.world) return;
  solution.as_solved = solution.rig;
  Rig& rig = solution.rig;
  std::vector<std::string> names;
  for (const RigCamera& camera : rig.cameras) names.push_back(camera.calibration.camera);
  rig::move_boards(rig::set_world(*options.world, names, frames), rig.boards);
  rig::set_places(frames, rig.cameras);
  rig.world = options.world->camera.empty() ? kBoardWorld : options.world->camera;
}

std::vector<SE3> inverses(const std::vector<SE3>& poses) {
  std::vector<SE3> all;
  for (const SE3& pose : poses) all.push_back(pose.inverse());
  return all;
}

// ---- Jointly ------------------------------------------------------------------------------------

Result<RigSolution> solve_jointly(const std::vector<RigCameraViews>& seen,
                                  const std::vector<Camera>& cameras, const RigOptions& options,
                                  const std::stop_token& stop);

rig::JoinedCameras joined_by(std::vector<BoardView> views, const std::vector<RigCameraViews>& seen,
                             const std::vector<Camera>& cameras, const RigOptions& options) {
  const std::vector<ViewTimes> times = rig::view_times(seen, {});
  if (options.fixed_boards) {
    views = rig::views_of_bodies(rig::boards_on_bodies(views, seen, cameras), views);
  }
  auto groups = rig::group_views(pair_instants(times, options.tolerance), views);
  rig::allow_for_timing(times, views, groups);
  return rig::joined_cameras(rig::find_links(views, groups, cameras), names_of(seen));
}

// The cameras that are joined by themselves.
Result<RigSolution> solve_joined(const std::vector<RigCameraViews>& seen,
                                 const std::vector<Camera>& cameras,
                                 const rig::JoinedCameras& joined, RigOptions options,
                                 const std::stop_token& stop) {
  std::vector<RigCameraViews> left;
  std::vector<Camera> their_cameras;
  std::vector<LeftOutCamera> left_out;
  for (std::size_t c = 0; c < seen.size(); ++c) {
    if (joined.is_joined[c]) {
      left.push_back(seen[c]);
      their_cameras.push_back(cameras[c]);
    } else {
      const auto apart = rig::why_apart(seen, c, options.fixed_boards, options.tolerance);
      left_out.push_back({seen[c].calibration.camera, apart ? apart->message : joined.why_not[c]});
    }
  }
  options.is_partial = false;
  auto dropped = rig::drop_unknown(options.baselines, names_of(left));
  if (options.world && !rig::check_world(*options.world, names_of(left))) {
    dropped.push_back(rig::drop_world(options.world));
  }
  auto solution = solve_jointly(left, their_cameras, options, stop);
  if (!solution) return solution;
  solution->left_out = std::move(left_out);
  solution->remarks.insert(solution->remarks.end(), dropped.begin(), dropped.end());
  return solution;
}

void set_offsets(const rig::JointSolve& one, RigSolution& solution) {
  if (one.offsets.empty() || !one.fit.time_offsets) return;
  constexpr double kMillisecond = 1e-3;  // s
  const std::string& first = solution.rig.cameras.front().calibration.camera;
  for (std::size_t c = 1; c < one.offsets.size(); ++c) {
    RigCamera& camera = solution.rig.cameras[c];
    const double offset = one.offsets[c];
    const double sigma = one.fit.time_offsets->sigma[c];
    if (!(sigma > 0)) continue;
    camera.time_offset = TimeOffset{offset, sigma};
    solution.remarks.push_back(fmt::format(
        "The pictures of '{}' were taken {:.2f} ms (+-{}) {} than their timestamps say, against "
        "those of '{}', which is allowed for.",
        camera.calibration.camera, std::abs(offset) / kMillisecond,
        two_digits(sigma / kMillisecond), offset > 0 ? "later" : "earlier", first));
  }
}

InstantsOf instants_of(const RigOptions& options) {
  if (options.intrinsics == RigIntrinsics::kFree) return InstantsOf::kAny;
  return options.fixed_boards ? InstantsOf::kTwoViews : InstantsOf::kTwoCameras;
}

Result<rig::LensSolve> solve_all(rig::JointProblem problem, const RigOptions& options,
                                 const std::stop_token& stop) {
  if (options.intrinsics != RigIntrinsics::kHeld) {
    const bool has_prior = options.intrinsics == RigIntrinsics::kPrior;
    return rig::solve_with_lenses(problem, has_prior, options.fixed_boards, stop);
  }
  rig::LensSolve all = {{}, problem.cameras, calibrations_of(problem.seen), {}};
  auto solved = rig::solve_places(std::move(problem), options.fixed_boards, stop);
  if (!solved) return tl::unexpected<Error>(solved.error());
  all.boards = *std::move(solved);
  return all;
}

Result<RigSolution> solve_jointly(const std::vector<RigCameraViews>& seen,
                                  const std::vector<Camera>& cameras, const RigOptions& options,
                                  const std::stop_token& stop) {
  const InstantsOf of = instants_of(options);
  auto views = rig::paired_board_views(seen, cameras, options.tolerance, of);
  if (!views) return tl::unexpected<Error>(views.error());
  if (options.is_partial) {
    const auto joined = joined_by(*views, seen, cameras, options);
    const auto count = std::ranges::count(joined.is_joined, true);
    const bool is_part = count >= 2 && static_cast<std::size_t>(count) < seen.size();
    if (is_part) return solve_joined(seen, cameras, joined, options, stop);
  }
  for (std::size_t c = 0; c < seen.size(); ++c) {
    if (const auto apart = rig::why_apart(seen, c, options.fixed_boards, options.tolerance)) {
      return tl::unexpected<Error>(*apart);
    }
  }
  const RigWorld* world = options.world ? &*options.world : nullptr;
  auto solved = solve_all(
      {seen, cameras, *std::move(views), names_of(seen), options.tolerance, of, {nullptr, world}},
      options, stop);
  if (!solved) return tl::unexpected<Error>(solved.error());
  const rig::JointSolve& one = solved->boards.joint;
  rig::RigFit& fit = solved->boards.joint.fit;
  RigSolution solution;
  if (options.intrinsics != RigIntrinsics::kFree)
    solution.remarks = rig::lens_remarks(seen, cameras);
  std::ranges::move(solved->remarks, std::back_inserter(solution.remarks));
  solution.farthest = one.farthest;
  solution.rig.world = seen.front().calibration.camera;
  solution.rig.rms = fit.rms;
  solution.rig.pairing_tolerance = options.tolerance;
  rig::PlacedCameras frames = rig::frames_of(fit);
  const Status scaled = set_scale(seen, options, frames, solution);
  if (!scaled) return tl::unexpected<Error>(scaled.error());
  solution.links =
      rig::links_of(one, solved->cameras, inverses(frames.rig_from_camera), frames.covariance);
  const double scale = solution.board_scale ? solution.board_scale->scale : 1;
  solution.rig.boards = rig::shown_boards(seen, one.views, fit.places, scale);
  rig::set_cameras(solved->calibrations, frames, fit.camera_rms, solution.rig);
  auto contradiction = rig::contradiction_remark(solution.rig);
  // Nor does what does not fit together tell of clocks.
  if (!contradiction) set_offsets(one, solution);
  if (contradiction) solution.remarks.push_back(*std::move(contradiction));
  set_frame(options, std::move(frames), solution);
  rig::set_fixed_boards(seen, solved->boards, scale, solution.rig, solution.remarks);
  for (const std::size_t view : fit.rejected) solution.rejected.push_back(one.views[view].of);
  solution.weakest = rig::weakest_of(solution.links);
  return solution;
}

// ---- By the floor -------------------------------------------------------------------------------

// The board that all cameras have seen: the first one of the first camera of which that is so.
std::optional<std::size_t> floor_of(const std::vector<BoardView>& views, std::size_t cameras) {
  for (const BoardView& candidate : views) {
    std::set<std::size_t> of;
    for (const BoardView& view : views) {
      if (view.board == candidate.board) of.insert(view.of.camera);
    }
    if (of.size() == cameras) return candidate.board;
  }
  return std::nullopt;
}

tl::unexpected<Error> no_floor() {
  return make_error(ErrorCode::kDegenerate,
                    "No board was seen by all cameras: lay one where each of them sees it, or "
                    "solve jointly, with a board that is carried from one to the next.");
}

tl::unexpected<Error> turned_floor() {
  return make_error(ErrorCode::kDegenerate,
                    "The board on the floor looks the same when it is turned, so that cameras "
                    "around it cannot agree: take one with an odd and an even number of corners, "
                    "or one that names them, as puzzle:14x9:20mm.");
}

Result<RigSolution> solve_by_floor(const std::vector<RigCameraViews>& seen,
                                   const std::vector<Camera>& cameras, const RigOptions& options) {
  if (options.intrinsics != RigIntrinsics::kHeld) {
    return make_error(ErrorCode::kInvalidArgument,
                      "A board on the floor tells where cameras stand and not their intrinsics: "
                      "let these stay as they are, or carry the board before two cameras at a "
                      "time.");
  }
  auto views = rig::board_views(seen, cameras);
  if (!views) return tl::unexpected<Error>(views.error());
  const auto floor = floor_of(*views, cameras.size());
  if (!floor) return no_floor();
  std::erase_if(*views, [&](const BoardView& view) { return view.board != *floor; });
  if (std::ranges::any_of(*views, [](const BoardView& v) { return v.labellings.size() > 1; })) {
    return turned_floor();
  }
  RigSolution solution;
  std::vector<double> rms;
  const auto count = kPose * static_cast<Eigen::Index>(cameras.size());
  rig::PlacedCameras frames = {{}, Eigen::MatrixXd::Zero(count, count)};
  double squares = 0;
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    std::vector<BoardView> own;
    std::ranges::copy_if(*views, std::back_inserter(own),
                         [&](const BoardView& view) { return view.of.camera == c; });
    const auto pose = rig::floor_pose(own, seen[c].calibration, cameras[c]);
    if (!pose) return tl::unexpected<Error>(pose.error());
    frames.rig_from_camera.push_back(pose->camera_from_board.inverse());
    rms.push_back(pose->rms);
    squares += pose->rms * pose->rms;
    const auto at = kPose * static_cast<Eigen::Index>(c);
    frames.covariance.block(at, at, kPose, kPose) = pose->covariance;
    for (std::string& remark : rig::floor_remarks(*pose, seen[c].calibration.camera)) {
      solution.remarks.push_back(std::move(remark));
    }
  }
  const Status scaled = set_scale(seen, options, frames, solution);
  if (!scaled) return tl::unexpected<Error>(scaled.error());
  solution.rig.world = kBoardWorld;
  solution.rig.rms = std::sqrt(squares / static_cast<double>(cameras.size()));
  const RigView& first = views->front().of;
  solution.rig.boards = {{seen[first.camera].views[first.view].board.text(), {}}};
  const std::vector<SE3> camera_from_rig = inverses(frames.rig_from_camera);
  for (std::size_t a = 0; a < cameras.size(); ++a) {
    for (std::size_t b = a + 1; b < cameras.size(); ++b) {
      solution.links.push_back(rig::link_between(a, b, camera_from_rig, frames.covariance));
    }
  }
  rig::set_cameras(calibrations_of(seen), frames, rms, solution.rig);
  rig::add_own_frame(frames);
  set_frame(options, std::move(frames), solution);
  return solution;
}

}  // namespace

Result<RigSolution> solve_rig(const std::vector<RigCameraViews>& cameras, const RigOptions& options,
                              std::stop_token stop) {
  if (const Status good = check_count(cameras.size(), options.mode); !good) {
    return tl::unexpected<Error>(good.error());
  }
  const auto known = rig::checked_cameras(cameras);
  if (!known) return tl::unexpected<Error>(known.error());
  if (const Status good = check_options(options, names_of(cameras)); !good) {
    return tl::unexpected<Error>(good.error());
  }
  try {
    return options.mode == RigMode::kFloor ? solve_by_floor(cameras, *known, options)
                                           : solve_jointly(cameras, *known, options, stop);
  } catch (const std::exception&) {
    return make_error(ErrorCode::kDegenerate, "There is no memory for so many views: take fewer.");
  }
}

Rig in_board_lengths(const RigSolution& solution) {
  Rig rig = solution.as_solved.value_or(solution.rig);
  const double scale = solution.board_scale ? solution.board_scale->scale : 1;
  for (RigCamera& camera : rig.cameras) {
    for (double& x : camera.rig_from_camera.translation) x /= scale;
    for (std::size_t i = 0; i < camera.covariance.size(); ++i) {
      const std::size_t size = 6;
      camera.covariance[i] /= (i / size >= 3 ? scale : 1) * (i % size >= 3 ? scale : 1);
    }
  }
  return rig;
}

std::string to_text(const RigLink& link, const Rig& rig) {
  constexpr double kMillimetre = 1e-3;  // m
  constexpr double kDegree = std::numbers::pi / 180;
  std::string text =
      fmt::format("'{}' and '{}': {:.1f} mm apart (+-{}), axes at {:.1f} degrees",
                  rig.cameras[link.a].calibration.camera, rig.cameras[link.b].calibration.camera,
                  link.distance / kMillimetre, two_digits(link.distance_sigma / kMillimetre),
                  link.angle / kDegree);
  if (link.views > 0) text += fmt::format(", {} of {} common views agree", link.agree, link.views);
  if (link.bias && link.spread) {
    text += fmt::format(", distances on the board within {} mm, {:+.2f} %",
                        two_digits(*link.spread / kMillimetre), 100 * *link.bias);
  }
  if (link.epipolar_error) {
    text +=
        fmt::format(", corners within {:.2f} px of the rows of each other", *link.epipolar_error);
  }
  return text;
}

}  // namespace calvin
