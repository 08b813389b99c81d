// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What the native files of cameras and of rigs have in common.
#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include "calvin/core/calibration.hpp"
#include "calvin/io/document.hpp"

namespace calvin::io {

// `format` and `version`: another format than `known` is refused, and a version after `newest`.
// `of` is what the file is one of: "a camera".
void read_head(Fields& fields, std::string_view known, int newest, std::string_view of);

// `covariance`, row-major; empty where it is absent or wrong. `of` says in a complaint what `size`
// counts: "parameters have a sigma".
[[nodiscard]] std::vector<double> read_covariance(Fields& fields, std::size_t size,
                                                  std::string_view of);

// `rotation` and `translation`.
[[nodiscard]] Pose read_pose(Fields fields);

}  // namespace calvin::io
