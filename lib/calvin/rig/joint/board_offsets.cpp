// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// How corners of a board move in the pictures where its body does not.

#include "calvin/rig/joint/board_offsets.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "calvin/rig/joint/extra_unknowns.hpp"
#include "calvin/rig/pose_unknowns.hpp"
#include "calvin/solve/residuals/bundle_problem.hpp"

namespace calvin::rig {

namespace {

bool has_labelling(const BoardView& view, const SE3& body_from_own) {
  return std::ranges::any_of(view.labellings, [&](const SE3& labelling) {
    return is_same_labelling(labelling, body_from_own);
  });
}

// body_from_pose of each pose of the places, in whose frame one of its views has it: by the
// labelling of that view by which all others of the pose have one of theirs.
std::vector<SE3> frames_of(const std::vector<BoardView>& views, const RigPlaces& places) {
  std::vector<std::vector<const PlacedView*>> placed(places.rig_from_board.size());
  for (const PlacedView& one : places.views) placed[one.pose].push_back(&one);
  std::vector<SE3> frames(placed.size());
  for (std::size_t pose = 0; pose < placed.size(); ++pose) {
    if (placed[pose].empty()) continue;
    const PlacedView& one = *placed[pose].front();
    for (const SE3& labelling : views[one.view].labellings) {
      const SE3 frame = labelling * one.board_from_own.inverse();
      const bool is_right = std::ranges::all_of(placed[pose], [&](const PlacedView* other) {
        return has_labelling(views[other->view], frame * other->board_from_own);
      });
      if (is_right) frames[pose] = frame;
    }
  }
  return frames;
}

// Of one unit of the number `k` of a board's place on its body.
Ways ways_of(std::size_t board, std::size_t k, const std::vector<BoardView>& views,
             const std::vector<Camera>& cameras, const RigPlaces& places,
             const std::vector<SE3>& frames) {
  constexpr double kStep = 1e-6;  // rad, m
  std::array<double, kPose> d{};
  Ways ways(places.views.size());
  for (std::size_t p = 0; p < ways.size(); ++p) {
    const PlacedView& placed = places.views[p];
    const BoardView& view = views[placed.view];
    if (view.own_board != board) continue;
    const Camera& camera = cameras[view.of.camera];
    const SE3 camera_from_body = places.camera_from_rig[view.of.camera] *
                                 places.rig_from_board[placed.pose] * frames[placed.pose].inverse();
    const SE3 body_from_own = frames[placed.pose] * placed.board_from_own;
    d[k] = kStep;
    const SE3 ahead = camera_from_body * retract(body_from_own, d.data());
    d[k] = -kStep;
    const SE3 behind = camera_from_body * retract(body_from_own, d.data());
    for (const Eigen::Vector3d& point : view.seen.points) {
      const auto a = camera.project(ahead * point);
      const auto b = camera.project(behind * point);
      Pixel& way = ways[p].emplace_back(Pixel{0, 0});
      if (a && b) way = {(b->u - a->u) / (2 * kStep), (b->v - a->v) / (2 * kStep)};
    }
  }
  return ways;
}

// Boards that are seen in views that are in use, and do not define their body.
std::vector<std::size_t> unknown_boards(const std::vector<BoardView>& views,
                                        const RigSolver& solver) {
  std::vector<std::size_t> boards;
  for (std::size_t p = 0; p < solver.places().views.size(); ++p) {
    const BoardView& view = views[solver.places().views[p].view];
    if (view.own_board != view.board && solver.is_used(p)) boards.push_back(view.own_board);
  }
  std::ranges::sort(boards);
  boards.erase(std::unique(boards.begin(), boards.end()), boards.end());
  return boards;
}

}  // namespace

std::optional<BoardOffsets> board_offsets(const std::vector<BoardView>& views,
                                          const std::vector<Camera>& cameras, RigSolver& solver,
                                          double variance) {
  constexpr double kLeastPivot = 1;  // (px per rad or m)^2
  BoardOffsets offsets;
  offsets.boards = unknown_boards(views, solver);
  if (offsets.boards.empty()) return std::nullopt;
  const std::vector<SE3> frames = frames_of(views, solver.places());
  std::vector<Ways> ways;
  for (const std::size_t board : offsets.boards) {
    for (std::size_t k = 0; k < kPose; ++k) {
      ways.push_back(ways_of(board, k, views, cameras, solver.places(), frames));
    }
  }
  const auto found = extra_unknowns(ways, solver, variance, kLeastPivot);
  if (!found) return std::nullopt;
  offsets.step = found->step;
  offsets.covariance = found->covariance;
  offsets.places_by_offset = found->places_by_unknown;
  return offsets;
}

}  // namespace calvin::rig
