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
#include "calvin/solve/linear/grid_kernels.hpp"
#include "calvin/solve/linear/scaled_solve.hpp"

namespace calvin {

namespace {

// Pixels of the grid, both borders included; projections vary smoothly between them.
constexpr int kGridWidth = 33;
constexpr int kGridHeight = 25;

// The derivatives of the projections at some pixels: by the estimated parameters, and by a rotation
// of the camera. A row for each pixel.
struct Cells {
  std::vector<Pixel> at;
  Eigen::MatrixXd u, v;
  Eigen::MatrixX3d u_turned, v_turned;

  Cells(std::size_t count, std::size_t columns)
      : u(count, columns), v(count, columns), u_turned(count, 3), v_turned(count, 3) {
    at.reserve(count);
  }
  void resize(Eigen::Index rows) {
    u.conservativeResize(rows, Eigen::NoChange);
    v.conservativeResize(rows, Eigen::NoChange);
    u_turned.conservativeResize(rows, Eigen::NoChange);
    v_turned.conservativeResize(rows, Eigen::NoChange);
  }
};

// Adds a pixel that has a ray.
template <typename M>
void add_cell(const Camera& camera, const std::vector<int>& columns, Pixel pixel, Cells& cells) {
  const auto ray = camera.unproject(pixel);
  if (!ray) return;
  double uv[2];
  double jp[6];
  double jq[2 * M::kCount];
  if (!M::project(camera.parameters().data(), camera.skew(), *ray, uv, jp, jq)) return;
  const auto row = static_cast<Eigen::Index>(cells.at.size());
  bool finite = true;
  const auto set = [&](auto& m, Eigen::Index column, double value) {
    m(row, column) = value;
    finite = finite && std::isfinite(value);
  };
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    const int k = columns[i];
    set(cells.u, column, k == kSkewColumn ? (uv[1] - camera.cy()) / camera.fy() : jq[k]);
    set(cells.v, column, k == kSkewColumn ? 0 : jq[M::kCount + k]);
  }
  const Eigen::Vector3d of_u = ray->cross(Eigen::Vector3d(jp[0], jp[1], jp[2]));
  const Eigen::Vector3d of_v = ray->cross(Eigen::Vector3d(jp[3], jp[4], jp[5]));
  for (int k = 0; k < 3; ++k) {
    set(cells.u_turned, k, of_u[k]);
    set(cells.v_turned, k, of_v[k]);
  }
  if (finite) cells.at.push_back(pixel);
}

Cells cells_at(const Camera& camera, const std::vector<int>& columns,
               const std::vector<Pixel>& pixels) {
  Cells cells(pixels.size(), columns.size());
  visit_model(camera.model(), [&]<typename M>() {
    for (const Pixel pixel : pixels) add_cell<M>(camera, columns, pixel, cells);
  });
  if (cells.at.size() < pixels.size()) cells.resize(static_cast<Eigen::Index>(cells.at.size()));
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

// The cells of the border and those of the picture within it.
Cells within(const std::vector<Pixel>& polygon, Cells border, const Cells& picture) {
  std::vector<Eigen::Index> rows;
  for (std::size_t i = 0; i < picture.at.size(); ++i) {
    if (!contains(polygon, picture.at[i])) continue;
    rows.push_back(static_cast<Eigen::Index>(i));
    border.at.push_back(picture.at[i]);
  }
  const Eigen::Index first = border.u.rows();
  border.resize(static_cast<Eigen::Index>(border.at.size()));
  const auto copy = [&](auto& to, const auto& from) {
    for (Eigen::Index c = 0; c < to.cols(); ++c) {
      double* column = to.col(c).data() + first;
      for (std::size_t i = 0; i < rows.size(); ++i) column[i] = from(rows[i], c);
    }
  };
  copy(border.u, picture.u);
  copy(border.v, picture.v);
  copy(border.u_turned, picture.u_turned);
  copy(border.v_turned, picture.v_turned);
  return border;
}

// The cells less the rotation that is the best for all of them. Empty where fewer than three.
PlacedGrid turned(Cells cells) {
  if (cells.at.size() < 3) return {};
  const std::size_t places = cells.at.size();
  const auto columns = static_cast<int>(cells.u.cols());
  // U^T u + V^T v, of the derivatives by the rotation and others.
  const auto sum = [&](const auto& u, const auto& v) {
    Eigen::MatrixXd products = Eigen::MatrixXd::Zero(3, u.cols());
    const auto count = static_cast<int>(u.cols());
    add_turn_products(cells.u_turned.data(), u.data(), places, count, products.data());
    add_turn_products(cells.v_turned.data(), v.data(), places, count, products.data());
    return products;
  };
  const auto turn = scaled_solve(sum(cells.u_turned, cells.v_turned), sum(cells.u, cells.v), 0);
  if (!turn) return {};
  subtract_turns(cells.u_turned.data(), turn->data(), places, columns, cells.u.data());
  subtract_turns(cells.v_turned.data(), turn->data(), places, columns, cells.v.data());
  return {std::move(cells.at), std::move(cells.u), std::move(cells.v)};
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
  Cells cells = cells_at(camera, columns, grid_of(camera.image_size()));
  ProjectionGrids grids;
  grids.covered = turned(within(covered, cells_at(camera, columns, covered), cells));
  grids.picture = turned(std::move(cells));
  if (grids.covered.at.empty()) grids.covered = grids.picture;
  return grids;
}

ProjectionGrid projection_grid(const Camera& camera, const std::vector<int>& columns) {
  const PlacedGrid all = turned(cells_at(camera, columns, grid_of(camera.image_size())));
  ProjectionGrid grid(all.at.size());
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    grid[i].resize(Eigen::NoChange, all.u.cols());
    grid[i] << all.u.row(row), all.v.row(row);
  }
  return grid;
}

double PlacedVariances::along(Eigen::Index place, const Eigen::Vector2d& direction) const {
  return direction[0] * direction[0] * uu[place] + 2 * direction[0] * direction[1] * uv[place] +
         direction[1] * direction[1] * vv[place];
}

double PlacedVariances::largest(Eigen::Index place) const {
  const double half = (uu[place] - vv[place]) / 2;
  return (uu[place] + vv[place]) / 2 + std::sqrt(half * half + uv[place] * uv[place]);
}

PlacedVariances variances(const PlacedGrid& grid, const Eigen::MatrixXd& covariance) {
  const Eigen::Index places = grid.u.rows();
  PlacedVariances of_places = {Eigen::VectorXd(places), Eigen::VectorXd(places),
                               Eigen::VectorXd(places)};
  project_covariance(grid.u.data(), grid.v.data(), static_cast<std::size_t>(places),
                     static_cast<int>(covariance.cols()), covariance.data(), of_places.uu.data(),
                     of_places.uv.data(), of_places.vv.data());
  return of_places;
}

}  // namespace calvin
