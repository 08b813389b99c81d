// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Outlines of discs in the image and their centroids, and conics before a pinhole.

#include "calvin/solve/heikkila/ellipse_centers.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#include <Eigen/Geometry>

#include "calvin/target/kinds.hpp"

namespace calvin {

namespace {

bool has_normal(const PointBoard::Dot& dot) {
  return std::ranges::any_of(dot.normal, [](double n) { return n != 0; });
}

Disc disc_of(const PointBoard::Dot& dot) {
  Disc disc = {{dot.x, dot.y, dot.z}, Eigen::Vector3d::UnitZ(), dot.diameter};
  if (has_normal(dot)) disc.normal = Eigen::Vector3d(dot.normal.data()).stableNormalized();
  return disc;
}

Disc moved(const SE3& camera_from_board, const Disc& disc) {
  return {camera_from_board * disc.center, camera_from_board.rotation * disc.normal, disc.diameter};
}

}  // namespace

std::optional<Pixel> center_bias(const Camera& camera, const SE3& camera_from_board,
                                 const Disc& disc) {
  constexpr std::size_t kCorners = 64;  // a disc of 64 corners has .998 of the bias of a round one
  const Disc at = moved(camera_from_board, disc);
  const auto middle = camera.project(at.center);
  if (!middle) return std::nullopt;
  const Eigen::Vector3d right = at.diameter / 2 * at.normal.unitOrthogonal();
  const Eigen::Vector3d up = at.normal.cross(right);
  std::array<Eigen::Vector2d, kCorners> outline;
  for (std::size_t i = 0; i < kCorners; ++i) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(i) / kCorners;
    const auto rim = camera.project(at.center + std::cos(angle) * right + std::sin(angle) * up);
    if (!rim) return std::nullopt;
    outline[i] = {rim->u - middle->u, rim->v - middle->v};
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

// A plane through the camera with the normal p touches the disc where p^T (c c^T - r^2 (I - n n^T))
// p is 0. That is the dual conic, which takes the line at infinity to the centre of the ellipse.
std::optional<Pixel> conic_bias(const Camera& camera, const SE3& camera_from_board,
                                const Disc& disc) {
  const Disc at = moved(camera_from_board, disc);
  const Eigen::Vector3d& c = at.center;
  const double square = at.diameter * at.diameter / 4;
  const Eigen::Vector3d center =
      c * c.z() - square * (Eigen::Vector3d::UnitZ() - at.normal * at.normal.z());
  if (!(c.z() > 0) || !(center.z() > 0)) return std::nullopt;
  const Eigen::Vector2d off = center.head<2>() / center.z() - c.head<2>() / c.z();
  return Pixel{camera.fx() * off.x() + camera.skew() * off.y(), camera.fy() * off.y()};
}

Status have_diameters(std::span<const View> views) {
  const bool all = std::all_of(views.begin(), views.end(), [](const View& view) {
    const auto* board = view.board.as<PointBoard>();
    return board != nullptr &&
           std::all_of(board->dots().begin(), board->dots().end(), [&](const auto& dot) {
             return dot.diameter > 0 && (has_normal(dot) || board->is_flat());
           });
  });
  if (all) return {};
  return make_error(ErrorCode::kInvalidArgument,
                    "Centres of ellipses are mended where every point is a dot with a diameter in "
                    "the plane z = 0, or with a normal of the surface about it: give the diameters "
                    "(a column 'diameter'), and of dots in space the normals (columns 'nx ny nz'). "
                    "Boards of circles that calibdetect finds need nothing: their centres are "
                    "those of the circles.");
}

std::vector<View> without_center_bias(std::span<const View> views, const Solution& solution,
                                      DiscBias bias) {
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
      const auto off = bias(*camera, camera_from_board, disc_of(dots[*index]));
      if (off) seen.uv[i] = {seen.uv[i].u - off->u, seen.uv[i].v - off->v};
    }
  }
  return mended;
}

}  // namespace calvin
