// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Homographies between planes.
#pragma once

#include <span>

#include <Eigen/Core>

#include "calvin/core/image.hpp"
#include "calvin/core/result.hpp"

namespace calvin {

// The H with uv ~ H (x, y, 1) that fits point pairs in the algebraic sense after normalisation
// (Hartley & Zisserman, Multiple View Geometry, algorithm 4.2), scaled to H(2,2) = 1 where it can
// be. At least 4 pairs, not collinear; otherwise kDegenerate.
[[nodiscard]] Result<Eigen::Matrix3d> fit_homography(std::span<const Pixel> xy,
                                                     std::span<const Pixel> uv);

// The image of a point under H; not finite where the point goes to infinity.
[[nodiscard]] Pixel transform(const Eigen::Matrix3d& h, Pixel point) noexcept;

}  // namespace calvin
