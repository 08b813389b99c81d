// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Steps of Gauss-Newton over where boards are on their bodies, a solve for each.

#include "calvin/rig/fixed/solve_with_boards.hpp"

#include <cmath>
#include <cstdint>
#include <set>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "calvin/geometry/dense.hpp"
#include "calvin/rig/pose_unknowns.hpp"
#include "calvin/solve/residuals/bundle_problem.hpp"

namespace calvin::rig {

namespace {

// The largest step, in sigmas.
double largest_step(const BoardOffsets& offsets) {
  return (offsets.step.array().abs() / offsets.covariance.diagonal().array().sqrt()).maxCoeff();
}

void take_step(const BoardOffsets& offsets, std::vector<BoardOnBody>& boards) {
  for (std::size_t k = 0; k < offsets.boards.size(); ++k) {
    SE3& place = boards[offsets.boards[k]].body_from_board;
    const Eigen::VectorXd step = offsets.step.segment(kPose * static_cast<Eigen::Index>(k), kPose);
    place = retract(place, step.data());
  }
}

bool joins_any(const std::vector<BoardOnBody>& boards) {
  for (std::size_t b = 0; b < boards.size(); ++b) {
    if (boards[b].body != b) return true;
  }
  return false;
}

// A board that one picture shows twice.
const Board* shown_twice(const JointProblem& problem) {
  std::set<std::tuple<std::size_t, std::uint64_t, std::size_t>> pictures;
  for (const BoardView& view : problem.views) {
    const View& seen = problem.seen[view.of.camera].views[view.of.view];
    const auto picture = std::tuple(view.of.camera, seen.observation.timestamp, view.board);
    if (!pictures.insert(picture).second) return &seen.board;
  }
  return nullptr;
}

// Every board by itself, where that places all cameras.
Result<BoardsSolve> solve_without_bodies(const JointProblem& problem,
                                         const std::vector<BoardOnBody>& boards,
                                         const std::stop_token& stop) {
  auto joint = solve_with_clocks(problem, stop);
  if (joint) return BoardsSolve{*std::move(joint), boards};
  if (joint.error().code != ErrorCode::kDegenerate) return tl::unexpected<Error>(joint.error());
  return make_error(ErrorCode::kDegenerate,
                    "No picture shows how the boards are fixed to each other: show two of them to "
                    "one camera at a time, tilted, or leave fixed-boards out.");
}

}  // namespace

Result<BoardsSolve> solve_with_boards(const JointProblem& problem, const std::stop_token& stop) {
  constexpr double kSettled = 0.05;  // sigmas
  constexpr int kRounds = 8;
  if (const Board* alike = shown_twice(problem)) {
    return make_error(ErrorCode::kInvalidArgument,
                      fmt::format("There are two boards '{}' in one picture: boards that are fixed "
                                  "to each other are told apart by their corners, so take another "
                                  "one for each.",
                                  alike->text()));
  }
  std::vector<BoardOnBody> boards = boards_on_bodies(problem.views, problem.seen, problem.cameras);
  if (!joins_any(boards)) return solve_without_bodies(problem, boards, stop);
  BoardsSolve best;
  for (int round = 0; round < kRounds; ++round) {
    JointProblem of_bodies = problem;
    of_bodies.views = views_of_bodies(boards, problem.views);
    auto joint = solve_with_clocks(std::move(of_bodies), stop);
    if (!joint) return tl::unexpected<Error>(joint.error());
    if (!joint->fit.board_offsets) {
      return make_error(ErrorCode::kDegenerate,
                        "The pictures leave open how the boards are fixed to each other: show two "
                        "of them to one camera at a time in more places, and tilted.");
    }
    best = {*std::move(joint), boards};
    const BoardOffsets& offsets = *best.joint.fit.board_offsets;
    if (largest_step(offsets) < kSettled) break;
    take_step(offsets, boards);
  }
  RigFit& fit = best.joint.fit;
  fit.covariance +=
      congruent(fit.board_offsets->covariance, fit.board_offsets->places_by_offset.transpose());
  return best;
}

}  // namespace calvin::rig
