// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What is said of an expected error that is too large to be a number. Internal.
#pragma once

namespace calvin {

// px, 1 sigma: an expected error beyond it says that nothing is known of that part of the picture,
// and how large it is says no more.
inline constexpr double kNothingKnown = 25;

}  // namespace calvin
