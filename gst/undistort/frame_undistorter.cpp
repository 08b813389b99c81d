// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What happens to the frames of one stream: nothing, or scaling, or undistortion.

#include "undistort/frame_undistorter.hpp"

#include <array>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "common/frames/padded_frame.hpp"

namespace calvin::gst {

namespace {

// Bytes to the first sample of a part.
std::ptrdiff_t offset_of(const FramePart& part, const PlaneLayout& layout, std::ptrdiff_t stride) {
  return (part.y >> layout.subsampling.y_shift) * stride +
         (part.x >> layout.subsampling.x_shift) * layout.pixel_step;
}

// The first sample of a part covers what lies before it, where it begins on an odd pixel.
void begin_at(const FramePart& part, Subsampling& subsampling) {
  subsampling.x_before = part.x % (1 << subsampling.x_shift);
  subsampling.y_before = part.y % (1 << subsampling.y_shift);
}

// Where the samples lie that the kernels read or write: in the frame, or unpacked from it.
PlaneMemory<std::uint8_t> memory(const GstVideoFrame& frame, std::optional<UnpackedFrame>& unpacked,
                                 const FramePlane& plane) {
  return unpacked ? unpacked->plane(plane.plane) : memory_of(frame, plane);
}

}  // namespace

Status FrameUndistorter::start() {
  planes_.clear();
  return builder_.start();
}

void FrameUndistorter::stop() {
  builder_.stop();
  forget();
}

void FrameUndistorter::forget() {
  requested_.reset();
  failed_.reset();
  undistorter_ = {};
  scaler_ = {};
  current_.reset();
}

void FrameUndistorter::set_frames(const FrameFormat& in, const FrameFormat& out,
                                  const std::optional<FramePart>& part) {
  part_ = part;
  in_ = in;
  out_ = out;
  planes_ = planes_of(in, out);
  if (part) {
    for (FramePlane& plane : planes_) begin_at(*part, plane.layout.subsampling);
  }
  ++frames_;
  begun_ = false;
  forget();
}

void FrameUndistorter::tell_of_view(const Undistorter& view, std::vector<Error>& errors) {
  const auto tell = [&errors](std::string_view text) {
    errors.push_back({ErrorCode::kInvalidArgument, std::string(text)});
  };
  if (view.limited() && !limit_reported_) {
    tell(
        fmt::format("The view is wider than its projection can show and is limited: to {} degrees "
                    "where rectilinear. Set a smaller alpha, a larger zoom or another projection.",
                    150));
  }
  limit_reported_ = view.limited();
  const bool is_empty = !view.shows_any();
  if (is_empty && !empty_reported_) {
    tell(
        "The view shows nothing of the camera's picture: look less far aside or up (pan, tilt), or "
        "set another zoom.");
  }
  empty_reported_ = is_empty;
}

void FrameUndistorter::adopt(const UndistorterBuilder::Built& built, std::vector<Error>& errors) {
  // The worker may finish what was asked for before what is in use.
  if (built.turn < slot(built.key).turn) return;
  if (built.undistorter) {
    slot(built.key) = {built.key, *built.undistorter, built.turn};
    tell_of_view(**built.undistorter, errors);
    return;
  }
  failed_ = built.key;
  failure_ = built.undistorter.error();
  if (built.undistorter.error().code != ErrorCode::kCancelled) {
    errors.push_back(built.undistorter.error());
  }
}

// Puts what belongs to `key` to use as soon as it is there; until then what there is for the same
// lens, or what was in use.
void FrameUndistorter::want(const Key& key, const Result<Camera>& camera,
                            const std::shared_ptr<const Rectification>& rectification, bool wait,
                            std::vector<Error>& errors) {
  if (slot(key).key != key && requested_ != key && failed_ != key) {
    if (!camera) {
      adopt({key, tl::unexpected(camera.error()), ++turn_}, errors);
      return;
    }
    UndistorterBuilder::Request request = {key, *camera, rectification, {}, ++turn_};
    for (const FramePlane& plane : planes_) request.planes.push_back(plane.layout);
    if (wait) {
      adopt(builder_.build(request), errors);
    } else {
      requested_ = key;
      builder_.offer(std::move(request));
    }
  }
  const Made& have = slot(key);
  if (!have.built || have.key.lens != key.lens) return;
  current_ = have.built;
  undistorts_ = key.camera != 0;
}

FrameUndistorter::Key FrameUndistorter::key_of(int camera, int lens, const ViewOptions& view,
                                               bool distort) const {
  Key key = {frames_, camera, lens, view, distort};
  key.view.output = distort ? in_.size() : out_.size();
  return key;
}

bool FrameUndistorter::worth_waiting(const Key& key, const Request& request) {
  if (!request.live || !begun_) return true;
  const auto time = builder_.estimate(key);
  return time && *time < kQuick;
}

std::vector<Error> FrameUndistorter::update(const CalibrationInput& input, const Request& request) {
  std::vector<Error> errors;
  const bool undistort = request.undistort && input.camera();
  ViewOptions flat;
  flat.alpha = request.view.alpha;
  const Key plain = key_of(0, 0, flat, false);
  const Key key =
      undistort ? key_of(input.serial(), input.lens(), request.view, request.distort) : plain;
  sampling_ = request.sampling;
  workers_.resize(request.threads);
  scratch_.resize(static_cast<std::size_t>(request.threads));
  // What a worker was asked for with other frames or another lens comes too late. A lens that has
  // moved on meanwhile is nearer to where it stood then than to where it stood before.
  if (const auto built = builder_.take();
      built && built->key.frames == frames_ &&
      (built->key.camera == 0 || built->key.lens == input.lens())) {
    adopt(*built, errors);
  }
  const bool wait = worth_waiting(key, request);
  if (undistort) {
    want(key, *input.camera(), input.rectification(), wait, errors);
  } else if (must_move()) {
    want(key, plain_camera(in_.size()), nullptr, wait, errors);
  } else {
    current_.reset();
  }
  // Where an undistorter cannot be built the frames still have to come out in their size.
  if (must_move() && !current_) {
    want(plain, plain_camera(in_.size()), nullptr, true, errors);
  }
  return errors;
}

std::string FrameUndistorter::describe() const {
  if (!current_) return "passes frames as they are";
  const ImageSize from = current_->source().image_size();
  const ImageSize to = current_->output().image_size();
  return fmt::format("{} frames of {}x{} px to {}x{} by a map of {} bytes",
                     undistorts_ ? "undistorts" : "scales", from.width, from.height, to.width,
                     to.height, current_->map_bytes());
}

std::optional<Camera> FrameUndistorter::output_of(const std::optional<Camera>& camera) const {
  if (undistorts()) return current_->output_model();
  if (!camera || !current_) return camera;
  const auto output = reframed(*camera, current_->source(), current_->output());
  return output ? std::optional(*output) : std::nullopt;
}

Status FrameUndistorter::apply(const GstVideoFrame& in, const GstVideoFrame& out) const {
  if (!current_) return tl::unexpected(failure_);
  // A buffer may carry a GstVideoMeta of another size than the caps.
  const auto size_of = [](const GstVideoFrame& frame) {
    return ImageSize{GST_VIDEO_FRAME_WIDTH(&frame), GST_VIDEO_FRAME_HEIGHT(&frame)};
  };
  if (size_of(in) != (part_ ? part_->whole : current_->source().image_size()) ||
      size_of(out) != current_->output().image_size()) {
    return make_error(ErrorCode::kInvalidArgument,
                      "A frame is not of the size that was negotiated.");
  }
  const bool unpacks = needs_unpacking(in.info.finfo);
  if (unpacks && !can_pack_into(out)) {
    return make_error(ErrorCode::kUnsupported,
                      "Downstream wants frames whose pixels begin at odd places of memory: insert "
                      "videoconvert behind this element, with another format before it.");
  }
  if (!unpacks) {
    unpacked_in_.reset();
    unpacked_out_.reset();
  } else {
    unpack(in);
    if (!unpacked_out_ || !unpacked_out_->is_for(out.info)) unpacked_out_.emplace(out.info);
  }
  std::array<PlaneMemory<const std::uint8_t>, GST_VIDEO_MAX_COMPONENTS> sources;
  std::array<PlaneMemory<std::uint8_t>, GST_VIDEO_MAX_COMPONENTS> outputs;
  for (std::size_t i = 0; i < planes_.size(); ++i) {
    const auto source = memory(in, unpacked_in_, planes_[i]);
    sources[i] = {source.data, source.stride};
    if (part_) sources[i].data += offset_of(*part_, planes_[i].layout, source.stride);
    outputs[i] = memory(out, unpacked_out_, planes_[i]);
  }
  const auto from = std::span(sources).first(planes_.size());
  const auto to = std::span(outputs).first(planes_.size());
  workers_.run([&](int part, int parts) {
    Undistorter::Scratch& scratch = scratch_[static_cast<std::size_t>(part)];
    current_->apply(from, to, sampling_, part, parts, scratch);
  });
  if (unpacks) pack(out);
  return {};
}

void FrameUndistorter::unpack(const GstVideoFrame& in) const {
  if (!unpacked_in_ || !unpacked_in_->is_for(in.info)) unpacked_in_.emplace(in.info);
  std::optional<PaddedFrame> padded;
  if (needs_padding(in.info)) padded.emplace(in);
  const GstVideoFrame& from = padded ? **padded : in;
  workers_.run([&](int part, int parts) { unpacked_in_->unpack(from, part, parts); });
}

void FrameUndistorter::pack(const GstVideoFrame& out) const {
  if (!needs_padding(out.info)) {
    workers_.run([&](int part, int parts) { unpacked_out_->pack(out, part, parts); });
    return;
  }
  // A row goes beyond its end too, where the next one is written: one thread packs all, in order.
  PaddedFrame padded(out);
  unpacked_out_->pack(*padded, 0, 1);
  padded.copy_to(out);
}

}  // namespace calvin::gst
