// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Radial models of planes, and the camera that has their distortion.

#include "calvin/solve/methods/discorpy.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "calvin/solve/methods/plane_views.hpp"
#include "calvin/solve/methods/radial_planes.hpp"
#include "calvin/solve/start/parabolas.hpp"
#include "calvin/solve/start/plane_pose.hpp"

namespace calvin {

namespace {

Result<RadialModel> model_of(const MethodInput& input) {
  if (input.model == "brown4") return RadialModel{2, false, input.centered};
  if (input.model == "brown5") return RadialModel{3, false, input.centered};
  if (input.model == "rational8") return RadialModel{3, true, input.centered};
  return make_error(ErrorCode::kInvalidArgument,
                    fmt::format("The method discorpy finds the radial coefficients of brown4, "
                                "brown5 or rational8, and none of '{}'.",
                                input.model));
}

// fx fy cx cy k1 k2 p1 p2 [k3 [k4 k5 k6]]
Result<Camera> camera_of(const MethodInput& input, const Pixel& center,
                         const std::vector<double>& k) {
  const double width = input.size.width;
  std::vector<double> all = {width, width, center.u, center.v, k[0], k[1], 0, 0};
  all.insert(all.end(), k.begin() + 2, k.end());
  return Camera::make(input.model, input.size, all);
}

constexpr const char* kNoFocalLength =
    "The focal length is not known: fx and fy stand at the width of the image. Straight lines "
    "become "
    "straight whatever it is; angles and distances in space are not told.";

std::vector<std::string> estimated(const RadialModel& model) {
  std::vector<std::string> names;
  if (!model.centered) names = {"cx", "cy"};
  for (int i = 1; i <= model.count(); ++i) names.push_back(fmt::format("k{}", i));
  return names;
}

// 1 + a r^2 + b r^4 + ..., r in px.
std::string polynomial(const double* k, int terms, double width) {
  std::string text = "1";
  for (int i = 1; i <= terms; ++i) {
    text += fmt::format(" {} {:.6g} r^{}", k[i - 1] < 0 ? '-' : '+',
                        std::abs(k[i - 1]) / std::pow(width, 2 * i), 2 * i);
  }
  return text;
}

std::vector<std::string> remarks_of(const RadialPlanes& planes, const RadialModel& model,
                                    ImageSize size) {
  const std::string above = polynomial(planes.k.data(), model.terms, size.width);
  std::string law = fmt::format("r ({})", above);
  if (model.rational) {
    law = fmt::format("r ({}) / ({})", above,
                      polynomial(planes.k.data() + model.terms, model.terms, size.width));
  }
  std::vector<std::string> remarks = {
      fmt::format("A point at r px from {:.3f}, {:.3f} without distortion is seen at {} px.",
                  planes.center.u, planes.center.v, law),
      kNoFocalLength};
  if (!planes.left_out.empty()) {
    remarks.push_back(
        fmt::format("{} points that do not lie on the grid are left out.", planes.left_out.size()));
  }
  constexpr double kWeak = 0.02;  // of the width
  if (!model.centered &&
      std::sqrt(planes.covariance.diagonal().head<2>().maxCoeff()) > kWeak * size.width) {
    remarks.emplace_back(
        "The lens bends lines so little that the centre of its distortion is hardly known: fix the "
        "center, or take brown4.");
  }
  return remarks;
}

// From the centre to the farthest corner of the image, px.
double reach_of(const Pixel& center, ImageSize size) {
  return std::hypot(std::max(center.u, size.width - 1 - center.u),
                    std::max(center.v, size.height - 1 - center.v));
}

// The coefficients of a model that are nearest to the powers of discorpy, over the image.
RadialFit nearest(const PowersOfRadius& powers, ImageSize size, const RadialModel& model) {
  constexpr int kRadii = 200;
  const double reach = reach_of(powers.center, size);
  std::vector<SeenRadius> radii;
  for (int i = 1; i <= kRadii; ++i) {
    const double r = reach * i / kRadii;
    radii.push_back({powers.seen(r) / size.width, powers.factors[0] * r / size.width});
  }
  return fit_radii(radii, model);
}

// The steps of discorpy itself, and the camera that is nearest to what they find.
Result<MethodResult> by_parabolas(const MethodInput& input, const RadialModel& model) {
  if (input.views.size() != 1) {
    return make_error(ErrorCode::kInvalidArgument,
                      fmt::format("The steps of discorpy take one view, and {} are given: leave "
                                  "one, or let them be refined.",
                                  input.views.size()));
  }
  const PointSet& view = input.views.front();
  const auto found = distortion_by_parabolas(view, input.size);
  if (!found) return tl::unexpected<Error>(found.error());
  const RadialFit fit = nearest(*found, input.size, model);
  auto camera = camera_of(input, found->center, fit.k);
  if (!camera) return tl::unexpected<Error>(camera.error());
  std::vector<Eigen::Vector3d> rays;
  for (const Pixel& p : view.uv) {
    rays.push_back(camera->unproject(p).value_or(Eigen::Vector3d::Zero()));
  }
  const auto h = plane_homography(view.points, rays);
  const auto pose = h ? pose_from_homography(*h) : std::nullopt;
  if (!pose) return make_error(ErrorCode::kDegenerate, "The plane of the view is seen edge on.");
  std::string remark =
      fmt::format("discorpy's own numbers: xcenter {:.6f}, ycenter {:.6f}, factors",
                  found->center.u, found->center.v);
  for (const double factor : found->factors) remark += fmt::format(" {:.8g}", factor);
  remark += fmt::format("; {} follows them within {:.2g} px.", input.model,
                        input.size.width * fit.residual);
  MethodResult result = {*std::move(camera), {*pose}, {std::move(remark), kNoFocalLength}, {}};
  RayFromBoard rows;
  rows << h->leftCols<2>(), Eigen::Vector3d::Zero(), h->col(2);
  result.ray_from_board = {rows};
  return result;
}

}  // namespace

Result<MethodResult> discorpy_method(const MethodInput& input) {
  const auto model = model_of(input);
  if (!model) return tl::unexpected<Error>(model.error());
  if (!input.refine) return by_parabolas(input, *model);
  const auto planes = plane_views(input, "The method discorpy");
  if (!planes) return tl::unexpected<Error>(planes.error());
  std::vector<PointSet> flat(input.views.begin(), input.views.end());
  for (std::size_t v = 0; v < flat.size(); ++v) {
    for (Eigen::Vector3d& p : flat[v].points) p = planes->plane_from_board[v] * p;
  }
  const auto found =
      fit_radial_planes(flat, planes->homographies, input.size, *model, input.reject_outliers);
  if (!found) return tl::unexpected<Error>(found.error());
  auto camera = camera_of(input, found->center, found->k);
  if (!camera) return tl::unexpected<Error>(camera.error());
  MethodResult result = {*std::move(camera), {}, remarks_of(*found, *model, input.size), {}};
  for (std::size_t v = 0; v < flat.size(); ++v) {
    const auto pose = pose_from_homography(found->homographies[v]);
    if (!pose) {
      return make_error(ErrorCode::kDegenerate,
                        fmt::format("The plane of view {} is seen edge on.", v));
    }
    result.camera_from_board.push_back(*pose * planes->plane_from_board[v]);
    RayFromBoard plane_rows;
    const SE3& to_plane = planes->plane_from_board[v];
    plane_rows << to_plane.rotation.topRows<2>(), to_plane.translation.head<2>(),
        Eigen::RowVector4d(0, 0, 0, 1);
    result.ray_from_board.push_back(found->homographies[v] * plane_rows);
  }
  result.left_out = found->left_out;
  result.estimated = estimated(*model);
  result.covariance = found->covariance;
  return result;
}

}  // namespace calvin
