// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Outlines of discs in the image, and their centroids.

#include "calvin/solve/methods/ellipse_centers.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "calvin/target/kinds.hpp"

namespace calvin {

std::optional<Pixel> center_bias(const Camera& camera, const SE3& camera_from_board,
                                 const Eigen::Vector3d& center, double diameter) {
  constexpr std::size_t kCorners = 64;  // a disc of 64 corners has .998 of the bias of a round one
  const auto middle = camera.project(camera_from_board * center);
  if (!middle) return std::nullopt;
  std::array<Eigen::Vector2d, kCorners> outline;
  for (std::size_t i = 0; i < kCorners; ++i) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(i) / kCorners;
    const Eigen::Vector3d rim(std::cos(angle), std::sin(angle), 0);
    const auto at = camera.project(camera_from_board * (center + diameter / 2 * rim));
    if (!at) return std::nullopt;
    outline[i] = {at->u - middle->u, at->v - middle->v};
  }
  double area = 0;
  Eigen::Vector2d moment = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < kCorners; ++i) {
    const Eigen::Vector2d& a = outline[i];
    const Eigen::Vector2d& b = outline[(i + 1) % kCorners];
    const double cross = a.x() * b.y() - a.y() * b.x();
    area += cross;
    moment += cross * (a + b);
  }
  const Eigen::Vector2d bias = moment / (3 * area);
  if (!bias.allFinite()) return std::nullopt;
  return Pixel{bias.x(), bias.y()};
}

Status have_diameters(std::span<const View> views) {
  const bool all = std::all_of(views.begin(), views.end(), [](const View& view) {
    const auto* board = view.board.as<PointBoard>();
    return board != nullptr && board->is_flat() &&
           std::all_of(board->dots().begin(), board->dots().end(),
                       [](const PointBoard::Dot& dot) { return dot.diameter > 0; });
  });
  if (all) return {};
  return make_error(ErrorCode::kInvalidArgument,
                    "Centres of ellipses are mended where every point is a dot with a diameter in "
                    "the plane z = 0: give the diameters (a column 'diameter'). Boards of circles "
                    "that calibdetect finds need nothing: their centres are those of the circles.");
}

std::vector<View> without_center_bias(std::span<const View> views, const Solution& solution) {
  std::vector<View> mended(views.begin(), views.end());
  const auto camera = Camera::make(solution.calibration);
  if (!camera) return mended;
  auto record = solution.calibration.views.begin();
  for (std::size_t v = 0; v < mended.size(); ++v) {
    const bool rejected = std::any_of(solution.rejected.begin(), solution.rejected.end(),
                                      [v](const RejectedView& r) { return r.index == v; });
    if (rejected || record == solution.calibration.views.end()) continue;
    const SE3 camera_from_board = to_se3((record++)->camera_from_board);
    Observation& seen = mended[v].observation;
    const auto& dots = mended[v].board.as<PointBoard>()->dots();
    for (std::size_t i = 0; i < seen.ids.size(); ++i) {
      const auto index = mended[v].board.index_of(seen.ids[i]);
      if (!index) continue;
      const PointBoard::Dot& dot = dots[*index];
      const auto bias =
          center_bias(*camera, camera_from_board, {dot.x, dot.y, dot.z}, dot.diameter);
      if (bias) seen.uv[i] = {seen.uv[i].u - bias->u, seen.uv[i].v - bias->v};
    }
  }
  return mended;
}

}  // namespace calvin
