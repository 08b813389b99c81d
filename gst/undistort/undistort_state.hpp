// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What calibundistort knows of its stream, and how that is brought up to date between two frames.
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include <gst/base/gstbasetransform.h>

#include "common/event_ptr.hpp"
#include "common/frames/frame_part.hpp"
#include "undistort/calibration_input.hpp"
#include "undistort/frame_undistorter.hpp"
#include "undistort/orientation_tags.hpp"
#include "undistort/output_event.hpp"
#include "undistort/undistort_properties.hpp"

namespace calvin::gst {

struct UndistortState {
  explicit UndistortState(GstBaseTransform* trans) : element(trans) {}

  // Brings everything up to date with the properties, the file and the events.
  void update();
  // The frame may be another part of the buffer's picture from now on.
  void follow_crop(GstBuffer* buffer);
  // The settings as they are now. What has changed goes to the input; that of an event is returned.
  [[nodiscard]] UndistortSettings take_settings(EventPtr& event);
  void set_output_calibration(const std::string& json);

  GstBaseTransform* element;

  std::mutex lock;
  // Under the lock.
  UndistortSettings settings;
  bool calibration_changed = false;
  std::string output_calibration;
  EventPtr arrived_event;                    // a calibration event, not yet looked at
  std::shared_ptr<const Undistorter> shown;  // how the last frame was moved

  FrameUndistorter undistorter;

  // Streaming thread, or before it starts.
  CalibrationInput input;
  OrientationTags tags;
  FrameFormat in;  // as the caps say
  FrameFormat out;
  std::optional<FramePart> part;  // of the last buffer
  bool distort = false;           // the frames that come out have the lens in them
  std::optional<std::pair<FrameFormat, std::optional<FramePart>>> fitted;  // `input` is
  std::optional<bool> live;    // unknown: not asked since the last caps
  bool renegotiated = false;   // since the last update()
  bool frame_refused = false;  // and that was reported
  OutputEvent output;

 private:
  // The calibration is that of the frames with the lens in them.
  void fit_input();
  void set_passthrough(bool passthrough);
  // Tells downstream, and whoever listens to `output-calibration`, what the frames from now on are.
  void announce();
};

}  // namespace calvin::gst
