// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Newton's method over all rays at once, by the derivatives that the least squares has.

#include "calvin/solve/residuals/grid_rays.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

namespace calvin {

namespace {

constexpr int kStep = 4;  // from one ray that is found by itself to the next, in columns and rows

using Numbers = Eigen::Array<double, RayRows::kMost, 1>;

// Points in front of the camera, to be placed; what is seen of them are the projections themselves.
PointSet any_points() {
  PointSet set;
  set.ids.resize(RayRows::kMost);
  std::iota(set.ids.begin(), set.ids.end(), 0);
  set.points.assign(RayRows::kMost, Eigen::Vector3d::UnitZ());
  set.uv.assign(RayRows::kMost, Pixel{});
  set.weight.assign(RayRows::kMost, 1);
  return set;
}

Pixel grid_pixel(ImageSize size, int columns, int rows, int x, int y) {
  return {x * (size.width - 1.0) / (columns - 1), y * (size.height - 1.0) / (rows - 1)};
}

// The rays of a grid's nodes, and those in between by interpolation.
class CoarseRays {
 public:
  CoarseRays(const Camera& camera, int columns, int rows) : across_((columns - 1) / kStep + 1) {
    for (int y = 0; y < rows; y += kStep) {
      for (int x = 0; x < columns; x += kStep) {
        nodes_.push_back(camera.unproject(grid_pixel(camera.image_size(), columns, rows, x, y)));
      }
    }
  }

  // Absent where the ray of a node around is.
  [[nodiscard]] std::optional<Eigen::Vector3d> at(int x, int y) const {
    const int left = x / kStep;
    const int top = y / kStep;
    const int right = (x + kStep - 1) / kStep;
    const int bottom = (y + kStep - 1) / kStep;
    const double to_right = static_cast<double>(x % kStep) / kStep;
    const double down = static_cast<double>(y % kStep) / kStep;
    if (!node(left, top) || !node(right, top) || !node(left, bottom) || !node(right, bottom)) {
      return std::nullopt;
    }
    const Eigen::Vector3d above = (1 - to_right) * *node(left, top) + to_right * *node(right, top);
    const Eigen::Vector3d below =
        (1 - to_right) * *node(left, bottom) + to_right * *node(right, bottom);
    return (1 - down) * above + down * below;
  }

 private:
  [[nodiscard]] const std::optional<Eigen::Vector3d>& node(int x, int y) const {
    return nodes_[static_cast<std::size_t>(y * across_ + x)];
  }

  int across_;
  std::vector<std::optional<Eigen::Vector3d>> nodes_;
};

// Whether all rays have come to their pixels.
bool all_settled(const Camera& camera, PixelRays& found) {
  RayRows rows(camera);
  for (std::size_t first = 0; first < found.at.size(); first += RayRows::kMost) {
    const std::size_t count = std::min(RayRows::kMost, found.at.size() - first);
    rows.take(std::span(found.rays).subspan(first, count));
    if (!rows.settle(std::span(found.at).subspan(first, count))) return false;
    for (std::size_t i = 0; i < count; ++i) found.rays[first + i] = rows.ray(i);
  }
  return true;
}

}  // namespace

RayRows::RayRows(const Camera& camera)
    : camera_(camera),
      fill_(fill_rows_of(camera.model())),
      points_(any_points(), {}),
      rows_({CameraUnknowns::of(camera.parameters().size(), true), 0}) {
  rows_.resize(points_.padded());
}

void RayRows::take(std::span<const Eigen::Vector3d> rays) {
  for (std::size_t k = 0; k < 3; ++k) {
    double* to = points_.place(k);
    for (std::size_t i = 0; i < kMost; ++i) {
      to[i] = rays[i < rays.size() ? i : 0][static_cast<Eigen::Index>(k)];
    }
  }
}

bool RayRows::fill() {
  const RowPoint at = {camera_.parameters().data(), camera_.skew(), nullptr};
  return fill_(points_, at, SE3{}, Loss{}, rows_, RowContent::kAll).valid;
}

Eigen::Vector3d RayRows::ray(std::size_t i) {
  return {points_.place(0)[i], points_.place(1)[i], points_.place(2)[i]};
}

// Each step is at right angles to the ray, as the derivatives by the point are.
bool RayRows::settle(std::span<const Pixel> pixels) {
  constexpr int kTranslation = 3;  // the first column of a pose's translation
  constexpr int kRounds = 6;
  constexpr double kNear = 1e-3;  // px; the step from there leaves less than the square of that
  Numbers pixel_u;
  Numbers pixel_v;
  for (std::size_t i = 0; i < kMost; ++i) {
    const Pixel& pixel = pixels[i < pixels.size() ? i : 0];
    pixel_u[static_cast<Eigen::Index>(i)] = pixel.u;
    pixel_v[static_cast<Eigen::Index>(i)] = pixel.v;
  }
  const auto u = [this](int column) { return Eigen::Map<const Numbers>(rows_.u(column)); };
  const auto v = [this](int column) { return Eigen::Map<const Numbers>(rows_.v(column)); };
  for (int round = 0; round < kRounds; ++round) {
    if (!fill()) return false;
    const Numbers off_u = u(RowLayout::kResidual) - pixel_u;
    const Numbers off_v = v(RowLayout::kResidual) - pixel_v;
    Numbers uu = Numbers::Zero();
    Numbers uv = Numbers::Zero();
    Numbers vv = Numbers::Zero();
    for (int k = kTranslation; k < kTranslation + 3; ++k) {
      uu += u(k) * u(k);
      uv += u(k) * v(k);
      vv += v(k) * v(k);
    }
    const Numbers inverse = (uu * vv - uv * uv).inverse();
    const Numbers along_u = inverse * (vv * off_u - uv * off_v);
    const Numbers along_v = inverse * (uu * off_v - uv * off_u);
    if (!std::isfinite(along_u.sum() + along_v.sum())) return false;
    for (int k = 0; k < 3; ++k) {
      Eigen::Map<Numbers>(points_.place(static_cast<std::size_t>(k))) -=
          along_u * u(kTranslation + k) + along_v * v(kTranslation + k);
    }
    if (off_u.abs().maxCoeff() < kNear && off_v.abs().maxCoeff() < kNear) return true;
  }
  return false;
}

PixelRays rays_at(const Camera& camera, const std::vector<Pixel>& pixels) {
  PixelRays found;
  for (const Pixel pixel : pixels) {
    const auto ray = camera.unproject(pixel);
    if (!ray) continue;
    found.at.push_back(pixel);
    found.rays.push_back(*ray);
  }
  return found;
}

PixelRays grid_rays(const Camera& camera, int columns, int rows) {
  const CoarseRays coarse(camera, columns, rows);
  PixelRays found;
  std::vector<Pixel> pixels;
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < columns; ++x) {
      const Pixel pixel = grid_pixel(camera.image_size(), columns, rows, x, y);
      pixels.push_back(pixel);
      auto ray = coarse.at(x, y);
      if (!ray) ray = camera.unproject(pixel);
      if (!ray) continue;
      found.at.push_back(pixel);
      found.rays.push_back(*ray);
    }
  }
  return all_settled(camera, found) ? found : rays_at(camera, pixels);
}

}  // namespace calvin
