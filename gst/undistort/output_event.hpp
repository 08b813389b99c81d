// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What downstream is told of the frames that come out.
#pragma once

#include <memory>

#include "common/event_ptr.hpp"
#include "undistort/calibration_input.hpp"
#include "undistort/frame_undistorter.hpp"

namespace calvin::gst {

// Streaming thread.
class OutputEvent {
 public:
  void reset() { *this = {}; }
  // The calibration event of the frames from now on, to be pushed; nullptr where downstream knows
  // it already. Frames that pass have the event that came with them.
  [[nodiscard]] EventPtr next(const FrameUndistorter& undistorter, const CalibrationInput& input);

 private:
  // What an event that is made here depends on.
  struct Cause {
    std::shared_ptr<const Undistorter> undistorter;
    int camera = 0;  // an undistorter has its camera in it
    friend bool operator==(const Cause&, const Cause&) = default;
  };
  [[nodiscard]] EventPtr make(const FrameUndistorter& undistorter, const CalibrationInput& input,
                              const Cause& cause) const;

  EventPtr sent_;
  bool own_ = false;  // `sent_` did not come from upstream
  Cause cause_;       // why it was made then
};

}  // namespace calvin::gst
