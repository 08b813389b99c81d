// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Points from linear cameras and linear cameras from points, where some of what was seen is wrong.
// Internal.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "calvin/rig/light/tracks.hpp"

namespace calvin::rig {

// What one camera has seen of one point.
struct Ray {
  std::size_t camera = 0;
  Matrix34 projection;  // at ~ projection * point
  Eigen::Vector2d at;
  double scale = 1;  // px per unit of `at`
};

// px, between where the ray's camera has seen the point and where it projects to; infinite for a
// point at its centre.
[[nodiscard]] double reprojection(const Ray& ray, const Eigen::Vector4d& point);

// The point, homogeneous and of norm 1, by linear least squares (R. Hartley, A. Zisserman, Multiple
// View Geometry, 12.2), in which distances are then weighted to be those in the pictures. Two rays
// or more.
[[nodiscard]] Eigen::Vector4d triangulate(std::span<const Ray> rays);

struct TriangulatedPoint {
  Eigen::Vector4d at;
  std::vector<bool> agree;  // per ray
  double cost = 0;          // px^2, of the rays that agree
};

// The point that most rays agree on to `limit` px, proposed by pairs of rays. Absent where no two
// agree, or where different pairs of three rays or more do and no third one decides.
[[nodiscard]] std::optional<TriangulatedPoint> agreed_point(std::span<const Ray> rays,
                                                            double limit);

// A point with a known place and where a camera has seen it.
struct SeenPoint {
  Eigen::Vector4d point;
  TrackPoint seen;
};

// Needs this many points.
inline constexpr std::size_t kFewestSeen = 12;

// The camera before known points, by random samples of six for which the linear equations are
// solved (ibid., 7.1), then by all that agree to `limit` px. Absent where too few do.
[[nodiscard]] std::optional<Matrix34> resect(const std::vector<SeenPoint>& points, double limit);

// By all points, of which none is wrong.
[[nodiscard]] Matrix34 resect_all(std::span<const SeenPoint> points);

}  // namespace calvin::rig
