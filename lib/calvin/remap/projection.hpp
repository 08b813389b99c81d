// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// How a virtual camera lays directions out on its plane.
#pragma once

#include <cstdint>
#include <optional>

#include <Eigen/Core>

#include "calvin/core/image.hpp"

namespace calvin {

// With the longitude l, the latitude b and the angle t from the axis, points (x, y) of the plane:
//   rectilinear      tan t along the direction; straight lines stay straight; 150 degrees at most
//   cylindrical      (l, tan b); verticals stay straight
//   equirectangular  (l, b)
//   stereographic    2 tan(t / 2) along the direction; small shapes keep their form
//   panini           S (sin l, tan b) with S = 2 / (1 + cos l); verticals and lines through the
//                    middle stay straight (Sharpless, Postle, German: Pannini, 2010; d = 1)
//   fisheye          t along the direction (equidistant)
enum class Projection : std::uint8_t {
  kRectilinear,
  kCylindrical,
  kEquirectangular,
  kStereographic,
  kPanini,
  kFisheye
};

// A rectangle on the plane of a projection.
struct PlaneBox {
  Pixel low;
  Pixel high;
};

// Half the width, on the plane, of the widest view that may be asked for.
[[nodiscard]] double widest(Projection projection) noexcept;

// Direction, z along the axis -> plane; absent beyond what is shown: 75 degrees off the axis for a
// rectilinear view and for latitudes of cylindrical and panini ones, 150 for longitudes of a panini
// and for a stereographic view.
[[nodiscard]] std::optional<Pixel> to_plane(Projection projection,
                                            const Eigen::Vector3d& direction) noexcept;

// The inverse of to_plane(), a direction of any length; absent where no direction leads to the
// point.
[[nodiscard]] std::optional<Eigen::Vector3d> from_plane(Projection projection,
                                                        Pixel point) noexcept;

}  // namespace calvin
