// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Frames, texts and sentences.

#include "calvin/rig/result/fixed_board_result.hpp"

#include <cstddef>
#include <optional>

#include <fmt/format.h>
#include <Eigen/Core>

#include "calvin/geometry/dense.hpp"
#include "calvin/rig/pose_unknowns.hpp"

namespace calvin::rig {

namespace {

// The text of each board, by BoardView::own_board.
std::vector<std::string> texts_of(const std::vector<RigCameraViews>& seen, const BoardsSolve& one) {
  std::vector<std::string> texts(one.boards.size());
  for (const BoardView& view : one.joint.views) {
    std::string& text = texts[view.own_board];
    if (text.empty()) text = seen[view.of.camera].views[view.of.view].board.text();
  }
  return texts;
}

// d of R = exp(d) R0 and t = exp(d) t0 + e as a turn and a place: of the place e + d x t0.
Eigen::MatrixXd covariance_of(const Eigen::MatrixXd& of_d, const SE3& place, double scale) {
  Eigen::MatrixXd by_d = Eigen::MatrixXd::Identity(kPose, kPose);
  const Eigen::Vector3d& t = place.translation;
  by_d.block<3, 3>(3, 0) << 0, t.z(), -t.y(), -t.z(), 0, t.x(), t.y(), -t.x(), 0;
  by_d.bottomRows<3>() *= scale;
  return congruent(of_d, by_d.transpose());
}

std::optional<std::string> why_alone(const BoardOnBody& board, const std::string& text) {
  if (!board.is_decided) {
    return fmt::format(
        "What was seen leaves open how the board '{}' is fixed to the others, so that it was taken "
        "for one by itself: show it beside another one in more places, and tilted.",
        text);
  }
  if (!board.is_seen_with_others) {
    return fmt::format(
        "The board '{}' was not seen together with another one by any camera, and was taken for "
        "one by itself: show it to one camera beside another board.",
        text);
  }
  return std::nullopt;
}

}  // namespace

void set_fixed_boards(const std::vector<RigCameraViews>& seen, const BoardsSolve& one, double scale,
                      Rig& to, std::vector<std::string>& remarks) {
  if (one.boards.empty()) return;
  const std::vector<std::string> texts = texts_of(seen, one);
  for (std::size_t b = 0; b < one.boards.size(); ++b) {
    if (texts[b].empty()) continue;
    if (const auto why = why_alone(one.boards[b], texts[b])) remarks.push_back(*why);
  }
  if (!one.joint.fit.board_offsets) return;
  const BoardOffsets& offsets = *one.joint.fit.board_offsets;
  for (std::size_t k = 0; k < offsets.boards.size(); ++k) {
    const BoardOnBody& on = one.boards[offsets.boards[k]];
    const auto at = kPose * static_cast<Eigen::Index>(k);
    const Eigen::MatrixXd covariance =
        covariance_of(offsets.covariance.block(at, at, kPose, kPose), on.body_from_board, scale);
    SE3 place = on.body_from_board;
    place.translation *= scale;
    to.fixed_boards.push_back(
        {texts[offsets.boards[k]], texts[on.body], to_pose(place), row_major(covariance)});
  }
}

}  // namespace calvin::rig
