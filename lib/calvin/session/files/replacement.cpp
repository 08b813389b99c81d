// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Whether a result may replace what files hold of another session.

#include "calvin/session/files/replacement.hpp"

#include <cmath>

namespace calvin {

std::optional<double> compared_error(const Calibration& calibration) {
  return calibration.expected_error_anywhere ? calibration.expected_error_anywhere
                                             : calibration.expected_error;
}

bool may_replace(const Calibration& now, std::span<const Calibration> others) {
  bool known = false;
  for (const Calibration& other : others) {
    const auto before = compared_error(other);
    if (!before) continue;
    known = true;
    if (other.camera != now.camera || other.image_size != now.image_size) return false;
    const auto error = compared_error(now);
    if (!error || *error > *before) return false;
  }
  return known;
}

bool is_better_of_same(const Calibration& before, const Calibration& now) {
  const auto moved = [](const std::optional<double>& one, const std::optional<double>& other) {
    return one && other && *one != *other;
  };
  if (before.camera != now.camera || before.image_size != now.image_size) return false;
  if (moved(before.focus, now.focus) || moved(before.zoom, now.zoom)) return false;
  const auto error = compared_error(before);
  return error && kAsGood * *error < compared_error(now).value_or(HUGE_VAL);
}

}  // namespace calvin
