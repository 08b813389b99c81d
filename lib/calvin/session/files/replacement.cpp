// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Whether a result may replace what files hold of another session.

#include "calvin/session/files/replacement.hpp"

namespace calvin {

bool may_replace(const Calibration& now, std::span<const Calibration> others) {
  bool known = false;
  for (const Calibration& other : others) {
    if (!other.expected_error) continue;
    known = true;
    if (other.camera != now.camera || other.image_size != now.image_size) return false;
    if (!now.expected_error || *now.expected_error > *other.expected_error) return false;
  }
  return known;
}

}  // namespace calvin
