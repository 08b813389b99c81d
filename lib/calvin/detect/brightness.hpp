// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Whether an image can show a board at all.
#pragma once

#include "calvin/core/image.hpp"

namespace calvin {

// Whether next to nothing in the image is as bright as the paper of a board has to be: for a user
// who wonders why none is found. Looks at some 10,000 pixels. An empty image is not dark.
[[nodiscard]] bool is_too_dark(const ImageView& image) noexcept;

}  // namespace calvin
