// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// When a calibration is good enough.
#pragma once

#include "calvin/core/calibration.hpp"

namespace calvin {

// `target` px, 1 sigma: what the user asks for; 0: nothing in particular.

// Whether a calibration is as exact as `target` where corners were seen, and that is most of the
// picture, or the rest is not much worse: a board that is held in the middle is never done. Without
// a target: whether it is so exact all over the picture that more views change nothing that anybody
// would see.
[[nodiscard]] bool is_accurate(const Calibration& calibration, double target);

// What the expected error anywhere in the picture is to come to for that, px.
[[nodiscard]] double wanted_error_anywhere(double target);

// is_accurate(), and nothing speaks against believing it.
[[nodiscard]] bool is_good_enough(const Calibration& calibration, double target);

}  // namespace calvin
