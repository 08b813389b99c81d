// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What calibundistort does between two frames.

#include "undistort/undistort_state.hpp"

#include "common/calibration_event.hpp"
#include "common/frames/meta_filter.hpp"
#include "common/messages.hpp"

GST_DEBUG_CATEGORY_EXTERN(calibundistort_debug);
#define GST_CAT_DEFAULT calibundistort_debug

namespace calvin::gst {

Status UndistortState::start() {
  output.reset();
  second_time = false;
  tags.reset();
  Arrived stale;
  const std::string device = take_settings(stale).lens.device;
  fitted.reset();
  set_output_calibration("");
  gst_base_transform_set_passthrough(element, TRUE);
  for (const Error& error : input.start()) {
    if (error.code != ErrorCode::kNotFound) {
      input.stop();
      return tl::unexpected<Error>(error);
    }
    post_warning(GST_ELEMENT(element), error);
  }
  if (Status begun = lens.start(device, LensFollower::Clock::now()); !begun) {
    input.stop();
    return begun;
  }
  return undistorter.start();
}

void UndistortState::stop() {
  input.stop();
  lens.stop();
  undistorter.stop();
  output.reset();
  const std::lock_guard guard(lock_);
  shown_.reset();
}

void UndistortState::keep_event(EventPtr event) {
  const std::lock_guard guard(lock_);
  arrived_.calibration = std::move(event);
}

void UndistortState::keep_rig_event(EventPtr event) {
  const std::lock_guard guard(lock_);
  arrived_.rig = std::move(event);
}

std::shared_ptr<const Undistorter> UndistortState::shown() {
  const std::lock_guard guard(lock_);
  return shown_;
}

UndistortSettings UndistortState::take_settings(Arrived& arrived) {
  const std::lock_guard guard(lock_);
  if (std::exchange(settings_.calibration_was_set, false)) input.set_text(settings_.calibration);
  input.set_side(settings_.side());
  arrived = std::exchange(arrived_, {});
  return settings_;
}

void UndistortState::take_events(const Arrived& arrived) {
  const auto warn = [this](const Status& taken) {
    if (!taken) post_warning(GST_ELEMENT(element), taken.error());
  };
  if (arrived.calibration) warn(input.take_event(arrived.calibration.get()));
  if (arrived.rig) warn(input.take_rig_event(arrived.rig.get()));
}

std::string UndistortState::output_calibration() {
  const std::lock_guard guard(lock_);
  return output_calibration_;
}

void UndistortState::set_output_calibration(const std::string& json) {
  {
    const std::lock_guard guard(lock_);
    if (json == std::exchange(output_calibration_, json)) return;
  }
  g_object_notify(G_OBJECT(element), "output-calibration");
}

void UndistortState::announce() {
  EventPtr event = output.next(undistorter, input);
  if (!event) return;
  GST_DEBUG_OBJECT(element, "announces %" GST_PTR_FORMAT, static_cast<void*>(event.get()));
  const auto calibration = parse_calibration_event(event.get());
  gst_pad_push_event(GST_BASE_TRANSFORM_SRC_PAD(element), event.release());
  set_output_calibration(calibration ? calibration->json : "");
}

void UndistortState::fit_input() {
  std::pair wanted(distort ? out : in, distort ? std::nullopt : part);
  auto& [frames, shown_part] = wanted;
  if (shown_part) frames.info = with_size(frames.info, shown_part->size);
  if (fitted == wanted) return;
  input.set_frames(frames.info, shown_part);
  fitted = std::move(wanted);
}

std::vector<Error> UndistortState::follow_lens(const LensSettings& settings) {
  std::vector<Error> errors;
  lens.follow(LensFollower::Clock::now(), errors);
  input.set_position(settings.position(lens.lens()), lens.awaited());
  return errors;
}

void UndistortState::set_passthrough(bool passthrough) {
  if (passthrough == (gst_base_transform_is_passthrough(element) != FALSE)) return;
  gst_base_transform_set_passthrough(element, passthrough);
  // Upstream got downstream's buffers while the frames passed through.
  gst_base_transform_reconfigure_sink(element);
  gst_base_transform_reconfigure_src(element);
}

void UndistortState::warn_of_second_time() {
  if (second_time || !undistorter.undistorts() || undistorter.distorts()) return;
  if (!input.bends_twice()) return;
  second_time = true;
  post_warning(
      GST_ELEMENT(element),
      {ErrorCode::kInvalidArgument,
       "The frames are already undistorted by an element before this one, and its property "
       "calibration undistorts them once more. Remove one of the two elements, or leave "
       "the calibration of this one empty: it then knows what comes."});
}

void UndistortState::update() {
  renegotiated = false;
  Arrived arrived;
  const UndistortSettings now = take_settings(arrived);
  take_events(arrived);
  if (!live) live = upstream_is_live(GST_BASE_TRANSFORM_SINK_PAD(element));
  distort = now.view.distort();
  const int serial = input.serial();
  const auto before = undistorter.current();
  fit_input();
  std::vector<Error> errors = follow_lens(now.lens);
  const auto of_input = input.update(CalibrationReader::Clock::now());
  errors.insert(errors.end(), of_input.begin(), of_input.end());
  const ViewSettings& view = now.view;
  const auto more = undistorter.update(
      input, {now.enabled, view.view(), view.distort(), *live, view.sampling(), view.threads});
  errors.insert(errors.end(), more.begin(), more.end());
  for (const Error& error : errors) post_warning(GST_ELEMENT(element), error);
  warn_of_second_time();
  if (serial != input.serial()) {
    GST_INFO_OBJECT(element, "%s calibration", input.camera() ? "takes a" : "has no");
  }
  if (before != undistorter.current())
    GST_DEBUG_OBJECT(element, "%s", undistorter.describe().c_str());
  {
    const std::lock_guard guard(lock_);
    shown_ = undistorter.current();
  }
  set_passthrough(!undistorter.current() && !undistorter.must_move());
  announce();
}

void UndistortState::follow_crop(GstBuffer* buffer) {
  const auto now = part_of(buffer, in.info);
  if (now == std::exchange(part, now)) return;
  GST_DEBUG_OBJECT(element, "the frame is %s of the picture in memory", now ? "a part" : "all");
  FrameFormat cropped = in;
  if (now) cropped.info = with_size(in.info, now->size);
  undistorter.set_frames(cropped, out, now);
}

}  // namespace calvin::gst
