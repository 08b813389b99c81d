// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The checkerboard detector, by OpenCV.
#pragma once

#include <memory>

#include "calvin/detect/detector.hpp"

namespace calvin::detect {

[[nodiscard]] std::unique_ptr<Detector> make_checkerboard_detector(const Board& board);

}  // namespace calvin::detect
