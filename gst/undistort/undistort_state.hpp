// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What calibundistort knows of its stream, and how that is brought up to date between two frames.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gst/base/gstbasetransform.h>

#include "common/event_ptr.hpp"
#include "common/frames/frame_part.hpp"
#include "common/shared_settings.hpp"
#include "undistort/calibration_input.hpp"
#include "undistort/frame_undistorter.hpp"
#include "undistort/lens_follower.hpp"
#include "undistort/orientation_tags.hpp"
#include "undistort/output_event.hpp"
#include "undistort/undistort_settings.hpp"

namespace calvin::gst {

// Other settings take effect with the next frame.
struct UndistortState : SharedSettings<UndistortSettings> {
  explicit UndistortState(GstBaseTransform* trans) : element(trans) {}

  // An error for settings that cannot work; a file that is not there yet is a warning on the bus.
  [[nodiscard]] Status start();
  // Any thread: whoever waits for an undistorter goes on without it.
  void cancel() { undistorter.cancel(); }
  void stop();

  // Any thread.
  [[nodiscard]] std::string output_calibration();
  // A calibration event, and that of a rig, to be looked at by the next update().
  void keep_event(EventPtr event);
  void keep_rig_event(EventPtr event);
  // How the last frame was moved.
  [[nodiscard]] std::shared_ptr<const Undistorter> shown();

  // Brings everything up to date with the properties, the file and the events.
  void update();
  // The frame may be another part of the buffer's picture from now on.
  void follow_crop(GstBuffer* buffer);

  GstBaseTransform* element;
  FrameUndistorter undistorter;

  // Streaming thread, or before it starts.
  CalibrationInput input;
  LensFollower lens;
  OrientationTags tags;
  FrameFormat in;  // as the caps say
  FrameFormat out;
  std::optional<FramePart> part;  // of the last buffer
  bool distort = false;           // the frames that come out have the lens in them
  std::optional<std::pair<FrameFormat, std::optional<FramePart>>> fitted;  // `input` is
  std::optional<bool> live;    // unknown: not asked since the last caps
  bool renegotiated = false;   // since the last update()
  bool frame_refused = false;  // and that was reported
  bool second_time = false;    // the frames came undistorted, and that was reported
  OutputEvent output;

 private:
  // Events that nobody has looked at.
  struct Arrived {
    EventPtr calibration;
    EventPtr rig;
  };

  // Under lock_.
  std::string output_calibration_;
  Arrived arrived_;
  std::shared_ptr<const Undistorter> shown_;

  // The settings as they are now. What has changed goes to the input; events are returned.
  [[nodiscard]] UndistortSettings take_settings(Arrived& arrived);
  void take_events(const Arrived& arrived);
  void set_output_calibration(const std::string& json);
  // The calibration is that of the frames with the lens in them.
  void fit_input();
  // Says once that the frames are undistorted a second time.
  void warn_of_second_time();
  // Tells the input where the lens stands, and returns what the user should hear of it.
  [[nodiscard]] std::vector<Error> follow_lens(const LensSettings& settings);
  void set_passthrough(bool passthrough);
  // Tells downstream, and whoever listens to `output-calibration`, what the frames from now on are.
  void announce();
};

}  // namespace calvin::gst
