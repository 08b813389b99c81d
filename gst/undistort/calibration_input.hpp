// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Which camera the frames come from: the property `calibration`, or else the event of an element
// upstream, fitted to the frames; of a rig the camera of one side, of a zoom table that where the
// lens stands.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <gst/video/video.h>

#include "calvin/camera/camera.hpp"
#include "calvin/camera/frame_fit.hpp"
#include "calvin/camera/zoom_table.hpp"
#include "calvin/remap/rectification.hpp"
#include "common/calibration_reader.hpp"
#include "common/event_ptr.hpp"

namespace calvin::gst {

// The cameras of a stereo pair (rectified_sights()), and which of them the frames are of.
struct Rectification {
  std::vector<Sight> sights;
  std::size_t own = 0;
};

// Streaming thread, or before it starts. What is broken never takes the place of what worked.
class CalibrationInput {
 public:
  // Forgets the stream, its format and its events, and reads the setting before it returns: the
  // first frame has the file that is named now. What the user should hear of it.
  [[nodiscard]] std::vector<Error> start();
  // Returns at once, whatever is being read.
  void stop() { setting_.stop(); }
  void set_text(const std::string& text);
  // `part`: where the frames lie in a larger picture.
  void set_frames(const GstVideoInfo& info, const std::optional<FramePart>& part = {});
  // How the frames have to be turned to stand upright: a calibration of a shape that only the
  // upright picture has is one of that picture.
  void set_upright(Orientation upright);

  // Frames of that camera of a pair are to be rectified: a rig takes the place of a calibration.
  void set_side(std::optional<StereoSide> side);

  // Where the lens stands, as far as that is known, which counts for a zoom table; `awaited`: what
  // is not known yet is being asked for.
  void set_position(const LensPosition& position, bool awaited);

  // Whether it is a calibration event: ours, or the one of GStreamer's cameracalibrate.
  [[nodiscard]] static bool is_calibration(GstEvent* event);
  // Keeps a calibration event. An Error where its calibration cannot be read: the one before stays.
  [[nodiscard]] Status take_event(GstEvent* event);
  // The same of the event of a calibrig.
  [[nodiscard]] Status take_rig_event(GstEvent* event);
  // The last calibration event, as it came, or nullptr.
  [[nodiscard]] GstEvent* event() const { return event_.get(); }
  // Whether it says that the frames are undistorted already.
  [[nodiscard]] bool comes_undistorted() const { return comes_undistorted_; }
  // Whether, in spite of that, the property has a lens for them that bends.
  [[nodiscard]] bool bends_twice() const;

  // Takes in what is new, and returns what the user should hear of it, in order. Waits for no disk:
  // a file that is named or replaced meanwhile is taken in when it has been read.
  [[nodiscard]] std::vector<Error> update(CalibrationReader::Clock::time_point now);

  // The camera of the frames; absent without a calibration that fits. `serial` counts its changes.
  [[nodiscard]] const std::optional<Camera>& camera() const { return camera_; }
  [[nodiscard]] const std::string& name() const { return name_; }
  // Of a camera() that is one of a stereo pair; else nullptr.
  [[nodiscard]] const std::shared_ptr<const Rectification>& rectification() const {
    return rectification_;
  }
  [[nodiscard]] int serial() const { return serial_; }
  // Counts those changes alone that are not a move of the lens.
  [[nodiscard]] int lens() const { return lens_; }

 private:
  void take(CalibrationReader::ReadResult read, std::vector<Error>& errors);
  void fit(std::vector<Error>& errors);
  [[nodiscard]] std::optional<CameraSetting>& in_force();
  [[nodiscard]] Calibration* known(std::vector<Error>& errors);
  [[nodiscard]] Calibration* single_camera(CameraSetting& source, std::vector<Error>& errors);
  [[nodiscard]] Calibration* camera_of_pair(CameraSetting& source, std::vector<Error>& errors);
  [[nodiscard]] Calibration* where_it_stands(const ZoomTable& table, std::vector<Error>& errors);
  void count_change();
  [[nodiscard]] Status set_camera(const FittedCamera& fitted);
  void report_scaling(const Calibration& known, std::vector<Error>& errors);
  void judge(const Calibration& known, std::vector<Error>& errors);
  void report(Error error, std::vector<Error>& errors);

  std::string text_;
  CalibrationReader setting_;
  std::optional<CameraSetting> from_setting_;
  std::optional<CameraSetting> from_event_;
  std::optional<CameraSetting> from_rig_event_;
  EventPtr event_;
  bool comes_undistorted_ = false;

  ImageSize frames_;
  std::optional<FramePart> part_;
  Orientation upright_;
  std::optional<StereoSide> side_;
  bool interlaced_ = false;
  LensPosition position_;
  bool position_awaited_ = false;
  std::optional<Calibration> at_position_;  // of a zoom table
  bool changed_ = false;
  bool moved_ = false;  // the lens has, and nothing else is new
  std::optional<Camera> camera_;
  std::shared_ptr<const Rectification> rectification_;
  std::string name_;
  int serial_ = 0;
  int lens_ = 0;
  bool new_ = false;           // the calibration in force was not judged yet
  bool poor_ = false;          // the last one was, and found wanting
  std::string said_;           // the last message on how the calibration fits: each is said once
  bool said_outside_ = false;  // that the lens stands where its table does not reach
};

}  // namespace calvin::gst
