// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Poses of a board by where the picture shows it.

#include "calvin/session/guidance/board_placement.hpp"

#include <algorithm>
#include <cmath>

#include "calvin/camera/image_transform.hpp"

namespace calvin {

namespace {

constexpr double kMargin = 0.02;  // of the picture's shorter side
constexpr int kSamples = 8;       // of each edge of the board

}  // namespace

Pixel BoardPlacement::middle() const {
  const ImageSize size = camera_.image_size();
  return {coordinate_at(0.5, size.width), coordinate_at(0.5, size.height)};
}

double BoardPlacement::margin() const {
  return kMargin * std::min(camera_.image_size().width, camera_.image_size().height);
}

std::optional<SE3> BoardPlacement::pose_at(Pixel at, double size,
                                           const Eigen::Vector3d& turn) const {
  const auto ray = camera_.unproject(at);
  if (!ray) return std::nullopt;
  const ImageSize picture = camera_.image_size();
  const double scale = std::sqrt(camera_.fx() * camera_.fy() * area_.width() * area_.height() /
                                 (1.0 * picture.width * picture.height));
  const Eigen::Vector3d center((area_.left + area_.right) / 2, (area_.top + area_.bottom) / 2, 0);
  const Eigen::Matrix3d rotation = rotation_between(Eigen::Vector3d::UnitZ(), *ray) * exp_so3(turn);
  return SE3{rotation, *ray * (scale / size) - rotation * center};
}

std::vector<Pixel> BoardPlacement::outline(const SE3& camera_from_board) const {
  std::vector<Pixel> outline;
  for (int edge = 0; edge < 4; ++edge) {
    for (int i = 0; i < kSamples; ++i) {
      const double along = static_cast<double>(i) / kSamples;
      const double x = edge == 0 ? along : edge == 1 ? 1 : edge == 2 ? 1 - along : 0;
      const double y = edge == 0 ? 0 : edge == 1 ? along : edge == 2 ? 1 : 1 - along;
      const auto at =
          camera_.project(camera_from_board * Eigen::Vector3d(area_.left + x * area_.width(),
                                                              area_.top + y * area_.height(), 0));
      if (!at) return {};
      outline.push_back(*at);
    }
  }
  return outline;
}

std::optional<PictureBox> BoardPlacement::box(const SE3& camera_from_board) const {
  const std::vector<Pixel> around = outline(camera_from_board);
  if (around.empty()) return std::nullopt;
  PictureBox box = {HUGE_VAL, -HUGE_VAL, HUGE_VAL, -HUGE_VAL};
  for (const Pixel& at : around) {
    box.left = std::min(box.left, at.u);
    box.right = std::max(box.right, at.u);
    box.top = std::min(box.top, at.v);
    box.bottom = std::max(box.bottom, at.v);
  }
  return box;
}

bool BoardPlacement::is_inside(const SE3& camera_from_board) const {
  const auto around = box(camera_from_board);
  const double border = margin() / 2;
  return around && around->left >= border && around->top >= border &&
         around->right <= camera_.image_size().width - 1 - border &&
         around->bottom <= camera_.image_size().height - 1 - border;
}

std::optional<View> BoardPlacement::view(const SE3& camera_from_board, double sigma) const {
  View view;
  view.board = board_;
  view.observation.image_size = camera_.image_size();
  view.observation.ids = board_.ids();
  for (const Eigen::Vector3d& point : board_.points()) {
    const auto at = camera_.project(camera_from_board * point);
    if (!at) return std::nullopt;
    view.observation.uv.push_back(*at);
    view.observation.sigma.push_back(sigma);
  }
  return view;
}

}  // namespace calvin
