// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Whether a calibration goes on holding, judged by every frame of its camera: Recheck for a stream.
#pragma once

#include <map>

#include "calvin/camera/camera.hpp"
#include "calvin/core/calibration.hpp"
#include "calvin/core/result.hpp"
#include "calvin/session/views/sighting.hpp"
#include "calvin/solve/recheck.hpp"

namespace calvin {

// A stream has thousands of frames: what one in twenty shows by chance is no change, and a change
// is one only where four frames in a row show it, by more than .3 px or 4 sigma. A board that moves
// was elsewhere when other rows were read: the readout is that of the calibration, or up to a
// thirtieth of a second where the calibration has none, and the frames before tell how the board
// moves. A view of which nobody knows how it moved tells nothing of the camera.
//
// Not thread-safe.
class CalibrationWatch {
 public:
  // `camera` is that of the frames; `calibration` is what it was made of.
  CalibrationWatch(const Camera& camera, const Calibration& calibration);

  // What all views so far say, as Recheck::add(), with the pose and rms of this one. `place`: which
  // of several boards in a frame.
  [[nodiscard]] Result<RecheckReport> add(const View& view, int place);

 private:
  // What tells of the camera in a view; absent where nobody knows how its board moved.
  [[nodiscard]] std::optional<View> at_rest_or_moving(const View& view, int place);

  // What add() tells of a view that tells nothing of the camera, and is not remembered.
  [[nodiscard]] Result<RecheckReport> without_telling(const View& view) const;
  [[nodiscard]] double longest_readout() const;  // s

  ReadoutTime readout_;
  Recheck recheck_;
  std::map<int, Sighting> before_;  // by place
  int in_a_row_ = 0;                // views that show a change
};

}  // namespace calvin
