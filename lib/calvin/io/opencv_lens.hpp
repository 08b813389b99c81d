// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What a file in OpenCV's numbers says of its lens.
#pragma once

#include "calvin/io/document.hpp"

namespace calvin::io {

// Whether the coefficients are those of cv::fisheye, by a flag (fisheye_model: 1) or by a name
// (camera_model: equidistant). The name of a lens that OpenCV does not have, and fields that
// contradict each other, are an error.
[[nodiscard]] bool read_fisheye(Fields& fields);

}  // namespace calvin::io
