// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The least squares of homographies, centre and radial factor, first about the centre of the image.

#include "calvin/solve/methods/radial_planes.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include <fmt/format.h>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include "calvin/geometry/dense.hpp"
#include "calvin/solve/linear/dense_problem.hpp"
#include "calvin/solve/linear/lm.hpp"
#include "calvin/solve/linear/scaled_solve.hpp"

namespace calvin {

namespace {

constexpr int kOfHomography = 8;  // its last number is 1

tl::unexpected<Error> no_distortion(std::string why) {
  return make_error(ErrorCode::kDegenerate,
                    fmt::format("The method discorpy finds no distortion: {}.", why));
}

// The points of a view in its plane, shifted and scaled to numbers about 1.
struct FlatView {
  std::vector<Eigen::Vector3d> points;  // x, y, 1
  std::vector<Eigen::Vector2d> seen;    // px
  std::vector<double> weight;
  Eigen::Matrix3d unit_from_plane;
};

FlatView flat_view(const PointSet& view) {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const Eigen::Vector3d& p : view.points) mean += p.head<2>();
  mean /= static_cast<double>(view.size());
  double square = 0;
  for (const Eigen::Vector3d& p : view.points) square += (p.head<2>() - mean).squaredNorm();
  const double scale = 1 / std::sqrt(square / static_cast<double>(view.size()));
  FlatView flat;
  flat.unit_from_plane << scale, 0, -scale * mean.x(), 0, scale, -scale * mean.y(), 0, 0, 1;
  for (std::size_t i = 0; i < view.size(); ++i) {
    flat.points.push_back(flat.unit_from_plane * view.points[i].head<2>().homogeneous());
    flat.seen.emplace_back(view.uv[i].u, view.uv[i].v);
  }
  flat.weight = view.weight;
  return flat;
}

// What the radial factor is at s = |q|^2, its slope by s, and its derivatives by k.
struct Factor {
  double value = 1;
  double slope = 0;
  Eigen::VectorXd by_k;
};

Factor factor_at(double s, const Eigen::Ref<const Eigen::VectorXd>& k, const RadialModel& model) {
  double above = 1;
  double below = 1;
  double above_slope = 0;
  double below_slope = 0;
  Factor f;
  f.by_k.resize(k.size());
  double power = 1;  // s^i
  for (int i = 0; i < model.terms; ++i) {
    above_slope += (i + 1) * k[i] * power;
    if (model.rational) below_slope += (i + 1) * k[model.terms + i] * power;
    power *= s;
    above += k[i] * power;
    f.by_k[i] = power;
    if (!model.rational) continue;
    below += k[model.terms + i] * power;
    f.by_k[model.terms + i] = power;
  }
  f.value = above / below;
  f.slope = (above_slope - f.value * below_slope) / below;
  f.by_k.head(model.terms) /= below;
  if (model.rational) f.by_k.tail(model.terms) *= -f.value / below;
  return f;
}

// For minimise(). Unknown are the centre unless it is held, k, and eight numbers of each
// homography.
class RadialProblem : public DenseProblem<RadialProblem> {
 public:
  RadialProblem(std::vector<FlatView>& views, const RadialPlanes& from, ImageSize size,
                const RadialModel& model)
      : views_(views),
        model_(model),
        width_(size.width),
        held_(from.center.u, from.center.v),
        k_at_(model.centered ? 0 : 2),
        first_(k_at_ + model.count()) {
    current_.x.resize(first_ + kOfHomography * static_cast<Eigen::Index>(views.size()));
    if (!model.centered) current_.x.head<2>() = held_;
    for (int i = 0; i < model.count(); ++i) {
      current_.x[k_at_ + i] = from.k[static_cast<std::size_t>(i)];
    }
    for (std::size_t v = 0; v < views.size(); ++v) {
      const Eigen::Matrix3d h = from.homographies[v] / from.homographies[v](2, 2);
      for (int i = 0; i < kOfHomography; ++i) current_.x[of_view(v) + i] = h(i / 3, i % 3);
    }
  }

  [[nodiscard]] RadialPlanes result() const {
    RadialPlanes planes;
    const Eigen::Vector2d c = center(current_);
    planes.center = {c.x(), c.y()};
    for (int i = 0; i < model_.count(); ++i) planes.k.push_back(current_.x[k_at_ + i]);
    for (std::size_t v = 0; v < views_.size(); ++v) planes.homographies.push_back(h(current_, v));
    return planes;
  }

