// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The linear start of objects in space and of planes, and the inverse model in words.

#include "calvin/solve/methods/heikkila.hpp"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <Eigen/LU>

#include "calvin/solve/heikkila/inverse_model.hpp"
#include "calvin/solve/methods/dlt.hpp"
#include "calvin/solve/methods/plane_views.hpp"
#include "calvin/solve/start/camera_guess.hpp"
#include "calvin/solve/start/plane_pose.hpp"

namespace calvin {

namespace {

tl::unexpected<Error> no_heikkila_camera(std::string_view why) {
  return make_error(ErrorCode::kDegenerate,
                    fmt::format("Heikkila's method finds no camera: {}.", why));
}

// Of the plane one image width before the camera, whose axis meets the centre of the image.
std::optional<Eigen::Matrix3d> camera_of_planes(const PlaneViews& planes, ImageSize size) {
  const auto guesses = closed_form_guesses(planes.homographies, size);
  if (guesses.empty()) return std::nullopt;
  // The last one is the median over the views, with the principal point at the centre.
  const double focal = guesses.back()[0] / size.width;
  return Eigen::Vector3d(focal, focal, 1).asDiagonal();
}

// K of views of points in space, px: the mean.
Result<Eigen::Matrix3d> camera_in_space(const MethodInput& input,
                                        std::vector<std::optional<SE3>>& poses) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  double count = 0;
  for (std::size_t i = 0; i < input.views.size(); ++i) {
    if (!spans_space(input.views[i])) continue;
    const auto camera = dlt_of_view(input.views[i], i, input.size);
    if (!camera) return tl::unexpected<Error>(camera.error());
    sum += camera->k;
    count += 1;
    poses[i] = camera->camera_from_board;
  }
  return Eigen::Matrix3d(sum / std::max(count, 1.0));
}

// The other views, which are of planes.
MethodInput flat_part(const MethodInput& input, const std::vector<std::optional<SE3>>& poses,
                      std::vector<PointSet>& flat) {
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (!poses[i]) flat.push_back(input.views[i]);
  }
  MethodInput part = input;
  part.views = flat;
  return part;
}

}  // namespace

Result<MethodResult> heikkila_method(const MethodInput& input) {
  std::vector<std::optional<SE3>> poses(input.views.size());
  const auto in_space = camera_in_space(input, poses);
  if (!in_space) return tl::unexpected<Error>(in_space.error());
  std::vector<PointSet> flat;
  const MethodInput part = flat_part(input, poses, flat);
  const auto planes = plane_views(part, "Heikkila's method");
  if (!planes) return tl::unexpected<Error>(planes.error());
  Eigen::Matrix3d px = *in_space;
  if (flat.size() == input.views.size()) {
    const auto unit = camera_of_planes(*planes, input.size);
    if (!unit) {
      return no_heikkila_camera(
          "the planes are seen head-on, which tells no focal length: tilt them, to the left, to "
          "the right, up and down, or give points in space");
    }
    px = in_pixels(*unit, input.size);
  }
  const Eigen::Matrix3d ray_from_unit =
      px.inverse() * in_pixels(Eigen::Matrix3d::Identity(), input.size);
  auto camera = Camera::make("pinhole", input.size, {px(0, 0), px(1, 1), px(0, 2), px(1, 2)},
                             input.skew ? px(0, 1) : 0);
  if (!camera) return tl::unexpected<Error>(camera.error());
  MethodResult result = {*std::move(camera), {}, {}, {}};
  std::size_t next = 0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (!poses[i]) {
      poses[i] = pose_from_homography(ray_from_unit * planes->homographies[next]);
      if (!poses[i]) return no_heikkila_camera(fmt::format("view {} has no pose", i));
      poses[i] = *poses[i] * planes->plane_from_board[next++];
    }
    result.camera_from_board.push_back(*poses[i]);
  }
  return result;
}

std::string inverse_remark(const Camera& camera) {
  const auto inverse = inverse_of(camera, InverseTerms::kEight);
  if (!inverse) {
    return "No inverse model of Heikkila's follows this camera, which is too wide for one.";
  }
  std::string text = "Heikkila's inverse model, of places as seen, in focal lengths:";
  for (std::size_t i = 0; i < inverse->model.a.size(); ++i) {
    text += fmt::format(" a{} {:.6g}", i + 1, inverse->model.a[i]);
  }
  text += fmt::format("; it follows this camera within {:.2g} px", inverse->residual);
  const auto four = inverse_of(camera, InverseTerms::kFour);
  if (four) {
    const auto& a = four->model.a;
    text += fmt::format(", with K1 {:.6g} K2 {:.6g} T1 {:.6g} T2 {:.6g} alone within {:.2g} px",
                        a[0], a[1], a[2], a[3], four->residual);
  }
  return text + ".";
}

}  // namespace calvin
