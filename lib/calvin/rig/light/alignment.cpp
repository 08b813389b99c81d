// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Umeyama's similarity, and how errors of cameras and places go through it.

#include "calvin/rig/light/alignment.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "calvin/geometry/dense.hpp"
#include "calvin/geometry/symmetric.hpp"

namespace calvin::rig {

namespace {

constexpr std::size_t kFramed = 3;  // places that give a frame
constexpr Eigen::Index kSimilarity = 7;

Eigen::Vector3d mean_of(const std::vector<Eigen::Vector3d>& points) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : points) sum += p;
  return sum / static_cast<double>(points.size());
}

// Two lists of the same points in two frames, about their means.
struct Clouds {
  std::vector<Eigen::Vector3d> rig;
  std::vector<Eigen::Vector3d> world;
  Eigen::Vector3d rig_mean;
  Eigen::Vector3d world_mean;

  [[nodiscard]] Eigen::Matrix3d product() const {
    Eigen::Matrix3d h = Eigen::Matrix3d::Zero();
    for (std::size_t i = 0; i < rig.size(); ++i) h += world[i] * rig[i].transpose();
    return h;
  }
};

Clouds clouds_of(const std::vector<SE3>& rig_from_camera, const std::vector<KnownPlace>& places) {
  Clouds clouds;
  for (const KnownPlace& known : places) {
    clouds.rig.push_back(rig_from_camera[known.camera].translation);
    clouds.world.push_back(known.place);
  }
  clouds.rig_mean = mean_of(clouds.rig);
  clouds.world_mean = mean_of(clouds.world);
  for (Eigen::Vector3d& p : clouds.rig) p -= clouds.rig_mean;
  for (Eigen::Vector3d& p : clouds.world) p -= clouds.world_mean;
  return clouds;
}

struct TurnedFit {
  double scale = 1;
  double squares = 0;  // m^2, what is left
};

TurnedFit fit_with(const Clouds& clouds, const Eigen::Matrix3d& turn) {
  double along = 0;
  double length = 0;
  for (std::size_t i = 0; i < clouds.rig.size(); ++i) {
    along += clouds.world[i].dot(turn * clouds.rig[i]);
    length += clouds.rig[i].squaredNorm();
  }
  TurnedFit fit{along / length, 0};
  for (std::size_t i = 0; i < clouds.rig.size(); ++i) {
    fit.squares += (clouds.world[i] - fit.scale * (turn * clouds.rig[i])).squaredNorm();
  }
  return fit;
}

bool on_a_line(const std::vector<Eigen::Vector3d>& points) {
  constexpr double kThin = 1e-4;  // squared, of the length
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& p : points) scatter += p * p.transpose();
  const auto eigen = symmetric_eigen(scatter);
  return !eigen || !(eigen->values[1] > kThin * eigen->values[2]);
}

tl::unexpected<Error> collinear() {
  return make_error(ErrorCode::kDegenerate,
                    "The known places of the cameras lie on one line or at one point, so that the "
                    "rig may turn about it: give one that is beside it, or two of them alone for "
                    "the unit.");
}

tl::unexpected<Error> mirrored() {
  return make_error(ErrorCode::kInvalidArgument,
                    "The known places of the cameras fit when they are mirrored, and not as they "
                    "are: their axes are left-handed. Turn the sign of one axis, as of y.");
}

Result<Alignment> by_frame(const Clouds& clouds, bool has_unit) {
  constexpr double kBetter = 0.2;  // of what is left, in length
  constexpr double kPoor = 0.03;   // of the size of the rig
  if (on_a_line(clouds.world) || on_a_line(clouds.rig)) return collinear();
  const Eigen::Matrix3d product = clouds.product();
  const Eigen::Matrix3d turn = closest_rotation(product);
  const TurnedFit fit = fit_with(clouds, turn);
  const TurnedFit mirror = fit_with(clouds, -closest_rotation(-product));
  double size = 0;
  for (const Eigen::Vector3d& p : clouds.world) size += p.squaredNorm();
  if (fit.squares > kPoor * kPoor * size && mirror.squares < kBetter * kBetter * fit.squares) {
    return mirrored();
  }
  Alignment result;
  const auto count = static_cast<double>(clouds.rig.size());
  result.is_framed = true;
  const double scale = has_unit ? 1 : fit.scale;
  double squares = fit.squares;
  if (has_unit) {
    const double numbers = std::max(1.0, 3 * count - static_cast<double>(kSimilarity));
    result.scale_by_places = {fit.scale, std::sqrt(fit.squares / numbers / size)};
    squares = 0;
    for (std::size_t i = 0; i < clouds.rig.size(); ++i) {
      squares += (clouds.world[i] - turn * clouds.rig[i]).squaredNorm();
    }
  }
  result.world_from_rig = {scale, {turn, clouds.world_mean - scale * (turn * clouds.rig_mean)}};
  result.rms = std::sqrt(squares / count);
  return result;
}

