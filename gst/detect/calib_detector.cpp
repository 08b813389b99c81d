// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What calibdetect does.

#include "detect/calib_detector.hpp"

#include <algorithm>
#include <chrono>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "calvin/detect/brightness.hpp"
#include "calvin/detect/patches.hpp"
#include "common/frames/refused_caps.hpp"

GST_DEBUG_CATEGORY_EXTERN(calibdetect_debug);
#define GST_CAT_DEFAULT calibdetect_debug

namespace calvin::gst {

namespace {

// What a user has to know of a board that nobody named.
std::string taken_in_words(const Board& board) {
  return fmt::format(
      "This is taken for {}. No picture tells how large it is: measure it, and set the board with "
      "its true lengths where poses or distances matter.",
      board.text());
}

}  // namespace

GstStructure* CalibDetector::stats() {
  const std::lock_guard guard(lock_);
  return gst_structure_new("stats", "frames", G_TYPE_UINT64, frames_, "detections", G_TYPE_UINT64,
                           detections_, "skipped", G_TYPE_UINT64, skipped_, nullptr);
}

// ---- Settings and format ------------------------------------------------------------------------

Status CalibDetector::start() {
  {
    const std::lock_guard guard(lock_);
    settings_.board_changed = settings_.recheck_changed = true;
    patches_wanted_ = false;
    ++generation_;
    result_.reset();
    frames_ = detections_ = skipped_ = 0;
    hints_said_.clear();
    dark_frames_ = 0;
  }
  luma_.reset();
  async_ = mode_known_ = frame_refused_ = is_interlaced_ = false;
  last_detection_ = GST_CLOCK_TIME_NONE;
  if (Status started = start_boards(); !started) return started;
  if (Status started = start_recheck(); !started) return started;
  return worker_.start();
}

Status CalibDetector::start_boards() {
  std::string text;
  {
    const std::lock_guard guard(lock_);
    settings_.board_changed = false;
    ++boards_asked_for_;
    boards_found_.reset();
    text = settings_.board;
  }
  if (Status taken = take_boards(BoardsDetector::make(text)); !taken) return taken;
  return board_reader_.start();
}

Status CalibDetector::update_boards() {
  std::string text;
  bool changed = false;
  std::optional<Result<SharedDetector>> found;
  {
    const std::lock_guard guard(lock_);
    changed = std::exchange(settings_.board_changed, false);
    if (changed) {
      ++boards_asked_for_;
      boards_found_.reset();
      text = settings_.board;
    }
    found = std::exchange(boards_found_, std::nullopt);
  }
  if (changed && names_a_file(text)) {
    read_boards_beside(text);
  } else if (changed) {
    found = BoardsDetector::make(text);
  }
  return found ? take_boards(*std::move(found)) : Status();
}

void CalibDetector::read_boards_beside(const std::string& text) {
  board_reader_.offer([this, text, turn = boards_asked_for_](const std::stop_token& /*stop*/) {
    auto found = BoardsDetector::make(text);
    const std::lock_guard guard(lock_);
    if (turn == boards_asked_for_) boards_found_ = std::move(found);
  });
}

Status CalibDetector::take_boards(Result<SharedDetector> boards) {
  if (!boards) return tl::unexpected<Error>(boards.error());
  detector_ = *std::move(boards);
  for (const Board& board : detector_->boards()) {
    GST_INFO_OBJECT(element_, "looks for %s", board.text().c_str());
  }
  return {};
}

void CalibDetector::name_recheck() {
  std::string text;
  {
    const std::lock_guard guard(lock_);
    if (!std::exchange(settings_.recheck_changed, false)) return;
    text = settings_.recheck;
  }
  recheck_.set(text);
  if (text.empty()) check_.reset();
}

Status CalibDetector::start_recheck() {
  check_.reset();
  name_recheck();
  if (Status started = recheck_.start(); !started) return started;
  auto read = recheck_.read(CalibrationReader::Clock::now());
  return read ? take_recheck(*std::move(read)) : Status();
}

Status CalibDetector::update_recheck() {
  name_recheck();
  auto read = recheck_.poll(CalibrationReader::Clock::now());
  if (!read) return {};
  Status taken = take_recheck(*std::move(read));
  if (!taken && check_) taken.error().message += " The calibration that recheck had goes on.";
  return taken;
}

Status CalibDetector::take_recheck(CalibrationReader::ReadResult read) {
  if (!read) {
    return make_error(read.error().code,
                      "The calibration to check against (recheck): " + read.error().message);
  }
  auto* calibration = one_camera_of(*read);
  if (calibration == nullptr) {
    return make_error(ErrorCode::kInvalidArgument,
                      "The file to check against (recheck) is one of several cameras, or of a lens "
                      "that zooms: give the calibration of this camera as its lens stands.");
  }
  check_ = std::make_shared<CalibrationCheck>(std::move(*calibration));
  GST_INFO_OBJECT(element_, "holds boards against another calibration");
  return {};
}

Status CalibDetector::set_format(const GstVideoInfo& info) {
  luma_.reset();
  if (Status readable = read_pictures(info); !readable) return readable;
  const auto fields = explain_fields(info);
  if (fields && !is_interlaced_) post_warning(element_, *fields);
  is_interlaced_ = fields.has_value();
  info_ = info;
  times_.set_format(info);
  mode_known_ = frame_refused_ = false;
  return {};
}

Status CalibDetector::read_pictures(const GstVideoInfo& info) {
  const ImageSize size = {GST_VIDEO_INFO_WIDTH(&info), GST_VIDEO_INFO_HEIGHT(&info)};
  if (luma_ && size == luma_size_) return {};
  auto reader = LumaReader::make(info);
  if (!reader) return tl::unexpected<Error>(reader.error());
  luma_ = std::move(*reader);
  luma_size_ = size;
  GST_INFO_OBJECT(element_, "frames of %s, %dx%d px", GST_VIDEO_INFO_NAME(&info),
                  GST_VIDEO_INFO_WIDTH(&info), GST_VIDEO_INFO_HEIGHT(&info));
  return {};
}

void CalibDetector::choose_mode(bool live) {
  const DetectMode mode = settings().mode;
  mode_known_ = true;
  async_ = mode == kModeAsync || (mode == kModeAuto && live);
  if (async_) worker_.give_way();
  GST_INFO_OBJECT(element_, "the streaming thread %s", async_ ? "does not wait" : "waits");
}

// ---- Frames: on the streaming thread ------------------------------------------------------------

bool CalibDetector::is_due(const FrameTimes& times, double max_rate) {
  if (max_rate <= 0 || !GST_CLOCK_TIME_IS_VALID(times.running_time)) return true;
  const auto interval = static_cast<GstClockTime>(GST_SECOND / max_rate);
  const GstClockTime now = times.running_time;
  const GstClockTime last = last_detection_;
  // The beat may be ahead of the frames, by less than an interval.
  const bool in_step = GST_CLOCK_TIME_IS_VALID(last) && now + interval >= last;
  if (in_step && now + interval / 4 < last + interval) return false;
  // On the beat, so that a camera's jitter does not cost every other frame.
  const bool late = !in_step || now >= last + 2 * interval;
  last_detection_ = late ? now : last + interval;
  return true;
}

void CalibDetector::skip() {
  const std::lock_guard guard(lock_);
  ++skipped_;
}

Status CalibDetector::prepare(GstBuffer* buffer, Job& job) {
  job.part = part_of(buffer, info_);
  const GstVideoInfo whole = job.part ? with_size(info_, job.part->whole) : info_;
  auto frame = MappedFrame::map(whole, buffer);
  if (!frame) return tl::unexpected<Error>(frame.error());
  if (Status readable = read_pictures(whole); !readable) return readable;
  job.luma = luma_;
  job.picture = async_ ? luma_->keep(*std::move(frame)) : luma_->borrow(*std::move(frame));
  return {};
}

std::optional<FrameFindings> CalibDetector::look(GstBuffer* buffer, const FrameTimes& times) {
  for (const Status& updated : {update_boards(), update_recheck()}) {
    if (!updated) post_warning(element_, updated.error());
  }
  Job job{times, settings(), detector_, check_, nullptr, {}, {}, 0};
  {
    const std::lock_guard guard(lock_);
    ++frames_;
    job.generation = generation_;
    job.boards_asked_for = boards_asked_for_;
    job.patches = patches_wanted_;
  }
  // A frame that waited for a worker that is at another one would be stale when its turn came.
  if ((async_ && !worker_.idle()) || !is_due(times, job.settings.max_rate)) {
    GST_LOG_OBJECT(element_, "the frame at %" GST_TIME_FORMAT " is not looked at",
                   GST_TIME_ARGS(times.timestamp));
    skip();
    return std::nullopt;
  }
  if (const Status checked = prepare(buffer, job); !checked) {
    if (!std::exchange(frame_refused_, true)) post_warning(element_, checked.error());
    skip();
    return std::nullopt;
  }
  if (!async_) return wait_for(std::move(job));
  const auto shared = std::make_shared<const Job>(std::move(job));
  worker_.offer([this, shared](const std::stop_token& stop) {
    auto found = run(*shared, stop);
    const std::lock_guard guard(lock_);
    if (stop.stop_requested() || shared->generation != generation_) {
      GST_DEBUG_OBJECT(element_, "what was found at %" GST_TIME_FORMAT " comes too late",
                       GST_TIME_ARGS(shared->times.timestamp));
      return;
    }
    result_ = std::move(found);
  });
  return std::nullopt;
}

// The worker does it, so that a flush or a state change need not wait for what cannot be
// interrupted.
std::optional<FrameFindings> CalibDetector::wait_for(Job job) {
  const auto shared = std::make_shared<Job>(std::move(job));
  const auto found = std::make_shared<std::optional<FrameFindings>>();
  worker_.offer([this, shared, found](const std::stop_token& stop) {
    auto result = run(*shared, stop);
    shared->picture = {};
    if (!stop.stop_requested()) *found = std::move(result);
  });
  return worker_.drain() ? std::move(*found) : std::nullopt;
}

std::optional<FrameFindings> CalibDetector::take_waiting() {
  const std::lock_guard guard(lock_);
  return std::exchange(result_, std::nullopt);
}

void CalibDetector::next_format() {
  GST_DEBUG_OBJECT(element_, "another segment of the stream, or another format, begins");
  last_detection_ = GST_CLOCK_TIME_NONE;
  const std::lock_guard guard(lock_);
  ++generation_;
  result_.reset();
}

// ---- Detection: on the worker -------------------------------------------------------------------

FrameFindings CalibDetector::run(const Job& job, const std::stop_token& stop) {
  FrameFindings found;
  const ImageView image = frame_of(job.luma->view(job.picture), job.part);
  const auto begin = std::chrono::steady_clock::now();
  SharedDetector boards = job.detector;
  auto detections = boards->follow(image, job.times.timestamp, stop);
  if (SharedDetector taken = boards->identify(image, detections, stop)) {
    boards = std::move(taken);
    detections = boards->follow(image, job.times.timestamp, stop);
    take_board(job, boards, stop);
  }
  const auto taken = std::chrono::steady_clock::now() - begin;
  const bool dark = stays_dark(detections, image);
  const auto us = std::chrono::duration_cast<std::chrono::microseconds>(taken).count();
  for (Detection& detection : detections) {
    Observation& seen = detection.observation;
    seen.camera = job.settings.camera;
    seen.timestamp = job.times.timestamp;
    const Board* board = boards->board_of(detection);
    if (job.patches && board != nullptr) seen.patches = cut_patches(image, seen, *board);
    const DetectorHint hint = boards->hint_of(detection, dark);
    if (!stop.stop_requested()) {
      report(job, {detection, board, hint.words, static_cast<int>(found.observations.size())},
             static_cast<guint64>(us), stop);
    }
    if (found.hint.words.empty()) found.hint = hint;
    found.observations.push_back(std::move(seen));
  }
  const std::lock_guard guard(lock_);
  ++detections_;
  return found;
}

// The frames after this one are searched for the board that is in view.
void CalibDetector::take_board(const Job& job, const SharedDetector& boards,
                               const std::stop_token& stop) {
  {
    const std::lock_guard guard(lock_);
    if (stop.stop_requested() || job.boards_asked_for != boards_asked_for_) return;
    boards_found_ = boards;
  }
  const auto report = worker_.begin_report(stop, element_);
  if (report) post_info(element_, taken_in_words(boards->boards().front()));
}

bool CalibDetector::stays_dark(const std::vector<Detection>& detections, const ImageView& image) {
  constexpr int kWhile = 10;  // frames: the first ones of many cameras are black
  const auto is_found = [](const Detection& d) { return d.observation.found(); };
  const bool dark = std::ranges::none_of(detections, is_found) && is_too_dark(image);
  const std::lock_guard guard(lock_);
  dark_frames_ = dark ? std::min(dark_frames_ + 1, kWhile) : 0;
  return dark_frames_ >= kWhile;
}

bool CalibDetector::is_news(const Detection& detection, const std::string& hint, int place) {
  const std::lock_guard guard(lock_);
  if (detection.observation.found()) hints_said_.erase(place);
  const std::string news = detection.observation.board + " " + hint;
  return !hint.empty() && hints_said_[place].insert(news).second;
}

void CalibDetector::report(const Job& job, const Seen& seen, guint64 latency_us,
                           const std::stop_token& stop) {
  const Detection& detection = seen.detection;
  const Observation& o = detection.observation;
  GST_LOG_OBJECT(element_,
                 "%s on the frame at %" GST_TIME_FORMAT ": %s, %" G_GSIZE_FORMAT
                 " corners, %" G_GUINT64_FORMAT " us",
                 o.board.c_str(), GST_TIME_ARGS(job.times.timestamp),
                 std::string(to_string(detection.reason)).c_str(), o.ids.size(), latency_us);
  const bool is_news = this->is_news(detection, seen.hint, seen.place);
  if (job.settings.post_messages || is_news) {
    GstStructure* s = new_message("calib-detection", job.times, o.camera);
    gst_structure_set(s, "board", G_TYPE_STRING, o.board.c_str(), "found", G_TYPE_BOOLEAN,
                      o.found(), "points", G_TYPE_INT, static_cast<int>(o.ids.size()), "total",
                      G_TYPE_INT, seen.board != nullptr ? seen.board->point_count() : 0, "index",
                      G_TYPE_INT, seen.place, "reason", G_TYPE_STRING,
                      std::string(to_string(detection.reason)).c_str(), "latency-us", G_TYPE_UINT64,
                      latency_us, nullptr);
    if (detection.seen_cols > 0) {
      const std::string size = fmt::format("{}x{}", detection.seen_cols, detection.seen_rows);
      gst_structure_set(s, "seen", G_TYPE_STRING, size.c_str(), nullptr);
    }
    if (!seen.hint.empty()) {
      gst_structure_set(s, "hint", G_TYPE_STRING, seen.hint.c_str(), nullptr);
    }
    post(s, stop);
  }
  if (job.check && o.found()) recheck(job, {o, *seen.board}, seen.place, stop);
}

void CalibDetector::recheck(const Job& job, const View& view, int place,
                            const std::stop_token& stop) {
  std::vector<Error> warnings;
  GstStructure* checked = job.check->check(view, place, job.times, warnings);
  for (const Error& error : warnings) {
    if (const auto report = worker_.begin_report(stop, element_)) post_warning(element_, error);
  }
  if (checked == nullptr) return;
  gst_structure_set(checked, "index", G_TYPE_INT, place, nullptr);
  post(checked, stop);
}

void CalibDetector::post(GstStructure* message, const std::stop_token& stop) {
  if (const auto report = worker_.begin_report(stop, element_)) {
    post_message(element_, message);
  } else {
    gst_structure_free(message);
  }
}

}  // namespace calvin::gst