  // Of centre and k. Absent where points do not tell them.
  [[nodiscard]] std::optional<Eigen::MatrixXd> covariance() const {
    double points = 0;
    for (const FlatView& view : views_) {
      points += static_cast<double>(
          std::ranges::count_if(view.weight, [](double weight) { return weight > 0; }));
    }
    const Eigen::Index n = current_.x.size();
    const double freedom = 2 * points - static_cast<double>(n);
    const auto inverse =
        scaled_solve(current_.normal, Eigen::MatrixXd::Identity(n, n), kLeastPivot);
    if (!inverse || !(freedom > 0)) return std::nullopt;
    return Eigen::MatrixXd(current_.cost / freedom * inverse->topLeftCorner(first_, first_));
  }

  // How far a point is from where it is seen, in its sigmas.
  [[nodiscard]] double distance(std::size_t view, std::size_t point) const {
    const FlatView& v = views_[view];
    return v.weight[point] * residual(current_, view, point, nullptr).norm();
  }

 private:
  friend DenseProblem;

  struct Rows {
    Eigen::MatrixXd shared;  // by centre and k
    Eigen::Matrix<double, 2, kOfHomography> view;
  };

  [[nodiscard]] Eigen::Index of_view(std::size_t v) const {
    return first_ + kOfHomography * static_cast<Eigen::Index>(v);
  }
  [[nodiscard]] Eigen::Vector2d center(const NormalEquations& now) const {
    return model_.centered ? held_ : Eigen::Vector2d(now.x.head<2>());
  }
  [[nodiscard]] Eigen::Matrix3d h(const NormalEquations& now, std::size_t v) const {
    Eigen::Matrix3d m;
    for (int i = 0; i < kOfHomography; ++i) m(i / 3, i % 3) = now.x[of_view(v) + i];
    m(2, 2) = 1;
    return m;
  }

  // px; not finite where the point is behind the camera.
  [[nodiscard]] Eigen::Vector2d residual(const NormalEquations& now, std::size_t v, std::size_t i,
                                         Rows* rows) const {
    const Eigen::Vector3d& p = views_[v].points[i];
    const Eigen::Vector3d ray = h(now, v) * p;
    const Eigen::Vector2d q = ray.head<2>() / (ray.z() > 0 ? ray.z() : std::nan(""));
    const Factor f = factor_at(q.squaredNorm(), now.x.segment(k_at_, model_.count()), model_);
    if (rows != nullptr) {
      const Eigen::Matrix2d by_q =
          width_ * (f.value * Eigen::Matrix2d::Identity() + 2 * f.slope * q * q.transpose());
      rows->shared.leftCols(k_at_).setIdentity();
      rows->shared.rightCols(model_.count()) = width_ * q * f.by_k.transpose();
      rows->view.leftCols<3>() = by_q.col(0) * p.transpose() / ray.z();
      rows->view.middleCols<3>(3) = by_q.col(1) * p.transpose() / ray.z();
      rows->view.rightCols<2>() = -by_q * q * p.head<2>().transpose() / ray.z();
    }
    return center(now) + width_ * f.value * q - views_[v].seen[i];
  }

  bool linearise(NormalEquations& now) const {
    const Eigen::Index n = now.x.size();
    now.normal.setZero(n, n);
    now.gradient.setZero(n);
    now.cost = 0;
    Rows rows = {Eigen::MatrixXd(2, first_), {}};
    for (std::size_t v = 0; v < views_.size(); ++v) {
      const Eigen::Index at = of_view(v);
      for (std::size_t i = 0; i < views_[v].points.size(); ++i) {
        const double weight = std::pow(views_[v].weight[i], 2);
        if (!(weight > 0)) continue;
        const Eigen::Vector2d r = residual(now, v, i, &rows);
        now.normal.topLeftCorner(first_, first_) += weight * rows.shared.transpose() * rows.shared;
        now.normal.block(at, 0, kOfHomography, first_) +=
            weight * rows.view.transpose() * rows.shared;
        now.normal.block<kOfHomography, kOfHomography>(at, at) +=
            weight * rows.view.transpose() * rows.view;
        now.gradient.head(first_) += weight * rows.shared.transpose() * r;
        now.gradient.segment<kOfHomography>(at) += weight * rows.view.transpose() * r;
        now.cost += weight * r.squaredNorm();
      }
    }
    now.normal.triangularView<Eigen::StrictlyUpper>() = now.normal.transpose();
    return std::isfinite(now.cost) && now.normal.allFinite();
  }

