// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What layout and drawing of a page agree on. Private to draw/.
#pragma once

namespace calvin {

inline constexpr double kCaptionHeight = 0.010;  // m, of the strip below the white border

}  // namespace calvin
