// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Derivatives of projections over a grid of pixels, the common rotation taken out.

#include "calvin/solve/judge/projection_grid.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "calvin/geometry/convex_hull.hpp"
#include "calvin/solve/linear/grid_kernels.hpp"
#include "calvin/solve/linear/scaled_solve.hpp"
#include "calvin/solve/residuals/grid_rays.hpp"

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

// Leaves out the cells that are not numbers.
void drop_undefined(Cells& cells) {
  // One that is no number makes none of the sum.
  if (std::isfinite(cells.u.sum() + cells.v.sum() + cells.u_turned.sum() + cells.v_turned.sum())) {
    return;
  }
  Eigen::Index kept = 0;
  for (Eigen::Index i = 0; i < cells.u.rows(); ++i) {
    if (!cells.u.row(i).allFinite() || !cells.v.row(i).allFinite() ||
        !cells.u_turned.row(i).allFinite() || !cells.v_turned.row(i).allFinite()) {
      continue;
    }
    cells.u.row(kept) = cells.u.row(i);
    cells.v.row(kept) = cells.v.row(i);
    cells.u_turned.row(kept) = cells.u_turned.row(i);
    cells.v_turned.row(kept) = cells.v_turned.row(i);
    cells.at[static_cast<std::size_t>(kept++)] = cells.at[static_cast<std::size_t>(i)];
  }
  cells.at.resize(static_cast<std::size_t>(kept));
  cells.resize(kept);
}

// The pixels whose rays have a projection, as nearly all that were found have.
PixelRays seen_again(const Camera& camera, const PixelRays& found) {
  PixelRays seen;
  for (std::size_t i = 0; i < found.at.size(); ++i) {
    if (!camera.project(found.rays[i])) continue;
    seen.at.push_back(found.at[i]);
    seen.rays.push_back(found.rays[i]);
  }
  return seen;
}

// Copies the derivatives along a few rays to the cells from `first` on.
void copy_cells(ViewRows& rows, const std::vector<int>& columns, Eigen::Index first,
                Eigen::Index count, Cells& cells) {
  const auto copy = [&](int from, Eigen::Index column, auto& u, auto& v) {
    std::copy_n(rows.u(from), count, &u(first, column));
    std::copy_n(rows.v(from), count, &v(first, column));
  };
  const int skew = rows.layout().camera.skew().first;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    copy(RowLayout::kFirstShared + (columns[i] == kSkewColumn ? skew : columns[i]),
         static_cast<Eigen::Index>(i), cells.u, cells.v);
  }
  for (int k = 0; k < 3; ++k) copy(k, k, cells.u_turned, cells.v_turned);  // a pose turns first
}

Cells cells_of(const Camera& camera, const std::vector<int>& columns, PixelRays found) {
  const std::size_t places = found.at.size();
  Cells cells(places, columns.size());
  RayRows filled(camera);
  for (std::size_t first = 0; first < places; first += RayRows::kMost) {
    const std::size_t count = std::min(RayRows::kMost, places - first);
    filled.take(std::span(found.rays).subspan(first, count));
    if (!filled.fill()) {
      PixelRays seen = seen_again(camera, found);
      if (seen.at.size() == places) return {0, columns.size()};
      return cells_of(camera, columns, std::move(seen));
    }
    copy_cells(filled.rows(), columns, static_cast<Eigen::Index>(first),
               static_cast<Eigen::Index>(count), cells);
  }
  cells.at = std::move(found.at);
  drop_undefined(cells);
  return cells;
}

// Those of the pixels [first, last), which lie in one row of the picture, that lie within a convex
// polygon: they follow each other.
std::pair<std::size_t, std::size_t> part_within(const std::vector<Pixel>& polygon,
                                                const std::vector<Pixel>& pixels, std::size_t first,
                                                std::size_t last) {
  while (first < last && !contains(polygon, pixels[first])) ++first;
  while (first < last && !contains(polygon, pixels[last - 1])) --last;
  return {first, last};
}

// The cells of the border and those of the picture within it.
Cells within(const std::vector<Pixel>& polygon, Cells border, const Cells& picture) {
  std::vector<std::pair<std::size_t, std::size_t>> runs;  // of places in the picture
  for (std::size_t row = 0; row < picture.at.size();) {
    std::size_t next = row;
    while (next < picture.at.size() && picture.at[next].v == picture.at[row].v) ++next;
    const auto [first, last] = part_within(polygon, picture.at, row, next);
    runs.emplace_back(first, last - first);
    row = next;
  }
  const Eigen::Index first = border.u.rows();
  for (const auto& [from, count] : runs) {
    const auto begin = picture.at.begin() + static_cast<std::ptrdiff_t>(from);
    border.at.insert(border.at.end(), begin, begin + static_cast<std::ptrdiff_t>(count));
  }
  border.resize(static_cast<Eigen::Index>(border.at.size()));
  const auto copy = [&](auto& to, const auto& from) {
    for (Eigen::Index c = 0; c < to.cols(); ++c) {
      double* column = to.col(c).data() + first;
      for (const auto& [place, count] : runs) {
        column = std::copy_n(from.col(c).data() + place, count, column);
      }
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
  Cells cells = cells_of(camera, columns, grid_rays(camera, kGridWidth, kGridHeight));
  ProjectionGrids grids;
  grids.covered =
      turned(within(covered, cells_of(camera, columns, rays_at(camera, covered)), cells));
  grids.picture = turned(std::move(cells));
  if (grids.covered.at.empty()) grids.covered = grids.picture;
  return grids;
}

ProjectionGrid projection_grid(const Camera& camera, const std::vector<int>& columns) {
  const PlacedGrid all =
      turned(cells_of(camera, columns, grid_rays(camera, kGridWidth, kGridHeight)));
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
