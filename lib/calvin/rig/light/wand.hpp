// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Lights in a line on a wand: which of them an instant has, where the wand is, and what its known
// lengths say of the cameras. Internal.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "calvin/core/result.hpp"
#include "calvin/geometry/se3.hpp"
#include "calvin/rig/light/light_unknowns.hpp"
#include "calvin/solve/residuals/board_shape.hpp"

namespace calvin::rig {

// A wand at one instant: its light k is the point first + k.
struct PlacedWand {
  std::size_t first = 0;
  std::vector<std::size_t> lights;  // that have a place: two or more, rising
  SE3 rig_from_wand;                // its lights lie on its x axis, the first one at 0
};

// Takes out of `points`, which rise, those of instants with two lights or more. `places` are those
// of the lights along the wand, m.
[[nodiscard]] std::vector<PlacedWand> take_wands(std::vector<std::size_t>& points,
                                                 const std::vector<double>& places,
                                                 const LightState& state);

// Puts the lights of a wand where it is.
void put_lights(const PlacedWand& wand, const std::vector<double>& places, LightState& state);

// A mode for each light but the first: its place along the wand.
[[nodiscard]] BoardShape shape_of_wand(std::size_t lights);

// How far two lights of a wand are apart by the rays of cameras alone, which know nothing of it.
struct WandDistance {
  std::size_t first = 0;  // of its points
  std::size_t a = 0;      // lights
  std::size_t b = 0;
  double seen = 0;   // rig
  double sigma = 0;  // of that, by the noise of the sightings, rig
};
[[nodiscard]] std::vector<WandDistance> wand_distances(const std::vector<LightCamera>& cameras,
                                                       const LightUnknowns& unknowns,
                                                       const LightState& state);

// By how much a rig has to grow so that the wand is as long as it is known to be: by the median of
// all distances. kDegenerate where two lights have too seldom been seen at a time, or what is seen
// is not rigid; kInvalidArgument where its parts are not as long beside each other as was said.
[[nodiscard]] Result<double> scale_by_wand(const std::vector<WandDistance>& distances,
                                           const LightUnknowns& unknowns);

// Leaves lights out that are not where the wand has them beside the others: as reflections that two
// cameras agree on. The rig has the unit of the wand.
void refuse_lights(const std::vector<WandDistance>& distances, const LightUnknowns& unknowns,
                   LightState& state);

// A rig that is larger.
void grow(LightState& state, double scale);

}  // namespace calvin::rig
