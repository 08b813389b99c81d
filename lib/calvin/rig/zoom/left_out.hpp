// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// How far a zoom table is off between its settings, found from the settings themselves.
#pragma once

#include <optional>

#include "calvin/camera/zoom_table.hpp"

namespace calvin {

// The table with ZoomSetting::left_out of every setting that has others on both sides: its zooms,
// or, of several with one zoom, its focuses. The table without the setting is interpolated where
// the setting stands, and held against it (difference(), the rotation taken out where corners
// covered the setting). The gap is twice as wide then as those of the whole table, and the noise of
// both is in it: between the settings of a smooth lens the whole table is nearer to the truth, but
// for the gaps at its ends, which may be as far off.
[[nodiscard]] ZoomTable with_left_out(ZoomTable table);

// The largest of them, px; absent where no setting has one.
[[nodiscard]] std::optional<double> largest_left_out(const ZoomTable& table);

}  // namespace calvin
