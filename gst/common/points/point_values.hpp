// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Manual points outside: the event calvin-point {uv, world, sigma} or the click that chooses one,
// and the message calib-point that says what came of it.
#pragma once

#include <optional>
#include <string>

#include <gst/gst.h>

#include "calvin/session/frame_times.hpp"
#include "calvin/session/points/manual_points.hpp"

namespace calvin::gst {

inline constexpr char kPointName[] = "calvin-point";
inline constexpr char kRemovePointName[] = "calvin-remove-point";

// `uv`: an array of two numbers, px; `world`: of three, m, or left out for the next point of the
// board; `sigma`: px, or left out where the corner next to the pixel is meant. What is there and
// no such array becomes no numbers, which no point is taken with.
[[nodiscard]] PointChoice read_point(const GstStructure* structure);

// The field `index`, an unsigned number; absent where it is not there. What is no index becomes the
// largest number, which nothing has.
[[nodiscard]] std::optional<unsigned> read_index(const GstStructure* structure);

// A button of a mouse that is pressed in the picture: the left one, or the right one, which takes
// the newest point out. Absent for other events.
struct Click {
  Pixel at;
  bool takes_out = false;
};
[[nodiscard]] std::optional<Click> read_click(GstEvent* event);

// calib-point {accepted, reason, snapped, u, v, sigma, id, x, y, z, points, hint}.
[[nodiscard]] GstStructure* point_message(const FrameTimes& times, const std::string& camera,
                                          const PointAnswer& answer);

}  // namespace calvin::gst
