// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Tsai's three-parameter least squares, and the way to our models.

#include "calvin/solve/methods/tsai.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Core>

#include "calvin/solve/linear/dense_problem.hpp"
#include "calvin/solve/linear/lm.hpp"
#include "calvin/solve/methods/radial_planes.hpp"

namespace calvin {

namespace {

// Focal length, tz and kappa by least squares on distances in the ideal image: for minimise().
class ThreeParameters : public DenseProblem<ThreeParameters> {
 public:
  ThreeParameters(const std::vector<CenteredPoint>& seen, const TsaiCamera& from) : camera_(from) {
    const double tz = from.camera_from_board.translation.z();
    for (const CenteredPoint& s : seen) {
      const Eigen::Vector3d at = from.camera_from_board * s.board;
      points_.push_back({{at.x(), at.y(), at.z() - tz}, {s.image.x() / from.sx, s.image.y()}});
    }
    current_.x = Eigen::Vector3d(from.focal, tz, from.kappa);
    (void)begin();
  }

  [[nodiscard]] TsaiCamera result() const {
    TsaiCamera found = camera_;
    found.focal = current_.x[0];
    found.camera_from_board.translation.z() = current_.x[1];
    found.kappa = current_.x[2];
    return found;
  }

 private:
  friend DenseProblem;

  // By focal length, tz and kappa.
  bool linearise(NormalEquations& at) const {
    at.normal.setZero(3, 3);
    at.gradient.setZero(3);
    at.cost = 0;
    for (const CenteredPoint& p : points_) {
      const double z = p.board.z() + at.x[1];
      if (!(z > 0)) return false;
      const double square = p.image.squaredNorm();
      for (int k = 0; k < 2; ++k) {
        const double slope = p.board[k] / z;
        const double r = at.x[0] * slope - p.image[k] * (1 + at.x[2] * square);
        const Eigen::Vector3d by(slope, -at.x[0] * slope / z, -p.image[k] * square);
        at.normal += by * by.transpose();
        at.gradient += r * by;
        at.cost += r * r;
      }
    }
    return std::isfinite(at.cost);
  }

  TsaiCamera camera_;
  std::vector<CenteredPoint> points_;  // camera frame less tz, and the image with sx taken off
};

// Radii from 0 to `most` px: seen, and ideal, in focal lengths. Near the radius where the
// distortion folds no polynomial follows it.
std::vector<SeenRadius> radii(const TsaiCamera& camera, double most) {
  constexpr int kCount = 200;
  if (camera.kappa < 0) most = std::min(most, 0.9 / std::sqrt(-3 * camera.kappa));
  std::vector<SeenRadius> all;
  for (int i = 1; i <= kCount; ++i) {
    const double r = most * i / kCount;
    all.push_back({r / camera.focal, r * (1 + camera.kappa * r * r) / camera.focal});
  }
  return all;
}

// From the centre to the farthest corner of the image, or to the farthest point of a view, px.
double reach_of(const TsaiCamera& camera, ImageSize size) {
  const double half_u = std::max(camera.center.u, size.width - 1 - camera.center.u) / camera.sx;
  const double half_v = std::max(camera.center.v, size.height - 1 - camera.center.v);
  return std::hypot(half_u, half_v);
}
double reach_of(const TsaiCamera& camera, const PointSet& view) {
  double most = 0;
  for (const CenteredPoint& p : centered_points(view, {}, camera.center)) {
    most = std::max(most, std::hypot(p.image.x() / camera.sx, p.image.y()));
  }
  return most;
}

// By the three radial terms of brown5, or by the six of rational8.
NearestCamera nearest(const TsaiCamera& camera, double most, bool rational) {
  const RadialFit fit = fit_radii(radii(camera, most), {3, rational, false});
  const std::vector<double>& k = fit.k;
  NearestCamera result;
  result.model = rational ? "rational8" : "brown5";
  result.parameters = {
      camera.sx * camera.focal, camera.focal, camera.center.u, camera.center.v, k[0], k[1], 0, 0};
  result.parameters.insert(result.parameters.end(), k.begin() + 2, k.end());
  result.residual = camera.focal * fit.residual;
  return result;
}

}  // namespace

Result<TsaiCamera> tsai(const PointSet& view, Pixel center) {
  const auto start = radial_alignment(view, center);
  if (!start) return start;
  ThreeParameters problem(centered_points(view, {}, center), *start);
  (void)minimise(problem, LmOptions{}, {});
  const TsaiCamera camera = problem.result();
  if (!(camera.focal > 0) || !(camera.camera_from_board.translation.z() > 0)) {
    return no_tsai_camera(
        "focal length and distance run away from each other: tilt the plane more, or give points "
        "in space");
  }
  return camera;
}

NearestCamera nearest_camera(const TsaiCamera& camera, ImageSize size) {
  constexpr double kNear = 0.02;  // px: no picture tells the two apart
  const double most = reach_of(camera, size);
  NearestCamera brown = nearest(camera, most, false);
  if (brown.residual <= kNear) return brown;
  NearestCamera rational = nearest(camera, most, true);
  return rational.residual < brown.residual ? rational : brown;
}

Result<MethodResult> tsai_method(const MethodInput& input) {
  if (input.views.size() != 1) {
    return make_error(ErrorCode::kInvalidArgument,
                      fmt::format("Tsai's method takes one view, and {} are given: leave one, or "
                                  "take the method zhang or dlt.",
                                  input.views.size()));
  }
  const auto found = tsai(input.views[0], image_center(input.size));
  if (!found) return tl::unexpected<Error>(found.error());
  const NearestCamera ours = nearest_camera(*found, input.size);
  auto camera = Camera::make(ours.model, input.size, ours.parameters);
  // Where points are seen brown5 is near enough to start from, in any model of its family.
  const NearestCamera near = nearest(*found, reach_of(*found, input.views[0]), false);
  auto start = Camera::make("brown5", input.size, near.parameters);
  if (!camera) return tl::unexpected<Error>(camera.error());
  if (!start) return tl::unexpected<Error>(start.error());
  std::string remark = fmt::format(
      "Tsai's own parameters: f {:.6g} px, kappa1 {:.6g} / px^2, sx {:.6g}; {} follows his "
      "distortion within {:.2g} px.",
      found->focal, found->kappa, found->sx, ours.model, ours.residual);
  return MethodResult{
      *std::move(camera), {found->camera_from_board}, {std::move(remark)}, *std::move(start)};
}

}  // namespace calvin
