// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// All pairs of cameras that see one board at one time, held against a rig. Internal.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "calvin/core/image.hpp"
#include "calvin/core/result.hpp"
#include "calvin/core/rig.hpp"
#include "calvin/rig/rig_views.hpp"
#include "calvin/rig/watch/discrepancy.hpp"

namespace calvin::rig {

struct PairTest {
  std::size_t camera = 0;       // of the rig
  std::size_t by = 0;           // the other one, which is taken to stand where the rig has it
  std::uint64_t timestamp = 0;  // ns, of the first picture of the instant
  std::array<Pixel, 2> seen{};  // px: two corners before the camera, by which boards have moved
  Discrepancy discrepancy;      // of the camera
};

// In the order of time, each pair twice: either camera by the other. Views of cameras that the rig
// does not have are left out, as are those that move too far between two pictures of an instant.
// Errors are those of board_views().
[[nodiscard]] Result<std::vector<PairTest>> test_pairs(const Rig& rig,
                                                       const std::vector<RigCameraViews>& seen,
                                                       std::uint64_t tolerance);

}  // namespace calvin::rig
