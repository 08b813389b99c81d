// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The resolution inside a PNG file, which Cairo does not write. Private to draw/.
#pragma once

#include <string>

namespace calvin {

// Puts a pHYs chunk (pixels per metre, both ways) behind the header of a PNG that has none.
void set_png_resolution(std::string& png, double pixels_per_metre);

}  // namespace calvin
