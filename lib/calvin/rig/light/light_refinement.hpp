// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// One least squares over cameras and free points, and what agrees with its result. Internal.
#pragma once

#include <cstddef>
#include <optional>
#include <stop_token>
#include <vector>

#include <Eigen/Core>

#include "calvin/rig/light/light_unknowns.hpp"
#include "calvin/solve/residuals/loss.hpp"

namespace calvin::rig {

// Moves cameras and points, within what `stage` lets move, to where the cost of all sightings in
// use is least. At kWand two lights or more of an instant are those of a rigid wand, and a light by
// itself is a free point. False where that cannot be computed; the state is then as it was.
[[nodiscard]] bool refine(const std::vector<LightCamera>& cameras, const LightUnknowns& unknowns,
                          LightStage stage, const Loss& loss, int iterations,
                          const std::stop_token& stop, LightState& state);

// The information about the directions `basis` of all unknowns, the points eliminated, for
// sightings of their sigmas, and the cost.
struct LightInformation {
  Eigen::MatrixXd matrix;
  double cost = 0;
};
[[nodiscard]] std::optional<LightInformation> information(const std::vector<LightCamera>& cameras,
                                                          const LightUnknowns& unknowns,
                                                          LightStage stage,
                                                          const Eigen::MatrixXd& basis,
                                                          const LightState& state);

// How many unknowns the points and wands of the state are.
[[nodiscard]] double small_unknowns(const LightUnknowns& unknowns, LightStage stage,
                                    const LightState& state);

// How far stretches of time contradict each other: over `blocks` of them, one after the other, the
// sum of g^T H^-1 g for the gradient g of each over what it is for independent sightings of
// `variance` (P. J. Huber, Proc. 5th Berkeley Symposium, 1967, by clusters). 1 where their errors
// are independent; more where they have causes that last. `information` is that of `basis`.
[[nodiscard]] std::optional<double> scatter(const std::vector<LightCamera>& cameras,
                                            const LightUnknowns& unknowns, LightStage stage,
                                            const Eigen::MatrixXd& basis,
                                            const Eigen::MatrixXd& information, double variance,
                                            std::size_t blocks, const LightState& state);

// How far a sighting is from the projection of its point, px; absent where that has none.
[[nodiscard]] std::optional<double> distance(const LightCamera& camera, std::size_t instant,
                                             const Camera& model, const LightState& state,
                                             std::size_t number);

// The scale of the sightings in use by the median of their distances, in their sigmas, as if points
// had been known: what points take up of the noise is given back. At least kLeastScale.
[[nodiscard]] double noise_scale(const std::vector<LightCamera>& cameras,
                                 const LightUnknowns& unknowns, LightStage stage,
                                 const LightState& state);

// Decides anew which sightings are used, to `limit` sigmas, and places points that were not placed
// or of which a sighting contradicts: where most of their rays agree. A point that only one ray is
// left of is none. `instants` are those that are looked at; others are not used.
void judge(const std::vector<LightCamera>& cameras, const LightUnknowns& unknowns, double limit,
           const std::vector<std::size_t>& instants, LightState& state);

}  // namespace calvin::rig
