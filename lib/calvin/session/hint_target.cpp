// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Tries poses of a board, from those that help most on, until one does what the hint asks for.

#include "calvin/session/hint_target.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "calvin/camera/image_transform.hpp"
#include "calvin/geometry/se3.hpp"

namespace calvin {

namespace {

constexpr double kMargin = 0.02;  // of the picture's shorter side, kept between board and border
constexpr int kSamples = 8;       // of each edge of the board: a lens may bend it

// Square root of the board's part of the picture, where it faces the camera.
constexpr double kShown[] = {0.45, 0.35, 0.25, 0.15};
constexpr double kClose[] = {0.75, 0.65, 0.55, 0.45, 0.35, 0.25, 0.15};
constexpr double kBeside[] = {0.3, 0.25, 0.2, 0.15, 0.1};
constexpr double kTilted[] = {0.45, 0.6, 0.35, 0.25, 0.15};
constexpr double kTilts[] = {0.6, 0.8, 1.0};  // rad

struct Box {
  double left = HUGE_VAL;
  double right = -HUGE_VAL;
  double top = HUGE_VAL;
  double bottom = -HUGE_VAL;
};

class TargetSearch {
 public:
  TargetSearch(const ViewCoverage& coverage, const Board& board, const Camera& camera)
      : coverage_(coverage), board_(board), camera_(camera), area_(board.outline()) {}

  std::optional<SE3> find() {
    const Hint hint = coverage_.hint();
    switch (hint.kind) {
      case HintKind::kShowBoard:
        for (const double size : kShown) consider(pose_at(middle(), size, {0, 0, 0}));
        break;
      case HintKind::kComeCloser:
        for (const double size : kClose) consider(pose_at(middle(), size, {0, 0, 0}));
        break;
      case HintKind::kMove:
        for (const double size : kBeside) consider(pose_beside(hint.direction, size));
        break;
      case HintKind::kTilt:
        for (const double size : kTilted) {
          for (const double tilt : kTilts) {
            consider(pose_at(middle(), size, tilt * axis_of(hint.direction)));
          }
        }
        break;
      case HintKind::kGood:
        break;
    }
    return helps_ ? helps_ : fits_;
  }

 private:
  // The pose is the first one that fits, or that helps, or neither.
  void consider(const std::optional<SE3>& pose) {
    if (helps_ || !pose || !is_inside(*pose)) return;
    if (!fits_) fits_ = pose;
    ViewCoverage after = coverage_;
    const auto view = view_of(*pose);
    if (!view) return;
    after.add(*view);
    if (after.hint() != coverage_.hint()) helps_ = pose;
  }

  [[nodiscard]] Pixel middle() const {
    const ImageSize size = camera_.image_size();
    return {coordinate_at(0.5, size.width), coordinate_at(0.5, size.height)};
  }
  [[nodiscard]] double margin() const {
    return kMargin * std::min(camera_.image_size().width, camera_.image_size().height);
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
      case HintDirection::kNone:
        break;
    }
    return {1, 1, 0};
  }

  // The middle of the board at that pixel, turned by `tilt` from where it faces the camera.
  [[nodiscard]] std::optional<SE3> pose_at(Pixel at, double size,
                                           const Eigen::Vector3d& tilt) const {
    const auto ray = camera_.unproject(at);
    if (!ray) return std::nullopt;
    const ImageSize picture = camera_.image_size();
    const double scale = std::sqrt(camera_.fx() * camera_.fy() * area_.width() * area_.height() /
                                   (1.0 * picture.width * picture.height));
    const Eigen::Vector3d center((area_.left + area_.right) / 2, (area_.top + area_.bottom) / 2, 0);
    const Eigen::Matrix3d rotation =
        rotation_between(Eigen::Vector3d::UnitZ(), *ray) * exp_so3(tilt);
    return SE3{rotation, *ray * (scale / size) - rotation * center};
  }

  // The board beside that border of the picture.
  [[nodiscard]] std::optional<SE3> pose_beside(HintDirection border, double size) const {
    constexpr double kStep = 0.7;  // of the way that is left: lenses are not linear
    const ImageSize picture = camera_.image_size();
    Pixel at = middle();
    std::optional<SE3> pose = pose_at(at, size, {0, 0, 0});
    for (int i = 0; i < 12 && pose; ++i) {
      const auto box = box_of(*pose);
      if (!box) return std::nullopt;
      if (border == HintDirection::kLeft) at.u += kStep * (margin() - box->left);
      if (border == HintDirection::kTop) at.v += kStep * (margin() - box->top);
      if (border == HintDirection::kRight) {
        at.u += kStep * (picture.width - 1 - margin() - box->right);
      }
      if (border == HintDirection::kBottom) {
        at.v += kStep * (picture.height - 1 - margin() - box->bottom);
      }
      pose = pose_at(at, size, {0, 0, 0});
    }
    return pose;
  }

  // Around the outline of the board in the picture; absent where a part of it has no place there.
  [[nodiscard]] std::optional<Box> box_of(const SE3& pose) const {
    Box box;
    for (int edge = 0; edge < 4; ++edge) {
      for (int i = 0; i < kSamples; ++i) {
        const double along = static_cast<double>(i) / kSamples;
        const double x = edge == 0 ? along : edge == 1 ? 1 : edge == 2 ? 1 - along : 0;
        const double y = edge == 0 ? 0 : edge == 1 ? along : edge == 2 ? 1 : 1 - along;
        const auto at = camera_.project(pose * Eigen::Vector3d(area_.left + x * area_.width(),
                                                               area_.top + y * area_.height(), 0));
        if (!at) return std::nullopt;
        box.left = std::min(box.left, at->u);
        box.right = std::max(box.right, at->u);
        box.top = std::min(box.top, at->v);
        box.bottom = std::max(box.bottom, at->v);
      }
    }
    return box;
  }

  [[nodiscard]] bool is_inside(const SE3& pose) const {
    const auto box = box_of(pose);
    const double border = margin() / 2;
    return box && box->left >= border && box->top >= border &&
           box->right <= camera_.image_size().width - 1 - border &&
           box->bottom <= camera_.image_size().height - 1 - border;
  }

  // What the camera would see.
  [[nodiscard]] std::optional<View> view_of(const SE3& pose) const {
    View view;
    view.board = board_;
    view.observation.image_size = camera_.image_size();
    view.observation.ids = board_.ids();
    for (const Eigen::Vector3d& point : board_.points()) {
      const auto at = camera_.project(pose * point);
      if (!at) return std::nullopt;
      view.observation.uv.push_back(*at);
    }
    return view;
  }

  const ViewCoverage& coverage_;
  const Board& board_;
  const Camera& camera_;
  BoardArea area_;
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
