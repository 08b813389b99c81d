// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Whether a result may replace what files hold of another session.

#include "calvin/session/files/replacement.hpp"

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

}  // namespace calvin
