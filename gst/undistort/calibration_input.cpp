// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Which camera the frames come from.

#include "undistort/calibration_input.hpp"

#include <algorithm>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "calvin/camera/usable_area.hpp"
#include "calvin/camera/zoom_interpolation.hpp"
#include "calvin/io/calibration_io.hpp"
#include "calvin/io/rig_io.hpp"
#include "common/calibration_event.hpp"
#include "common/frames/frame_planes.hpp"
#include "common/rig_event.hpp"
#include "common/values.hpp"

namespace calvin::gst {

namespace {

// The event of GStreamer's cameracalibrate, whose text is in OpenCV's format.
bool is_peers(GstEvent* event) {
  return GST_EVENT_TYPE(event) == GST_EVENT_CUSTOM_BOTH &&
         gst_event_has_name(event, "GstEventCalibrated");
}

Result<CalibrationEvent> parse_event(GstEvent* event) {
  const GstStructure* s = gst_event_get_structure(event);
  const char* field = is_peers(event) ? "undistort-settings" : "json";
  if (!gst_structure_has_field_typed(s, field, G_TYPE_STRING)) {
    return make_error(ErrorCode::kMalformed,
                      fmt::format("The event {} has no text in its field '{}' and changes nothing. "
                                  "Whoever sends it must put the calibration there.",
                                  gst_structure_get_name(s), field));
  }
  const auto own = parse_calibration_event(event);
  return CalibrationEvent{get_string(s, "camera"), get_string(s, field), own && own->undistorted};
}

// Why a setting of which rig_of() is nullptr rectifies nothing.
Error no_pair_in(const CameraSetting& setting) {
  if (const auto* stereo = std::get_if<StereoFile>(&setting)) {
    const Error& error = stereo->pair.error();
    return {error.code, error.message + " Until then frames pass unchanged."};
  }
  return {ErrorCode::kInvalidArgument,
          "The calibration is that of one camera, and rectification wants a pair: give the file "
          "that calvin-rig or calibrig wrote, or set rectify=none. Until then frames pass "
          "unchanged."};
}

}  // namespace

std::vector<Error> CalibrationInput::start() {
  from_setting_.reset();
  from_event_.reset();
  from_rig_event_.reset();
  event_.reset();
  comes_undistorted_ = false;
  frames_ = {};
  part_.reset();
  upright_ = {};
  camera_.reset();
  position_ = {};
  changed_ = true;
  moved_ = new_ = poor_ = said_outside_ = false;
  setting_.set(text_);
  if (const Status started = setting_.start(); !started) return {started.error()};
  std::vector<Error> errors;
  if (auto read = setting_.read(CalibrationReader::Clock::now())) take(*std::move(read), errors);
  return errors;
}

void CalibrationInput::set_text(const std::string& text) {
  // Without a text the event is in force at once; a new text is so when it has been read.
  if (text.empty() && !text_.empty()) changed_ = new_ = true;
  text_ = text;
  if (text_.empty()) from_setting_.reset();
  setting_.set(text_);
  said_.clear();
  said_outside_ = false;
}

void CalibrationInput::set_frames(const GstVideoInfo& info, const std::optional<FramePart>& part) {
  part_ = part;
  frames_ = {GST_VIDEO_INFO_WIDTH(&info), GST_VIDEO_INFO_HEIGHT(&info)};
  interlaced_ = GST_VIDEO_INFO_IS_INTERLACED(&info);
  camera_.reset();
  changed_ = true;
  if (!part) said_.clear();  // a part may move with every frame
}

void CalibrationInput::set_upright(Orientation upright) {
  if (upright == std::exchange(upright_, upright)) return;
  camera_.reset();
  changed_ = true;
}

void CalibrationInput::set_side(std::optional<StereoSide> side) {
  if (side == std::exchange(side_, side)) return;
  camera_.reset();
  changed_ = new_ = true;
  said_.clear();
}

void CalibrationInput::set_position(const LensPosition& position, bool awaited) {
  const bool same_wait = awaited == std::exchange(position_awaited_, awaited);
  if (position == std::exchange(position_, position) && same_wait) return;
  const auto& source = in_force();
  moved_ = moved_ || (source && std::holds_alternative<ZoomTable>(*source));
}

bool CalibrationInput::is_calibration(GstEvent* event) {
  return is_peers(event) || parse_calibration_event(event).has_value();
}

Status CalibrationInput::take_event(GstEvent* event) {
  const auto parsed = parse_event(event);
  if (!parsed) return tl::unexpected(parsed.error());
  std::optional<Calibration> calibration;
  if (!parsed->json.empty()) {
    auto read = parse_calibration(parsed->json);
    if (!read) return tl::unexpected(read.error());
    calibration = *std::move(read);
    if (!parsed->camera.empty()) calibration->camera = parsed->camera;
  }
  event_.reset(gst_event_ref(event));
  comes_undistorted_ = parsed->undistorted;
  from_event_ = std::move(calibration);
  if (&in_force() == &from_event_) changed_ = new_ = true;
  return {};
}

// A second element that only turns the view has a pinhole, or a fisheye without coefficients.
bool CalibrationInput::bends_twice() const {
  if (!comes_undistorted_ || text_.empty() || !camera_) return false;
  const auto parameters = std::span(camera_->parameters());
  return std::ranges::any_of(parameters.subspan(4), [](double value) { return value != 0; });
}

Status CalibrationInput::take_rig_event(GstEvent* event) {
  auto read = parse_rig(parse_rig_event(event).value_or(""));
  if (!read) return tl::unexpected(read.error());
  from_rig_event_ = *std::move(read);
  if (&in_force() == &from_rig_event_) changed_ = new_ = true;
  return {};
}

void CalibrationInput::take(CalibrationReader::ReadResult read, std::vector<Error>& errors) {
  if (read) {
    from_setting_ = *std::move(read);
    changed_ = new_ = true;
    said_outside_ = false;
    return;
  }
  errors.push_back(std::move(read.error()));
  std::string& message = errors.back().message;
  if (errors.back().code == ErrorCode::kNotFound) {
    message += from_setting_
                   ? " Until it appears again the calibration that there was stays in force."
                   : " Until it appears, frames go on as they are, not undistorted.";
  }
}

std::vector<Error> CalibrationInput::update(CalibrationReader::Clock::time_point now) {
  std::vector<Error> errors;
  if (auto read = setting_.poll(now)) take(*std::move(read), errors);
  if ((changed_ || moved_) && frames_.width > 0) {
    fit(errors);
    changed_ = moved_ = false;
  }
  return errors;
}

void CalibrationInput::count_change() {
  ++serial_;
  if (changed_) ++lens_;
}

void CalibrationInput::report(Error error, std::vector<Error>& errors) {
  if (error.message == said_) return;
  said_ = error.message;
  errors.push_back(std::move(error));
}

// Once for each calibration: the frames may be another part of it every time. Of many poor ones, as
// the first solves of a stream may give, only the first one is said.
void CalibrationInput::judge(const Calibration& known, std::vector<Error>& errors) {
  if (!std::exchange(new_, false)) return;
  const auto camera = Camera::make(known);
  if (!camera) return;
  const Status usable = check_usable_area(*camera);
  if (!usable && !poor_) errors.push_back(usable.error());
  poor_ = !usable;
}

std::optional<CameraSetting>& CalibrationInput::in_force() {
  if (!text_.empty()) return from_setting_;
  return side_ ? from_rig_event_ : from_event_;
}

// The calibration of the frames; nullptr where there is none.
Calibration* CalibrationInput::known(std::vector<Error>& errors) {
  std::optional<CameraSetting>& source = in_force();
  if (!source) return nullptr;
  return side_ ? camera_of_pair(*source, errors) : single_camera(*source, errors);
}

Calibration* CalibrationInput::single_camera(CameraSetting& source, std::vector<Error>& errors) {
  if (Calibration* calibration = one_camera_of(source)) return calibration;
  const auto* table = std::get_if<ZoomTable>(&source);
  if (table != nullptr) return where_it_stands(*table, errors);
  report({ErrorCode::kInvalidArgument,
          "The calibration is a rig: say with rectify=left or rectify=right which of its cameras "
          "the frames are of, or give the calibration of that camera alone. Until then they pass "
          "unchanged."},
         errors);
  return nullptr;
}

Calibration* CalibrationInput::camera_of_pair(CameraSetting& source, std::vector<Error>& errors) {
  Rig* rig = rig_of(source);
  if (rig == nullptr) {
    report(no_pair_in(source), errors);
    return nullptr;
  }
  const auto own = camera_of_side(*rig, *side_);
  if (own) return &rig->cameras[*own].calibration;
  report(own.error(), errors);
  return nullptr;
}

Calibration* CalibrationInput::where_it_stands(const ZoomTable& table, std::vector<Error>& errors) {
  auto found = interpolate(table, position_);
  if (!found) {
    if (position_awaited_) return nullptr;
    report({found.error().code,
            found.error().message +
                " Set zoom-position (and focus-position), or device to the node of a V4L2 camera "
                "that tells its zoom_absolute. Until then the frames pass unchanged."},
           errors);
    return nullptr;
  }
  if (!found->remark.empty() && !std::exchange(said_outside_, true)) {
    errors.push_back({ErrorCode::kInvalidArgument, std::move(found->remark)});
  }
  at_position_ = std::move(found->calibration);
  return &*at_position_;
}

void CalibrationInput::report_scaling(const Calibration& known, std::vector<Error>& errors) {
  if (known.sensor_crop) {
    report({ErrorCode::kInvalidArgument,
            fmt::format("The sensor_crop of the calibration, {}x{} px, is scaled to the frames of "
                        "{}x{}.",
                        known.sensor_crop->width, known.sensor_crop->height, frames_.width,
                        frames_.height)},
           errors);
    return;
  }
  report(
      {ErrorCode::kInvalidArgument,
       fmt::format("The calibration is for {}x{} px and is scaled to the frames of "
                   "{}x{}. That is right where the camera scales its whole picture; "
                   "where it shows a part of it, add sensor_crop to the calibration.",
                   known.image_size.width, known.image_size.height, frames_.width, frames_.height)},
      errors);
}

Status CalibrationInput::set_camera(const FittedCamera& fitted) {
  std::shared_ptr<const Rectification> rectification;
  if (side_) {
    if (part_ || fitted.turned) {
      return make_error(ErrorCode::kUnsupported,
                        "Rectification takes whole frames as the camera gives them: put cropping "
                        "and turning behind this element. Until then frames pass unchanged.");
    }
    auto sights = rectified_sights(*rig_of(*in_force()), *side_, frames_);
    if (!sights) return tl::unexpected(sights.error());
    const std::size_t own = *side_ == StereoSide::kLeft ? 0 : 1;
    rectification = std::make_shared<const Rectification>(Rectification{*std::move(sights), own});
  }
  rectification_ = std::move(rectification);
  camera_ = fitted.camera;
  return {};
}

void CalibrationInput::fit(std::vector<Error>& errors) {
  Calibration* of_frames = known(errors);
  if (of_frames == nullptr) {
    camera_.reset();
    count_change();
    return;
  }
  if (interlaced_) {
    report({ErrorCode::kUnsupported,
            "The video is interlaced, its fields show different moments: insert deinterlace before "
            "this element. Until then the frames pass unchanged."},
           errors);
    return;
  }
  if (!has_extent(frames_)) {
    report(
        {ErrorCode::kUnsupported,
         fmt::format("Frames of {}x{} px are too small to be undistorted and pass unchanged: they "
                     "need at least two columns and two rows.",
                     frames_.width, frames_.height)},
        errors);
    return;
  }
  // A calibration that does not say its size is taken to be for the frames that it meets first:
  // nothing tells later which of two sizes it is right for.
  if (of_frames->image_size == ImageSize{}) of_frames->image_size = frames_;
  const auto fitted = part_ ? fit_to_part(*of_frames, *part_, upright_)
                            : fit_to_frame(*of_frames, frames_, upright_);
  if (!fitted) {
    report(fitted.error(), errors);
    return;
  }
  if (fitted->scaled) report_scaling(*of_frames, errors);
  judge(*of_frames, errors);
  if (const Status taken = set_camera(*fitted); !taken) {
    report(taken.error(), errors);
    return;
  }
  name_ = of_frames->camera;
  count_change();
}

}  // namespace calvin::gst