  const std::vector<FlatView>& views_;
  RadialModel model_;
  double width_;  // px
  Eigen::Vector2d held_;
  Eigen::Index k_at_;
  Eigen::Index first_;  // the number of centre and k
};

// Leaves out points that are far from where they are seen; returns how many.
int leave_out(std::vector<FlatView>& views, const RadialProblem& problem, RadialPlanes& planes) {
  constexpr double kFar = 5.1;  // of the median, which is 1.18 sigmas of a coordinate
  constexpr double kRounding = 1e-3;
  std::vector<double> all;
  for (std::size_t v = 0; v < views.size(); ++v) {
    for (std::size_t i = 0; i < views[v].points.size(); ++i) {
      if (views[v].weight[i] > 0) all.push_back(problem.distance(v, i));
    }
  }
  const auto middle = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
  std::ranges::nth_element(all, middle);
  const double most = std::max(kFar * *middle, kRounding);
  int count = 0;
  for (std::size_t v = 0; v < views.size(); ++v) {
    for (std::size_t i = 0; i < views[v].points.size(); ++i) {
      if (!(views[v].weight[i] > 0) || !(problem.distance(v, i) > most)) continue;
      views[v].weight[i] = 0;
      planes.left_out.emplace_back(v, i);
      ++count;
    }
  }
  return count;
}

// One fit, from `planes`, which it becomes. False where it has no start.
bool improve(std::vector<FlatView>& views, ImageSize size, const RadialModel& model,
             RadialPlanes& planes, std::optional<RadialProblem>& problem) {
  problem.emplace(views, planes, size, model);
  if (!problem->begin()) return false;
  (void)minimise(*problem, LmOptions{}, {});
  RadialPlanes better = problem->result();
  better.left_out = std::move(planes.left_out);
  planes = std::move(better);
  return true;
}

}  // namespace

RadialFit fit_radii(std::span<const SeenRadius> radii, const RadialModel& model) {
  const Eigen::Index count = model.count();
  Eigen::MatrixXd rows(static_cast<Eigen::Index>(radii.size()), count);
  Eigen::VectorXd right(rows.rows());
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    const SeenRadius& r = radii[static_cast<std::size_t>(i)];
    double power = 1;
    for (int k = 0; k < model.terms; ++k) {
      power *= r.ideal * r.ideal;
      rows(i, k) = r.ideal * power;
      if (model.rational) rows(i, model.terms + k) = -r.seen * power;
    }
    right[i] = r.seen - r.ideal;
  }
  const Eigen::VectorXd unit = rows.colwise().norm().cwiseInverse().transpose();
  const Eigen::VectorXd k =
      unit.cwiseProduct(least_squares(rows * unit.asDiagonal(), right).x.col(0));
  RadialFit fit = {{k.data(), k.data() + k.size()}, 0};
  for (const SeenRadius& r : radii) {
    const double at = r.ideal * factor_at(r.ideal * r.ideal, k, model).value;
    fit.residual = std::max(fit.residual, std::abs(at - r.seen));
  }
  return fit;
}

Result<RadialPlanes> fit_radial_planes(std::span<const PointSet> views,
                                       std::span<const Eigen::Matrix3d> start, ImageSize size,
                                       const RadialModel& model, bool reject_outliers) {
  constexpr int kRounds = 4;  // of outliers
  std::vector<FlatView> flat;
  RadialPlanes planes;
  planes.center = image_center(size);
  planes.k.assign(static_cast<std::size_t>(model.count()), 0);
  for (std::size_t v = 0; v < views.size(); ++v) {
    flat.push_back(flat_view(views[v]));
    planes.homographies.push_back(start[v] * flat.back().unit_from_plane.inverse());
  }
  RadialModel held = model;
  held.centered = true;
  std::optional<RadialProblem> problem;
  bool found = improve(flat, size, held, planes, problem);
  for (int i = 0; found && i < kRounds; ++i) {
    found = improve(flat, size, model, planes, problem);
    if (found && (!reject_outliers || leave_out(flat, *problem, planes) == 0)) break;
  }
  if (!found) return no_distortion("a plane has no place before the camera");
  const auto covariance = problem->covariance();
  if (!covariance) {
    return no_distortion(
        "there are too few points, or the lens bends lines too little to tell about which centre: "
        "give more points, fix the center or take a model with fewer coefficients");
  }
  planes.covariance = *covariance;
  for (std::size_t v = 0; v < views.size(); ++v) {
    planes.homographies[v] = planes.homographies[v] * flat[v].unit_from_plane;
  }
  return planes;
}

}  // namespace calvin
