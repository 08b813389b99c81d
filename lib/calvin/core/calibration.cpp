// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Looks up a parameter of a calibration by its name.

#include "calvin/core/calibration.hpp"

#include <algorithm>

namespace calvin {

const Parameter* Calibration::find(std::string_view name) const noexcept {
  const auto it = std::find_if(parameters.begin(), parameters.end(),
                               [name](const Parameter& p) { return p.name == name; });
  return it == parameters.end() ? nullptr : &*it;
}

}  // namespace calvin
