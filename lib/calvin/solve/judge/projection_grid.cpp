// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Derivatives of projections over a grid of pixels, the common rotation taken out.

#include "calvin/solve/judge/projection_grid.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Geometry>

#include "calvin/camera/models.hpp"
#include "calvin/geometry/convex_hull.hpp"
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
  Pixel at;
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
  cell.at = pixel;
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

using Cells = std::vector<Cell>;
using CellList = std::vector<const Cell*>;

Cells cells_at(const Camera& camera, const std::vector<int>& columns,
               const std::vector<Pixel>& pixels) {
  Cells cells;
  cells.reserve(pixels.size());
  visit_model(camera.model(), [&]<typename M>() {
    for (const Pixel pixel : pixels) {
      if (auto cell = cell_at<M>(camera, columns, pixel)) cells.push_back(std::move(*cell));
    }
  });
  return cells;
}

std::vector<Pixel> grid_of(ImageSize size) {
  std::vector<Pixel> pixels;
  pixels.reserve(static_cast<std::size_t>(kGridWidth) * kGridHeight);
  for (int y = 0; y < kGridHeight; ++y) {
    for (int x = 0; x < kGridWidth; ++x) {
      pixels.push_back(
          {x * (size.width - 1.0) / (kGridWidth - 1), y * (size.height - 1.0) / (kGridHeight - 1)});
    }
  }
  return pixels;
}

CellList pointers(const Cells& cells) {
  CellList list;
  list.reserve(cells.size());
  for (const Cell& cell : cells) list.push_back(&cell);
  return list;
}

// The cells less the rotation that is the best for all of them. Empty where fewer than three.
PlacedGrid turned(const CellList& cells) {
  if (cells.size() < 3) return {};
  const Eigen::Index n = cells.front()->parameters.cols();
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Matrix<double, 3, Eigen::Dynamic> cross =
      Eigen::Matrix<double, 3, Eigen::Dynamic>::Zero(3, n);
  for (const Cell* cell : cells) {
    normal += cell->rotation.transpose() * cell->rotation;
    cross += cell->rotation.transpose().lazyProduct(cell->parameters);
  }
  const auto turn = scaled_solve(normal, cross, 0);
  if (!turn) return {};
  PlacedGrid grid;
  grid.at.reserve(cells.size());
  grid.by.reserve(cells.size());
  for (const Cell* cell : cells) {
    grid.at.push_back(cell->at);
    grid.by.emplace_back(cell->parameters - cell->rotation.lazyProduct(*turn));
  }
  return grid;
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

ProjectionGrids projection_grids(const Camera& camera, const std::vector<int>& columns,
                                 const std::vector<Pixel>& covered) {
  const Cells cells = cells_at(camera, columns, grid_of(camera.image_size()));
  const Cells border = cells_at(camera, columns, covered);
  CellList within = pointers(border);
  for (const Cell& cell : cells) {
    if (contains(covered, cell.at)) within.push_back(&cell);
  }
  ProjectionGrids grids = {turned(pointers(cells)), turned(within)};
  if (grids.covered.by.empty()) grids.covered = grids.picture;
  return grids;
}

ProjectionGrid projection_grid(const Camera& camera, const std::vector<int>& columns) {
  return turned(pointers(cells_at(camera, columns, grid_of(camera.image_size())))).by;
}

double larger_eigenvalue(const Eigen::Matrix2d& m) {
  return (m(0, 0) + m(1, 1)) / 2 + std::hypot((m(0, 0) - m(1, 1)) / 2, (m(0, 1) + m(1, 0)) / 2);
}

}  // namespace calvin
