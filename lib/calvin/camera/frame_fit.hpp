// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// How a calibration fits frames that are scaled, cropped or turned.
#pragma once

#include "calvin/camera/camera.hpp"

namespace calvin {

struct FittedCamera {
  Camera camera;        // of frames of the size asked for
  bool scaled = false;  // the frames have another size than the calibration
  bool turned = false;  // the calibration is of the upright picture, the frames lie on a side
};

// The camera of frames of `frame` px whose calibration is known. A frame of another size but the
// same aspect (to 1 px) is a scaled one; `sensor_crop` says which part of the calibrated image the
// frames show; a calibration of size 0x0 is for any. `upright` says how the frames have to be
// turned: a calibration that has the aspect of the turned picture only is one of that picture, and
// the camera is turned back to the frames. Any other aspect is kInvalidArgument.
[[nodiscard]] Result<FittedCamera> fit_to_frame(const Calibration& calibration, ImageSize frame,
                                                Orientation upright = {});

// Frames that are a part of a larger picture.
struct FramePart {
  ImageSize whole;  // px of the picture
  int x = 0;        // of its pixels the first column and row
  int y = 0;
  ImageSize size;  // px of the frames

  friend bool operator==(const FramePart&, const FramePart&) = default;
};

// The same for such frames. A calibration that has the aspect of the whole picture is one of that,
// unless it is of exactly the size of the frames, or says what they show (`sensor_crop`).
[[nodiscard]] Result<FittedCamera> fit_to_part(const Calibration& calibration,
                                               const FramePart& part, Orientation upright = {});

}  // namespace calvin
