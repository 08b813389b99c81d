// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Derivatives of projections over a grid of pixels, the common rotation taken out.

#include "calvin/solve/judge/projection_grid.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Geometry>

#include "calvin/camera/models.hpp"
#include "calvin/solve/linear/scaled_solve.hpp"

namespace calvin {

namespace {

// Pixels of the grid, both borders included; projections vary smoothly between them.
constexpr int kGridWidth = 33;
constexpr int kGridHeight = 25;

using Jacobian = ProjectionGrid::value_type;

// The derivatives of one pixel's projection: by the estimated parameters, and by a rotation of the
// camera.
struct Cell {
  Jacobian parameters;
  Eigen::Matrix<double, 2, 3> rotation;
};

template <typename M>
std::optional<Cell> cell_at(const Camera& camera, const std::vector<int>& columns, Pixel pixel) {
  const auto ray = camera.unproject(pixel);
  if (!ray) return std::nullopt;
  double uv[2];
  double jp[6];
  double jq[2 * M::kCount];
  if (!M::project(camera.parameters().data(), camera.skew(), *ray, uv, jp, jq)) {
    return std::nullopt;
  }
  Cell cell;
  cell.parameters.resize(Eigen::NoChange, static_cast<Eigen::Index>(columns.size()));
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    const int k = columns[i];
    cell.parameters(0, column) = k == kSkewColumn ? (uv[1] - camera.cy()) / camera.fy() : jq[k];
    cell.parameters(1, column) = k == kSkewColumn ? 0 : jq[M::kCount + k];
  }
  for (int row = 0; row < 2; ++row) {
    const Eigen::Vector3d g(jp[3 * row], jp[3 * row + 1], jp[3 * row + 2]);
    cell.rotation.row(row) = ray->cross(g).transpose();
  }
  if (!cell.parameters.allFinite() || !cell.rotation.allFinite()) return std::nullopt;
  return cell;
}

template <typename M>
std::vector<Cell> grid_of(const Camera& camera, const std::vector<int>& columns) {
  std::vector<Cell> cells;
  for (int y = 0; y < kGridHeight; ++y) {
    for (int x = 0; x < kGridWidth; ++x) {
      const Pixel pixel = {x * (camera.image_size().width - 1.0) / (kGridWidth - 1),
                           y * (camera.image_size().height - 1.0) / (kGridHeight - 1)};
      if (auto cell = cell_at<M>(camera, columns, pixel)) cells.push_back(std::move(*cell));
    }
  }
  return cells;
}

}  // namespace

std::optional<std::vector<int>> estimated_columns(const Calibration& calibration) {
  const auto names = parameter_names(calibration.model);
  std::vector<int> columns;
  for (const Parameter& p : calibration.parameters) {
    if (!p.sigma) continue;
    const auto at = std::find(names.begin(), names.end(), p.name);
    if (at == names.end() && p.name != "skew") return std::nullopt;
    columns.push_back(at == names.end() ? kSkewColumn : static_cast<int>(at - names.begin()));
  }
  return columns;
}

ProjectionGrid projection_grid(const Camera& camera, const std::vector<int>& columns) {
  std::vector<Cell> cells;
  visit_model(camera.model(), [&]<typename M>() { cells = grid_of<M>(camera, columns); });
  if (cells.size() < 3) return {};
  const auto n = static_cast<Eigen::Index>(columns.size());
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Matrix<double, 3, Eigen::Dynamic> cross =
      Eigen::Matrix<double, 3, Eigen::Dynamic>::Zero(3, n);
  for (const Cell& cell : cells) {
    normal += cell.rotation.transpose() * cell.rotation;
    cross += cell.rotation.transpose().lazyProduct(cell.parameters);
  }
  const auto turn = scaled_solve(normal, cross, 0);
  if (!turn) return {};
  ProjectionGrid grid;
  grid.reserve(cells.size());
  for (const Cell& cell : cells)
    grid.emplace_back(cell.parameters - cell.rotation.lazyProduct(*turn));
  return grid;
}

double larger_eigenvalue(const Eigen::Matrix2d& m) {
  return (m(0, 0) + m(1, 1)) / 2 + std::hypot((m(0, 0) - m(1, 1)) / 2, (m(0, 1) + m(1, 0)) / 2);
}

}  // namespace calvin
