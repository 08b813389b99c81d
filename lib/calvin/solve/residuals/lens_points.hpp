// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Many points before a known camera at once: how far they are from where they are seen, and the
// rays of pixels. Internal.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "calvin/camera/camera.hpp"
#include "calvin/geometry/se3.hpp"
#include "calvin/solve/residuals/view_points.hpp"

namespace calvin {

// A camera as the functions of its lens take it.
struct KnownLens {
  const double* parameters = nullptr;  // in the order of CameraUnknowns
  double skew = 0;                     // px
  double limit = 0;                    // see camera/distortion.hpp
};

// The functions of one lens for the widest vectors of the machine. Arrays are aligned and as long
// as a multiple of kLanes; a ray is zero where it was not found in a few steps.
struct LensPointFunctions {
  void (*squares)(const KnownLens& lens, const ViewPoints& view, const SE3& camera_from_board,
                  double* out) = nullptr;
  void (*rays)(const KnownLens& lens, double* u, double* v, double* x, double* y, double* z,
               std::size_t padded) = nullptr;
};
template <typename Lens>
[[nodiscard]] LensPointFunctions lens_point_functions_of();

class CameraPoints {
 public:
  // The camera must outlive this.
  explicit CameraPoints(const Camera& camera);

  // The squared and weighted distances of the corners of a view from where Camera::project() says
  // that they are seen, px^2, padded() of them; infinite for those without a projection.
  void squares(const ViewPoints& view, const SE3& camera_from_board, double* out) const {
    functions_.squares(lens_, view, camera_from_board, out);
  }

  // What Camera::unproject() says of each pixel, to 1e-12 rad: unit rays, zero where there is none.
  [[nodiscard]] std::vector<Eigen::Vector3d> rays(std::span<const Pixel> pixels) const;

 private:
  const Camera& camera_;
  KnownLens lens_;
  LensPointFunctions functions_;
};

}  // namespace calvin