// How the errors of all cameras change with the similarity: a turn about `center`, a shift, growth.
Eigen::MatrixXd by_similarity(Eigen::Index count, const std::vector<Eigen::Index>& first,
                              const std::vector<SE3>& world_from_camera,
                              const Eigen::Vector3d& center) {
  Eigen::MatrixXd by = Eigen::MatrixXd::Zero(count, kSimilarity);
  for (std::size_t c = 0; c < first.size(); ++c) {
    const Eigen::Vector3d arm = world_from_camera[c].translation - center;
    by.block<3, 3>(first[c], 0).setIdentity();
    by.block<3, 3>(first[c] + 3, 0) << 0, arm.z(), -arm.y(), -arm.z(), 0, arm.x(), arm.y(),
        -arm.x(), 0;
    by.block<3, 3>(first[c] + 3, 3).setIdentity();
    by.block<3, 1>(first[c] + 3, 6) = arm;
  }
  return by;
}

// Of a rig that has its unit: places that are as much larger as another unit makes them are in that
// one, and not in metres.
Result<Alignment> in_metres(Alignment alignment) {
  constexpr double kNear = 0.1;  // of the factor: a wand is measured better than that
  struct Unit {
    double per_metre;
    const char* name;
  };
  constexpr Unit kUnits[] = {{1000, "millimetres"}, {100, "centimetres"}, {1 / 0.0254, "inches"}};
  const double scale = alignment.scale_by_places ? alignment.scale_by_places->scale : 1;
  for (const Unit& unit : kUnits) {
    if (std::abs(scale / unit.per_metre - 1) > kNear) continue;
    return make_error(
        ErrorCode::kInvalidArgument,
        fmt::format("The known places of the cameras are {:.4g} times as far apart as "
                    "the wand says: they are in {}. Give them in metres.",
                    scale, unit.name));
  }
  return alignment;
}

Result<Alignment> by_length(const Clouds& clouds, double length, bool has_unit,
                            double length_sigma) {
  const double own = (clouds.rig[1] - clouds.rig[0]).norm();
  if (!(length > 0) || !(own > 0)) return collinear();
  Alignment result;
  result.length_sigma = length_sigma;
  if (has_unit) {
    result.scale_by_places = {length / own, length_sigma / own};
  } else {
    result.world_from_rig.scale = length / own;
  }
  return result;
}

}  // namespace

Result<Alignment> align(const std::vector<SE3>& rig_from_camera,
                        const std::vector<KnownPlace>& places, bool has_unit, double length_sigma) {
  const Clouds clouds = clouds_of(rig_from_camera, places);
  auto alignment =
      places.size() >= kFramed
          ? by_frame(clouds, has_unit)
          : by_length(clouds, (places[1].place - places[0].place).norm(), has_unit, length_sigma);
  if (!alignment) return alignment;
  return in_metres(*std::move(alignment));
}

Eigen::MatrixXd covariance_by_places(const Eigen::MatrixXd& covariance,
                                     const std::vector<Eigen::Index>& first,
                                     const std::vector<SE3>& world_from_camera,
                                     const std::vector<KnownPlace>& places,
                                     const Alignment& alignment) {
  const Eigen::Index count = covariance.rows();
  const auto known = static_cast<Eigen::Index>(places.size());
  // What the known places see of an error: their own coordinates, or the distance of two alone.
  Eigen::MatrixXd seen = Eigen::MatrixXd::Zero(alignment.is_framed ? 3 * known : 1, count);
  Eigen::MatrixXd by =
      by_similarity(count, first, world_from_camera, world_from_camera.front().translation);
  if (alignment.is_framed) {
    for (Eigen::Index k = 0; k < known; ++k) {
      const std::size_t camera = places[static_cast<std::size_t>(k)].camera;
      seen.block<3, 3>(3 * k, first[camera] + 3).setIdentity();
    }
  } else {
    const Eigen::Vector3d along = (world_from_camera[places[1].camera].translation -
                                   world_from_camera[places[0].camera].translation)
                                      .normalized();
    seen.block<1, 3>(0, first[places[1].camera] + 3) += along.transpose();
    seen.block<1, 3>(0, first[places[0].camera] + 3) -= along.transpose();
    by = by.rightCols<1>().eval();
  }
  // A rig that has its unit does not grow.
  if (alignment.scale_by_places) by = by.leftCols<kSimilarity - 1>().eval();
  const auto freedom = by.cols();
  // The similarity takes back what the known places see: a = -(D^T D)^-1 D^T (S e - e_known).
  const Eigen::MatrixXd moved = seen * by;
  const Eigen::MatrixXd inverse = solve_symmetric(
      moved.transpose() * moved, Eigen::MatrixXd::Identity(moved.cols(), moved.cols()));
  const Eigen::MatrixXd kept =
      Eigen::MatrixXd::Identity(count, count) - by * (inverse * (moved.transpose() * seen));
  const Eigen::MatrixXd of_rig = kept * covariance * kept.transpose();
  // m^2, of the known places
  double variance = alignment.length_sigma * alignment.length_sigma;
  if (alignment.rms && 3 * known > freedom) {
    const double expected = (seen * of_rig * seen.transpose()).trace();
    const double left = static_cast<double>(known) * *alignment.rms * *alignment.rms;
    variance = std::max(0.0, left - expected) / static_cast<double>(3 * known - freedom);
  }
  return of_rig + variance * (by * inverse * by.transpose());
}

}  // namespace calvin::rig
