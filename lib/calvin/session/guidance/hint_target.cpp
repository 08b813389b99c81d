// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Tries poses of a board, from those that help most on, until one does what the hint asks for.

#include "calvin/session/guidance/hint_target.hpp"

#include <cmath>
#include <numbers>

#include "calvin/camera/image_transform.hpp"
#include "calvin/geometry/se3.hpp"
#include "calvin/session/guidance/board_placement.hpp"

namespace calvin {

namespace {

// Square root of the board's part of the picture, where it faces the camera.
constexpr double kShown[] = {0.45, 0.35, 0.25, 0.15};
constexpr double kClose[] = {0.75, 0.65, 0.55, 0.45, 0.35, 0.25, 0.15};
constexpr double kBeside[] = {0.3, 0.25, 0.2, 0.15, 0.1};
constexpr double kTilted[] = {0.45, 0.6, 0.35, 0.25, 0.15};
constexpr double kTiltAngles[] = {0.6, 0.8, 1.0};  // rad

class TargetSearch {
 public:
  TargetSearch(const ViewCoverage& coverage, const Board& board, const Camera& camera)
      : coverage_(coverage), place_(board, camera) {}

  std::optional<SE3> find() {
    const Hint hint = coverage_.hint();
    switch (hint.kind) {
      case HintKind::kShowBoard:
        for (const double size : kShown) consider(place_.pose_at(place_.middle(), size, {0, 0, 0}));
        break;
      case HintKind::kComeCloser:
        for (const double size : kClose) consider(place_.pose_at(place_.middle(), size, {0, 0, 0}));
        break;
      case HintKind::kMove:
        for (const double size : kBeside) consider(pose_beside(hint.direction, size));
        break;
      case HintKind::kTilt:
        for (const double size : kTilted) {
          for (const double tilt : kTiltAngles) {
            consider(place_.pose_at(place_.middle(), size, tilt * axis_of(hint.direction)));
          }
        }
        break;
      default:
        break;
    }
    return helps_ ? helps_ : fits_;
  }

 private:
  // The pose is the first one that fits, or that helps, or neither.
  void consider(const std::optional<SE3>& pose) {
    if (helps_ || !pose || !place_.is_inside(*pose)) return;
    if (!fits_) fits_ = pose;
    ViewCoverage after = coverage_;
    const auto view = place_.view(*pose, 1);
    if (!view) return;
    after.add(*view);
    if (after.hint() != coverage_.hint()) helps_ = pose;
  }

  // About which the board is to be turned for that edge to come nearer.
  static Eigen::Vector3d axis_of(HintDirection edge) {
    switch (edge) {
      case HintDirection::kLeft:
        return {0, -1, 0};
      case HintDirection::kRight:
        return {0, 1, 0};
      case HintDirection::kTop:
        return {1, 0, 0};
      case HintDirection::kBottom:
        return {-1, 0, 0};
      default:
        return {1, 1, 0};
    }
  }

  // The board beside that border of the picture.
  [[nodiscard]] std::optional<SE3> pose_beside(HintDirection border, double size) const {
    constexpr double kStep = 0.7;  // of the way that is left: lenses are not linear
    const ImageSize picture = place_.camera().image_size();
    const double margin = place_.margin();
    Pixel at = place_.middle();
    std::optional<SE3> pose = place_.pose_at(at, size, {0, 0, 0});
    for (int i = 0; i < 12 && pose; ++i) {
      const auto box = place_.box(*pose);
      if (!box) return std::nullopt;
      if (border == HintDirection::kLeft) at.u += kStep * (margin - box->left);
      if (border == HintDirection::kTop) at.v += kStep * (margin - box->top);
      if (border == HintDirection::kRight) {
        at.u += kStep * (picture.width - 1 - margin - box->right);
      }
      if (border == HintDirection::kBottom) {
        at.v += kStep * (picture.height - 1 - margin - box->bottom);
      }
      pose = place_.pose_at(at, size, {0, 0, 0});
    }
    return pose;
  }

  const ViewCoverage& coverage_;
  BoardPlacement place_;
  std::optional<SE3> fits_;
  std::optional<SE3> helps_;
};

}  // namespace

std::optional<Pose> hint_target(const ViewCoverage& coverage, const Board& board,
                                const Camera& camera) {
  const auto pose = TargetSearch(coverage, board, camera).find();
  if (!pose) return std::nullopt;
  return to_pose(*pose);
}

std::optional<Camera> nominal_camera(ImageSize size) {
  const double focal = size.width / 2.0 / std::tan(35 * std::numbers::pi / 180);
  auto camera =
      Camera::make("pinhole", size,
                   {focal, focal, coordinate_at(0.5, size.width), coordinate_at(0.5, size.height)});
  if (!camera) return std::nullopt;
  return *std::move(camera);
}

}  // namespace calvin
