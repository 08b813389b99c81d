// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What happens to the frames of one stream: nothing, or scaling, or undistortion.
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/frames/frame_planes.hpp"
#include "common/frames/frame_unpacking.hpp"
#include "undistort/calibration_input.hpp"
#include "undistort/row_workers.hpp"
#include "undistort/undistorter_builder.hpp"

namespace calvin::gst {

// Streaming thread, where nothing else is said.
class FrameUndistorter {
 public:
  struct Request {
    bool undistort = true;
    ViewOptions view;      // its size counts for nothing
    bool distort = false;  // the frames that come in show the view
    bool live = false;     // no frame waits long for an undistorter, but for the first
    Sampling sampling;
    int threads = 1;
  };

  [[nodiscard]] Status start();
  // Makes what is being built end soon. Any thread.
  void cancel() { builder_.cancel(); }
  void stop();

  // Other frames from now on; `in` is what a `part` shows.
  void set_frames(const FrameFormat& in, const FrameFormat& out,
                  const std::optional<FramePart>& part = {});
  [[nodiscard]] bool has_frames() const { return !planes_.empty(); }
  // Whether the frames cannot pass as they are: they come out in another size or siting.
  [[nodiscard]] bool must_move() const { return !in_.same_places(out_); }

  // Brings it up to date between two frames, and returns what the user should hear of it. A map is
  // built at once: the first frame that comes out is right. But in a live stream that has begun
  // nothing waits for one that takes longer than kQuick: what was in use goes on until a worker is
  // done, one map after the other while a lens zooms. A view of a camera whose views are known
  // takes a map only.
  [[nodiscard]] std::vector<Error> update(const CalibrationInput& input, const Request& request);
  // A frame goes out now.
  void begin() { begun_ = true; }

  // How the frames are moved; nullptr: not at all.
  [[nodiscard]] const std::shared_ptr<const Undistorter>& current() const { return current_; }
  [[nodiscard]] bool undistorts() const { return current_ && undistorts_; }
  // Whether it does so the other way round: the frames that come out have the lens in them.
  [[nodiscard]] bool distorts() const { return undistorts() && undistorter_.key.distort; }
  // What happens to the frames, in words for a log.
  [[nodiscard]] std::string describe() const;
  // The camera of the frames that come out, where `camera` is that of the ones that come in. Absent
  // where none is known, or none describes the projection.
  [[nodiscard]] std::optional<Camera> output_of(const std::optional<Camera>& camera) const;

  // Fills the output frame. An Error where frames have another size than was negotiated, or where
  // they cannot be made to have it: kCancelled after cancel().
  [[nodiscard]] Status apply(const GstVideoFrame& in, const GstVideoFrame& out) const;

 private:
  using Key = UndistorterBuilder::Key;
  struct Made {
    Key key;
    std::shared_ptr<const Undistorter> built;
    int turn = 0;
  };
  // What there is for a camera; a plain one scales.
  [[nodiscard]] Made& slot(const Key& key) { return key.camera == 0 ? scaler_ : undistorter_; }
  // A camera that sees the frames, and the view of it that they become or, `distort`, are.
  [[nodiscard]] Key key_of(int camera, int lens, const ViewOptions& view, bool distort) const;
  // Whether this is built before the next frame goes out.
  [[nodiscard]] bool worth_waiting(const Key& key, const Request& request);
  void want(const Key& key, const Result<Camera>& camera,
            const std::shared_ptr<const Rectification>& rectification, bool wait,
            std::vector<Error>& errors);
  void forget();
  // Into and out of the planes of the frames that have to be unpacked.
  void unpack(const GstVideoFrame& in) const;
  void pack(const GstVideoFrame& out) const;
  void adopt(const UndistorterBuilder::Built& built, std::vector<Error>& errors);
  // What the user may not have meant: once, until another view is shown.
  void tell_of_view(const Undistorter& view, std::vector<Error>& errors);

  UndistorterBuilder builder_;
  FrameFormat in_;
  FrameFormat out_;
  std::optional<FramePart> part_;  // of the picture in memory that `in_` is
  std::vector<FramePlane> planes_;
  int frames_ = 0;      // counts set_frames()
  int turn_ = 0;        // counts what was asked for
  bool begun_ = false;  // a frame of this format has passed

  static constexpr std::chrono::milliseconds kQuick{2};

  bool limit_reported_ = false;
  bool empty_reported_ = false;
  Sampling sampling_;
  mutable RowWorkers workers_;
  mutable std::vector<Undistorter::Scratch> scratch_;  // of each worker
  // The last frames that came and went, where they have to be unpacked.
  mutable std::optional<UnpackedFrame> unpacked_in_;
  mutable std::optional<UnpackedFrame> unpacked_out_;
  std::optional<Key> requested_;  // of the worker, the last one
  std::optional<Key> failed_;     // what could not be built, the last one
  Error failure_;                 // why
  Made undistorter_;
  Made scaler_;
  std::shared_ptr<const Undistorter> current_;
  bool undistorts_ = false;  // `current_` does
};

}  // namespace calvin::gst
