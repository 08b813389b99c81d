// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// How long sheets are followed before the whole image is searched again, for further ones.
#pragma once

#include <cstdint>

namespace calvin::detect {

inline constexpr std::uint64_t kSearchAgain = 1'000'000'000;  // ns
inline constexpr int kSearchAgainFrames = 30;                 // where frames have no time

}  // namespace calvin::detect
