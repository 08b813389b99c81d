// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// How far two calibrations of one camera are apart, in px all over the image.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "calvin/camera/camera.hpp"
#include "calvin/core/result.hpp"

namespace calvin {

struct DifferenceOptions {
  // The grid of pixels that are compared, from the centre of the first pixel to that of the last;
  // 2 to 1000 each way.
  int columns = 65;
  int rows = 49;

  // Where the rotation is fitted: within all of these convex polygons (px, ordered as convex_hull()
  // does), for example within the covered regions of both calibrations. None: in the whole image.
  std::vector<std::vector<Pixel>> focus;
};

struct Difference {
  struct Cell {
    Pixel at;                     // px of `a`
    std::optional<Pixel> change;  // px of `b` that sees the same ray, less `at`
    bool in_focus = false;
  };
  // The largest change and the square root of the mean squared one, px; the cell of the largest.
  struct Summary {
    double max = 0;
    double rms = 0;
    Pixel worst;
    int cells = 0;
  };

  // Rodrigues vector, rad: takes a ray in the frame of `a` to the frame of `b`.
  std::array<double, 3> rotation{};
  Summary image;
  Summary focus;            // equal to `image` where no focus was given
  int columns = 0;          // of `cells`, which lie row by row
  std::vector<Cell> cells;  // without a change where a model has no value
};

// Each pixel of the grid is unprojected through `a`; its ray (a point at infinity) is turned and
// projected through `b`. A camera may be mounted a little turned without being another one: the
// rotation is the one that makes the sum of squared changes over the focus the least, found by
// iteration, so that it is right for large differences too. After mrcal's projection difference
// (D. Kogan, mrcal-show-projection-diff). The models may differ; pixels for which either has no
// value are left out.
// kInvalidArgument: images of different sizes, or a grid that is none. kDegenerate: fewer than
// three pixels of the focus that both models know.
[[nodiscard]] Result<Difference> difference(const Camera& a, const Camera& b,
                                            const DifferenceOptions& options = {});

}  // namespace calvin
