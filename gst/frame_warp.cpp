// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What happens to the frames of one stream: nothing, or scaling, or undistortion.

#include "frame_warp.hpp"

#include <utility>

namespace calvin::gst {

void FrameWarp::start() {
  planes_.clear();
  builder_.start();
}

void FrameWarp::stop() {
  builder_.stop();
  undistorter_.reset();
  scaler_.reset();
  current_.reset();
  requested_.reset();
  scaled_.reset();
}

void FrameWarp::set_frames(const FrameFormat& in, const FrameFormat& out) {
  in_ = in;
  out_ = out;
  planes_ = planes_of(in, out);
  ++frames_;
  begun_ = false;
  requested_.reset();
  scaled_.reset();
  undistorter_.reset();
  scaler_.reset();
  current_.reset();
}

UndistorterBuilder::Request FrameWarp::request(const UndistorterBuilder::Key& key,
                                               const Camera& camera) const {
  UndistorterBuilder::Request made = {key, camera, out_.size(), {}};
  for (const FramePlane& plane : planes_) made.planes.push_back(plane.layout);
  return made;
}

void FrameWarp::adopt(const UndistorterBuilder::Built& built, std::vector<Error>& errors) {
  if (built.undistorter) {
    undistorter_ = *built.undistorter;
  } else if (built.undistorter.error().code != ErrorCode::kCancelled) {
    errors.push_back(built.undistorter.error());
  }
}

void FrameWarp::ensure_undistorter(const CalibrationInput& input, const Wish& wish,
                                   std::vector<Error>& errors) {
  const UndistorterBuilder::Key key = {frames_, input.serial(), wish.alpha};
  if (requested_ == key) return;
  requested_ = key;
  auto made = request(key, *input.camera());
  if (wish.live && begun_) {
    builder_.offer(std::move(made));
  } else {
    adopt(builder_.build(made), errors);
  }
}

void FrameWarp::ensure_scaler(double alpha, std::vector<Error>& errors) {
  const UndistorterBuilder::Key key = {frames_, 0, alpha};
  if (scaled_ == key) return;
  scaled_ = key;
  const auto plain = plain_camera(in_.size());
  if (!plain) {
    errors.push_back(plain.error());
    return;
  }
  const auto built = builder_.build(request(key, *plain));
  if (built.undistorter) {
    scaler_ = *built.undistorter;
  } else if (built.undistorter.error().code != ErrorCode::kCancelled) {
    errors.push_back(built.undistorter.error());
  }
}

std::vector<Error> FrameWarp::update(const CalibrationInput& input, const Wish& wish) {
  std::vector<Error> errors;
  // What a worker was asked for with other frames or another calibration comes too late.
  if (const auto built = builder_.take();
      built && built->key.frames == frames_ && built->key.camera == input.serial()) {
    adopt(*built, errors);
  }
  if (!input.camera()) {
    undistorter_.reset();
    requested_.reset();
  } else if (wish.undistort) {
    ensure_undistorter(input, wish, errors);
  }
  const bool undistort = wish.undistort && undistorter_;
  if (!undistort && must_move()) ensure_scaler(wish.alpha, errors);
  current_ = undistort ? undistorter_ : scaler_;
  return errors;
}

Result<Camera> FrameWarp::output_of(const Camera& camera) const {
  if (!current_) return camera;
  if (undistorts()) return current_->output();
  return moved(camera, current_->source(), current_->output());
}

Status FrameWarp::apply(const GstVideoFrame& in, const GstVideoFrame& out) const {
  // A buffer may carry a GstVideoMeta of another size than the caps.
  const auto size_of = [](const GstVideoFrame& frame) {
    return ImageSize{GST_VIDEO_FRAME_WIDTH(&frame), GST_VIDEO_FRAME_HEIGHT(&frame)};
  };
  if (!current_ || size_of(in) != current_->source().image_size() ||
      size_of(out) != current_->output().image_size()) {
    return make_error(ErrorCode::kInvalidArgument,
                      "A frame is not of the size that was negotiated.");
  }
  for (std::size_t i = 0; i < planes_.size(); ++i) {
    const auto source = memory_of(in, planes_[i]);
    current_->apply(i, {source.data, source.stride}, memory_of(out, planes_[i]));
  }
  return {};
}

}  // namespace calvin::gst
