// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Views of the two cameras of a stereo pair, whose rows are the same.
#pragma once

#include <cstddef>
#include <vector>

#include "calvin/core/rig.hpp"
#include "calvin/remap/view_frames.hpp"

namespace calvin {

// The upper camera of two that stand one above the other is the left one.
enum class StereoSide { kLeft, kRight };

// Where the camera of that side is in its rig. Errors as of stereo_pair().
[[nodiscard]] Result<std::size_t> camera_of_side(const Rig& rig, StereoSide side);

// For ViewRange::find(): the left camera, then the right one, as both have to know them for their
// views to be equal to the last bit. The rows of their rectilinear views correspond (the columns
// where they stand one above the other), a point at z m along the views lies f b / z px further to
// the right (further down) in the left one, with the focal length f of the views and the baseline
// b: a point at infinity lies at the same pixel. `size` px have the frames of the camera `side`;
// those of the other camera are scaled as these are.
[[nodiscard]] Result<std::vector<Sight>> rectified_sights(const Rig& rig, StereoSide side,
                                                          ImageSize size);

// What both cameras make of frames of the left one's size, at that alpha. Errors as of
// ViewRange::find().
[[nodiscard]] Result<RectifiedPair> rectified_pair(const Rig& rig, double alpha = 0);

}  // namespace calvin
