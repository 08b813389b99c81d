// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What happens to the frames of one stream: nothing, or scaling, or undistortion.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "calibration_input.hpp"
#include "frame_planes.hpp"
#include "undistorter_builder.hpp"

namespace calvin::gst {

// Streaming thread, where nothing else is said.
class FrameWarp {
 public:
  struct Wish {
    bool undistort = true;
    double alpha = 0;
    bool live = false;  // no frame waits for an undistorter, but for the first
  };

  void start();
  // Makes what is being built end soon. Any thread.
  void cancel() { builder_.cancel(); }
  void stop();

  // Other frames from now on.
  void set_frames(const FrameFormat& in, const FrameFormat& out);
  [[nodiscard]] bool has_frames() const { return !planes_.empty(); }
  [[nodiscard]] bool takes(const FrameFormat& in) const { return in == in_; }
  [[nodiscard]] bool gives(const FrameFormat& out) const { return out == out_; }
  // Whether the frames cannot pass as they are: they come out in another size or siting.
  [[nodiscard]] bool must_move() const { return !in_.same_places(out_); }

  // Brings it up to date between two frames, and returns what the user should hear of it. An
  // undistorter in a live stream that has begun is built beside it, and what was in use goes on;
  // everything else is built at once: the first frame that comes out is right.
  [[nodiscard]] std::vector<Error> update(const CalibrationInput& input, const Wish& wish);
  // A frame goes out now.
  void begin() { begun_ = true; }

  // How the frames are moved; nullptr: not at all.
  [[nodiscard]] const std::shared_ptr<const Undistorter>& current() const { return current_; }
  [[nodiscard]] bool undistorts() const { return current_ && current_ == undistorter_; }
  // The camera of the frames that come out: of `camera`, which the ones that come in are from.
  [[nodiscard]] Result<Camera> output_of(const Camera& camera) const;

  // Fills the output frame. An Error where frames have another size than was negotiated.
  [[nodiscard]] Status apply(const GstVideoFrame& in, const GstVideoFrame& out) const;

 private:
  [[nodiscard]] UndistorterBuilder::Request request(const UndistorterBuilder::Key& key,
                                                    const Camera& camera) const;
  void adopt(const UndistorterBuilder::Built& built, std::vector<Error>& errors);
  void ensure_undistorter(const CalibrationInput& input, const Wish& wish,
                          std::vector<Error>& errors);
  void ensure_scaler(double alpha, std::vector<Error>& errors);

  UndistorterBuilder builder_;
  FrameFormat in_;
  FrameFormat out_;
  std::vector<FramePlane> planes_;
  int frames_ = 0;      // counts set_frames()
  bool begun_ = false;  // a frame of this format has passed

  std::optional<UndistorterBuilder::Key> requested_;
  std::shared_ptr<const Undistorter> undistorter_;
  std::optional<UndistorterBuilder::Key> scaled_;
  std::shared_ptr<const Undistorter> scaler_;
  std::shared_ptr<const Undistorter> current_;
};

}  // namespace calvin::gst
