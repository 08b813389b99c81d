// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The face of solve/judge/projection_error.hpp.

#include "calvin/solve/uncertainty.hpp"

#include "calvin/solve/judge/projection_error.hpp"

namespace calvin {

std::optional<double> expected_error(const Calibration& calibration) {
  const auto promise = promise_of(calibration);
  return promise ? std::optional(promise->covered) : std::nullopt;
}

std::optional<double> expected_error_anywhere(const Calibration& calibration) {
  const auto promise = promise_of(calibration);
  return promise ? std::optional(promise->anywhere) : std::nullopt;
}

}  // namespace calvin
