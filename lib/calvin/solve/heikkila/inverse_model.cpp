// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Linear least squares over a grid of the image, one way and the other.

#include "calvin/solve/heikkila/inverse_model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "calvin/geometry/dense.hpp"

namespace calvin {

namespace {

constexpr int kReweightings = 8;  // of linear least squares with the weights of the last one

// A place of the image: seen, and without distortion, in focal lengths.
struct Sample {
  Pixel pixel;
  Eigen::Vector2d seen;
  Eigen::Vector2d ideal;
};

Eigen::Vector2d in_focal_lengths(const InverseModel& m, Pixel p) {
  const double y = (p.v - m.cy) / m.fy;
  return {(p.u - m.cx - m.skew * y) / m.fx, y};
}

// What a distance in focal lengths is in px.
double in_px(const InverseModel& m, const Eigen::Vector2d& d) {
  return std::hypot(m.fx * d.x() + m.skew * d.y(), m.fy * d.y());
}

// Columns of tangential terms p1 and p2 of the point d: rows for x and y.
Eigen::Matrix2d tangential(const Eigen::Vector2d& d) {
  const double s = d.squaredNorm();
  const double product = 2 * d.x() * d.y();
  Eigen::Matrix2d m;
  m << product, s + 2 * d.x() * d.x(), s + 2 * d.y() * d.y(), product;
  return m;
}

// The denominator less 1.
double excess(const std::array<double, 8>& a, const Eigen::Vector2d& d) {
  const double s = d.squaredNorm();
  return (a[4] * s + a[5] * d.x() + a[6] * d.y() + a[7]) * s;
}

// Calls at(pixel) for a grid of so many cells, borders included.
template <typename At>
void over_image(ImageSize size, int columns, int rows, const At& at) {
  for (int j = 0; j <= rows; ++j) {
    for (int i = 0; i <= columns; ++i) {
      at(Pixel{(size.width - 1.0) * i / columns, (size.height - 1.0) * j / rows});
    }
  }
}

// Of columns of any scale; what the rows leave open is 0.
Eigen::VectorXd scaled_least_squares(const Eigen::MatrixXd& rows, const Eigen::VectorXd& right) {
  constexpr double kLeastPivot = 1e-9;
  const Eigen::VectorXd unit = rows.colwise().norm().cwiseMax(1e-300).cwiseInverse().transpose();
  return unit.cwiseProduct(least_squares(rows * unit.asDiagonal(), right, kLeastPivot).x.col(0));
}

// Where the camera has rays; absent where one of them is 80 degrees from the axis and more.
std::optional<std::vector<Sample>> samples_of(const Camera& camera, const InverseModel& frame,
                                              int columns, int rows) {
  constexpr double kLeastZ = 0.17;  // of a unit ray
  std::vector<Sample> samples;
  bool is_narrow = true;
  over_image(camera.image_size(), columns, rows, [&](Pixel pixel) {
    const auto ray = camera.unproject(pixel);
    if (!ray) return;
    is_narrow = is_narrow && ray->z() > kLeastZ;
    samples.push_back({pixel, in_focal_lengths(frame, pixel), ray->head<2>() / ray->z()});
  });
  if (!is_narrow || samples.size() < static_cast<std::size_t>(columns * rows) / 2) {
    return std::nullopt;
  }
  return samples;
}

// a1 to a8, or a1 to a4, by the weights of the last ones.
std::array<double, 8> fitted(const std::vector<Sample>& samples, const InverseModel& last,
                             Eigen::Index terms) {
  Eigen::MatrixXd rows(2 * static_cast<Eigen::Index>(samples.size()), terms);
  Eigen::VectorXd right(rows.rows());
  Eigen::Index row = 0;
  for (const Sample& p : samples) {
    const double weight = 1 / (1 + excess(last.a, p.seen));
    const double s = p.seen.squaredNorm();
    const Eigen::Vector2d px = weight * Eigen::Vector2d(last.fx, last.fy);
    Eigen::Matrix<double, 2, 8> by;
    by << p.seen * s, p.seen * s * s, tangential(p.seen), -p.ideal * s * s,
        -p.ideal * s * p.seen.x(), -p.ideal * s * p.seen.y(), -p.ideal * s;
    rows.middleRows<2>(row) = px.asDiagonal() * by.leftCols(terms);
    right.segment<2>(row) = px.cwiseProduct(p.ideal - p.seen);
    row += 2;
  }
  const Eigen::VectorXd found = scaled_least_squares(rows, right);
  std::array<double, 8> a{};
  std::copy(found.data(), found.data() + found.size(), a.begin());
  return a;
}

// Places that the inverse takes to, for the other way round.
Result<std::vector<Sample>> samples_of(const InverseModel& inverse, ImageSize size) {
  constexpr int kColumns = 48;
  constexpr int kRows = 36;
  std::vector<Sample> samples;
  bool folds = false;
  over_image(size, kColumns, kRows, [&](Pixel pixel) {
    const auto ideal = inverse.ideal(pixel);
    folds = folds || !ideal;
    if (ideal) samples.push_back({pixel, in_focal_lengths(inverse, pixel), *ideal});
  });
  if (!folds) return samples;
  return make_error(ErrorCode::kDegenerate,
                    "The inverse model has no value within the image, where its denominator is not "
                    "positive: check a5 to a8, which are in focal lengths, not in mm or px.");
}

// fx fy cx cy k1 k2 p1 p2 k3 that show the samples where they are seen.
std::vector<double> forward(const std::vector<Sample>& samples, const InverseModel& inverse) {
  Eigen::MatrixXd rows(2 * static_cast<Eigen::Index>(samples.size()), 5);
  Eigen::VectorXd right(rows.rows());
  Eigen::Index row = 0;
  for (const Sample& p : samples) {
    const double s = p.ideal.squaredNorm();
    Eigen::Matrix<double, 2, 5> by;
    by << p.ideal * s, p.ideal * s * s, tangential(p.ideal), p.ideal * s * s * s;
    const Eigen::Vector2d px(inverse.fx, inverse.fy);
    rows.middleRows<2>(row) = px.asDiagonal() * by;
    right.segment<2>(row) = px.cwiseProduct(p.seen - p.ideal);
    row += 2;
  }
  const Eigen::VectorXd k = scaled_least_squares(rows, right);
  std::vector<double> all = {inverse.fx, inverse.fy, inverse.cx, inverse.cy};
  all.insert(all.end(), k.data(), k.data() + k.size());
  return all;
}

}  // namespace

std::optional<Eigen::Vector2d> InverseModel::ideal(Pixel pixel) const noexcept {
  const Eigen::Vector2d d = in_focal_lengths(*this, pixel);
  const double s = d.squaredNorm();
  const double below = 1 + excess(a, d);
  if (!(below > 0)) return std::nullopt;
  const Eigen::Vector2d sideways = tangential(d) * Eigen::Vector2d(a[2], a[3]);
  return (d * (1 + (a[0] + a[1] * s) * s) + sideways) / below;
}

std::optional<FittedInverse> inverse_of(const Camera& camera, InverseTerms terms) {
  FittedInverse fit;
  fit.model = {camera.fx(), camera.fy(), camera.cx(), camera.cy(), camera.skew(), {}};
  const auto samples = samples_of(camera, fit.model, 40, 30);
  const auto between = samples_of(camera, fit.model, 57, 43);
  if (!samples || !between) return std::nullopt;
  const bool all = terms == InverseTerms::kEight;
  for (int i = 0; i < (all ? kReweightings : 1); ++i) {
    fit.model.a = fitted(*samples, fit.model, all ? 8 : 4);
  }
  for (const Sample& p : *between) {
    const auto at = fit.model.ideal(p.pixel);
    if (!at) return std::nullopt;
    fit.residual = std::max(fit.residual, in_px(fit.model, *at - p.ideal));
  }
  return fit;
}

Result<FittedCamera> camera_of(const InverseModel& inverse, ImageSize size) {
  const auto samples = samples_of(inverse, size);
  if (!samples) return tl::unexpected<Error>(samples.error());
  auto camera = Camera::make("brown5", size, forward(*samples, inverse), inverse.skew);
  if (!camera) return tl::unexpected<Error>(camera.error());
  FittedCamera fit = {*std::move(camera), 0};
  for (const Sample& p : *samples) {
    const auto at = fit.camera.project({p.ideal.x(), p.ideal.y(), 1});
    const double off = at ? std::hypot(at->u - p.pixel.u, at->v - p.pixel.v)
                          : std::numeric_limits<double>::infinity();
    fit.residual = std::max(fit.residual, off);
  }
  return fit;
}

}  // namespace calvin
