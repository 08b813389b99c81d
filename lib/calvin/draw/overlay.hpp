// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What a person who holds a board wants to see on the video: the corners that were found, how far
// the calibration is, and what to show next.
//
// The drawing comes as small bitmaps that cover only the touched parts of the frame: blending costs
// per pixel, and a bitmap as large as the frame would cost more than everything else.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "calvin/core/image.hpp"
#include "calvin/core/observation.hpp"
#include "calvin/core/result.hpp"

namespace calvin {

// How far a calibration is. Values outside 0..1 are taken as the nearer end.
struct OverlayProgress {
  double coverage = 0;  // of the image by corners, 0..1
  double x = 0;         // how much of what is needed was seen across the image, 0..1
  double y = 0;         // likewise from top to bottom
  double size = 0;      // likewise from near to far
  double skew = 0;      // likewise of tilts
  int views = 0;
  bool captured = false;                 // a view was just taken: flashes the frame's border
  std::optional<double> expected_error;  // px, 1 sigma
  std::optional<double> rms;             // px
  std::string hint;                      // what to do next, "tilt the board left"
};

// A part of the drawing. `pixels` are 32-bit ARGB in the machine's byte order (B G R A in memory on
// little-endian ones), premultiplied, width * height, row by row. It lies inside the frame;
// x and y are multiples of 4, so that no chroma sample of a video frame lies in two tiles.
struct OverlayTile {
  int x = 0;
  int y = 0;
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> pixels;
};

// Marks for every found observation (rows joined in the order of the ids, red to violet; control
// point 0 is a disc, or a circle where the labelling is ambiguous) and, where there is `progress`,
// one bar each for coverage, x, y, size and skew. No tile where there is nothing to draw. Corners
// are scaled to the frame from the image_size of their observation. The first 64 observations are
// drawn, and the first 2000 corners of them. kUnsupported where the library
// was built without Cairo, whatever the arguments.
[[nodiscard]] Result<std::vector<OverlayTile>> draw_overlay(
    ImageSize frame, std::span<const Observation> observations,
    const std::optional<OverlayProgress>& progress);

// One line: "12 views, accurate to 0.36 px: tilt the board left"; empty where there is nothing to
// say. "Accurate to" is two sigma of the expected error; without it the rms is told. A hint is cut
// behind 500 bytes.
[[nodiscard]] std::string overlay_caption(const OverlayProgress& progress);

}  // namespace calvin
