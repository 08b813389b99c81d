// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The middle of some values. Internal.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace calvin {

// The upper one of the two in the middle of an even number; `values` are some.
[[nodiscard]] inline double median_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

}  // namespace calvin
