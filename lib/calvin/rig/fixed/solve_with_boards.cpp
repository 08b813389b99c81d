// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Steps of Gauss-Newton over where boards are on their bodies, a solve for each.

#include "calvin/rig/fixed/solve_with_boards.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "calvin/geometry/dense.hpp"
#include "calvin/solve/residuals/bundle_problem.hpp"

namespace calvin::rig {

namespace {

constexpr Eigen::Index kPose = 6;

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

}  // namespace

Result<BoardsSolve> solve_with_boards(const JointProblem& problem, const std::stop_token& stop) {
  constexpr double kSettled = 0.05;  // sigmas
  constexpr int kRounds = 8;
  std::vector<BoardOnBody> boards = boards_on_bodies(problem.views, problem.seen, problem.cameras);
  if (!joins_any(boards)) {
    return make_error(
        ErrorCode::kDegenerate,
        "No picture shows how the boards are fixed to each other: show two of them to "
        "one camera at a time, tilted, or leave fixed-boards out.");
  }
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
