// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Whether what a session knows so far may take the place of what others left.
#pragma once

#include <optional>
#include <span>

#include "calvin/core/calibration.hpp"

namespace calvin {

// Times as large: two solves of as good views differ by no more.
inline constexpr double kAsGood = 1.05;

// The figure by which calibrations of different views are compared: the expected error anywhere in
// the picture, px. The one where corners were seen would prefer those that saw little of it.
[[nodiscard]] std::optional<double> compared_error(const Calibration& calibration);

// `others` is what the files hold that a calibration is to be written to while its session goes on.
// True where one of them at least tells its expected error, and each that tells one is of the same
// camera and image size and no better: then nothing is lost.
[[nodiscard]] bool may_replace(const Calibration& now, std::span<const Calibration> others);

// Whether `before` is of the same camera, image size and position of the lens as a final result
// `now`, and better than it by its own figures: by more than two solves of as good views differ.
[[nodiscard]] bool is_better_of_same(const Calibration& before, const Calibration& now);

}  // namespace calvin
