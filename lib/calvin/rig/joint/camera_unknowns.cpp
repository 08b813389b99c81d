// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The table of cameras, its values and their covariance.

#include "calvin/rig/joint/camera_unknowns.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include <Eigen/Cholesky>

namespace calvin::rig {

namespace {

std::vector<TableCamera> table_cameras(const std::vector<Camera>& cameras) {
  std::vector<TableCamera> all;
  for (const Camera& camera : cameras) {
    TableCamera one;
    one.model = camera.model();
    one.skew = camera.skew();
    one.has_rig_pose = !all.empty();
    all.push_back(std::move(one));
  }
  return all;
}

}  // namespace

ParameterTable table_of(const std::vector<Camera>& cameras, const BoardUnknowns& board) {
  return ParameterTable(table_cameras(cameras), {board});
}

ParameterTable table_of_places(const std::vector<Camera>& cameras) {
  std::vector<TableCamera> all = table_cameras(cameras);
  for (std::size_t c = 0; c < all.size(); ++c) all[c].known = cameras[c].parameters();
  return ParameterTable(std::move(all), {BoardUnknowns()});
}

ParameterTable with_held_intrinsics(ParameterTable table, const std::vector<double>& values) {
  for (std::size_t c = 0; c < table.cameras(); ++c) {
    const ParameterRange range = table.intrinsics(c);
    for (int i = range.first; i < range.end(); ++i) {
      table.hold(i, values[static_cast<std::size_t>(i)]);
    }
  }
  return table;
}

std::vector<double> values_of_cameras(const ParameterTable& table,
                                      const std::vector<Camera>& cameras) {
  std::vector<double> values(static_cast<std::size_t>(table.count()), 0.0);
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    const ParameterRange range = table.intrinsics(c);
    if (range.empty()) continue;
    std::ranges::copy(cameras[c].parameters(), values.begin() + range.first);
  }
  return values;
}

Eigen::MatrixXd covariance_of_intrinsics(const ParameterTable& table,
                                         const std::vector<RigCameraViews>& calibrations) {
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(table.count(), table.count());
  for (std::size_t c = 0; c < calibrations.size(); ++c) {
    const Calibration& calibration = calibrations[c].calibration;
    std::vector<std::optional<int>> unknowns;
    for (const Parameter& p : calibration.parameters) {
      if (p.sigma) unknowns.push_back(table.find(p.name, c));
    }
    const std::size_t size = unknowns.size();
    if (calibration.covariance.size() != size * size) continue;
    for (std::size_t i = 0; i < size; ++i) {
      for (std::size_t j = 0; j < size; ++j) {
        if (!unknowns[i] || !unknowns[j]) continue;
        all(*unknowns[i], *unknowns[j]) = calibration.covariance[i * size + j];
      }
    }
  }
  return all;
}

std::optional<PlaceCovariance> covariance_of_places(const Eigen::MatrixXd& information,
                                                    const ParameterRange& places, double variance,
                                                    const Eigen::MatrixXd& of_intrinsics) {
  const Eigen::Index first = places.first;
  const Eigen::Index count = places.count;
  const Eigen::MatrixXd own = information.block(first, first, count, count);
  const Eigen::LDLT<Eigen::MatrixXd> factors(own);
  if (factors.info() != Eigen::Success || !factors.isPositive()) return std::nullopt;
  const Eigen::MatrixXd inverse = factors.solve(Eigen::MatrixXd::Identity(count, count));
  const Eigen::MatrixXd moved = factors.solve(information.block(first, 0, count, first));
  PlaceCovariance covariance;
  covariance.of_intrinsics = of_intrinsics.topLeftCorner(first, first);
  covariance.with_intrinsics = -moved * covariance.of_intrinsics;
  covariance.of_places = variance * inverse - covariance.with_intrinsics * moved.transpose();
  return covariance;
}

}  // namespace calvin::rig
