// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Whether numbers are the covariance of anything. Internal.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>

namespace calvin {

// What says that size x size numbers, row by row, are the covariance of nothing, as a clause: "has
// a negative variance in row 1". Such errors would have less than none along some direction. Absent
// for a covariance, as far as the few digits go with which files are written.
[[nodiscard]] std::optional<std::string> no_covariance(std::span<const double> row_major,
                                                       std::size_t size);

}  // namespace calvin
