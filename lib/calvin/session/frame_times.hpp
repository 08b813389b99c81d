// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// When a frame was taken and when it is shown, as messages tell it.
#pragma once

#include <cstdint>

#include "calvin/core/observation.hpp"

namespace calvin {

// ns; kNoTimestamp where unknown.
struct FrameTimes {
  std::uint64_t timestamp = kNoTimestamp;
  std::uint64_t stream_time = kNoTimestamp;
  std::uint64_t running_time = kNoTimestamp;
  std::uint64_t duration = kNoTimestamp;
};

}  // namespace calvin
