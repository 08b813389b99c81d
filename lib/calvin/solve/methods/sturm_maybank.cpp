// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The image of the absolute conic of a zooming camera, from homographies.

#include "calvin/solve/methods/sturm_maybank.hpp"

#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Core>

#include "calvin/geometry/symmetric.hpp"
#include "calvin/solve/methods/plane_views.hpp"

namespace calvin {

namespace {

using Vector4 = Eigen::Vector4d;

tl::unexpected<Error> no_sturm_maybank_camera(std::string why) {
  return make_error(ErrorCode::kDegenerate,
                    fmt::format("Sturm and Maybank's method finds no camera: {}.", why));
}

// One equation of a view: shared . (w11 w22 w13 w23) + own w33 = 0.
struct Equation {
  Vector4 shared = Vector4::Zero();
  double own = 0;
};

// h_i^T w h_j, with w12 = 0: the pixels are not oblique.
Equation columns_product(const Eigen::Matrix3d& h, int i, int j) {
  Equation e;
  e.shared << h(0, i) * h(0, j), h(1, i) * h(1, j), h(0, i) * h(2, j) + h(2, i) * h(0, j),
      h(1, i) * h(2, j) + h(2, i) * h(1, j);
  e.own = h(2, i) * h(2, j);
  return e;
}

// The two columns of the homography of a plane are images of directions that are orthogonal, and of
// one length.
struct ViewEquations {
  Equation orthogonal;
  Equation equal;

  explicit ViewEquations(const Eigen::Matrix3d& homography) {
    const double norm =
        homography.col(0).head<2>().squaredNorm() + homography.col(1).head<2>().squaredNorm();
    const Eigen::Matrix3d h = homography / std::sqrt(norm);
    orthogonal = columns_product(h, 0, 1);
    const Equation first = columns_product(h, 0, 0);
    const Equation second = columns_product(h, 1, 1);
    equal = {first.shared - second.shared, first.own - second.own};
  }
  // How much the view tells of its focal length: about half the squared sine of its tilt, over the
  // squared focal length in image widths.
  [[nodiscard]] double strength() const { return std::hypot(orthogonal.own, equal.own); }
  // What is left for the numbers that all views share.
  [[nodiscard]] Vector4 without_own() const {
    return (equal.own * orthogonal.shared - orthogonal.own * equal.shared) / strength();
  }
  [[nodiscard]] double own_number(const Vector4& shared) const {
    const double squares = strength() * strength();
    return -(orthogonal.own * orthogonal.shared.dot(shared) +
             equal.own * equal.shared.dot(shared)) /
           squares;
  }
};

// (w11 w22 w13 w23) with w11 = 1, by the numbers that are not known before.
struct Unknowns {
  Eigen::MatrixXd shared_from_unknown;  // 4 x count
  explicit Unknowns(const MethodInput& known) {
    std::vector<Vector4> columns;
    if (known.square) {
      columns.push_back(Vector4::Unit(0) + Vector4::Unit(1));
    } else {
      columns.push_back(Vector4::Unit(0));
      columns.push_back(Vector4::Unit(1));
    }
    if (!known.centered) {
      columns.push_back(Vector4::Unit(2));
      columns.push_back(Vector4::Unit(3));
    }
    shared_from_unknown.resize(4, static_cast<Eigen::Index>(columns.size()));
    for (std::size_t i = 0; i < columns.size(); ++i) {
      shared_from_unknown.col(static_cast<Eigen::Index>(i)) = columns[i];
    }
  }
};

Result<Vector4> shared_numbers(const std::vector<ViewEquations>& views, const MethodInput& known) {
  const Unknowns unknowns(known);
  const Eigen::Index count = unknowns.shared_from_unknown.cols();
  if (static_cast<Eigen::Index>(views.size()) < count - 1) {
    return no_sturm_maybank_camera(
        fmt::format("it takes {} views of a plane, {} given; fewer where the aspect and "
                    "the centre are known (--fix aspect,center)",
                    count - 1, views.size()));
  }
  Eigen::MatrixXd m = Eigen::MatrixXd::Zero(count, count);
  for (const ViewEquations& view : views) {
    const Eigen::VectorXd row = unknowns.shared_from_unknown.transpose() * view.without_own();
    m += row * row.transpose();
  }
  const auto eigen = symmetric_eigen(m);
  constexpr double kSingular = 1e-13;
  const bool open =
      count > 1 && !(eigen && eigen->values[1] > kSingular * eigen->values[count - 1]);
  if (!eigen || open) {
    return no_sturm_maybank_camera(
        "the views leave the principal point or the aspect open: tilt the plane to the left, to "
        "the "
        "right, up and down, or hold them (--fix aspect,center)");
  }
  Vector4 w = unknowns.shared_from_unknown * eigen->vectors.col(0);
  w /= w[0];
  if (!w.allFinite() || !(w[1] > 0)) {
    return no_sturm_maybank_camera(
        "no camera sees planes so: tilt them more, or hold the aspect and the centre (--fix "
        "aspect,center)");
  }
  return w;
}

}  // namespace

Result<ZoomingPinhole> sturm_maybank(const MethodInput& input) {
  // No noise is as small.
  constexpr double kParallel = 1e-9;
  const auto planes = plane_views(input, "Sturm and Maybank's method");
  if (!planes) return tl::unexpected<Error>(planes.error());
  std::vector<ViewEquations> views;
  for (std::size_t v = 0; v < planes->homographies.size(); ++v) {
    views.emplace_back(planes->homographies[v]);
    if (views.back().strength() > kParallel) continue;
    return no_sturm_maybank_camera(fmt::format(
        "the plane of view {} is parallel to the image, which tells no focal length: tilt it", v));
  }
  const auto w = shared_numbers(views, input);
  if (!w) return tl::unexpected<Error>(w.error());
  const double width = input.size.width;
  const Pixel middle = image_center(input.size);
  const double u0 = -(*w)[2];
  const double v0 = -(*w)[3] / (*w)[1];
  ZoomingPinhole found;
  found.center = {middle.u + width * u0, middle.v + width * v0};
  found.aspect = std::sqrt((*w)[1]);
  for (std::size_t v = 0; v < views.size(); ++v) {
    const double square = views[v].own_number(*w) - u0 * u0 - (*w)[1] * v0 * v0;
    const bool seen = square > 0 && std::isfinite(square);
    found.fx.push_back(seen ? std::optional(width * std::sqrt(square)) : std::nullopt);
  }
  return found;
}

Error no_focal_length(std::size_t view) {
  return no_sturm_maybank_camera(
             fmt::format("no lens sees the plane of view {} so: it is hardly tilted, or the lens "
                         "bends it too much; tilt it by 20 degrees and more",
                         view))
      .value();
}

}  // namespace calvin
