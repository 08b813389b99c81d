// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calibdetect: finds boards in the frames that pass and attaches what it found.

/**
 * SECTION:element-calibdetect
 * @title: calibdetect
 *
 * Finds calibration boards and attaches the corners to the buffers as the custom meta
 * `calvin-observation`. Pixels are never touched and, on live pipelines, never waited for.
 *
 * ## Example launch line
 * |[
 * gst-launch-1.0 -m v4l2src ! calibdetect board=checkerboard:9x6:25mm post-messages=true ! fakesink
 * ]|
 */

#include <atomic>
#include <chrono>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gst/base/gstbasetransform.h>
#include <gst/video/video.h>

#include "calvin/detect/detector.hpp"
#include "calvin/target/board_names.hpp"
#include "elements.hpp"
#include "frame_check.hpp"
#include "frame_luma.hpp"
#include "messages.hpp"
#include "meta_filter.hpp"
#include "metas.hpp"
#include "properties.hpp"
#include "refused_caps.hpp"
#include "values.hpp"
#include "worker.hpp"

GST_DEBUG_CATEGORY_STATIC(calibdetect_debug);
#define GST_CAT_DEFAULT calibdetect_debug

enum DetectMode { kModeAuto, kModeSync, kModeAsync };

G_DECLARE_FINAL_TYPE(GstCalibDetect, gst_calib_detect, GST, CALIB_DETECT, GstBaseTransform)

namespace {

using namespace calvin;

struct Settings {
  std::string board{kDefaultBoard};
  std::string camera = "cam0";
  int mode = kModeAuto;
  double max_rate = 0;
  bool post_messages = false;
};

struct BoardDetector {
  Board board;
  std::unique_ptr<Detector> detector;
};
using Detectors = std::shared_ptr<const std::vector<BoardDetector>>;

// What one detection needs: whoever runs it, streaming thread or worker.
struct Job {
  gst::FrameTimes times;
  Settings settings;
  Detectors detectors;
  guint64 generation = 0;
};

struct State {
  std::mutex lock;
  Settings settings;                               // lock
  bool boards_changed = true;                      // lock
  std::optional<std::vector<Observation>> result;  // lock; waits for a buffer to ride on
  guint64 generation = 0;  // lock; of the stream: a result of an older stretch is thrown away
  guint64 frames = 0;      // lock, as the two below
  guint64 detections = 0;
  guint64 skipped = 0;

  gst::Worker worker;

  // Streaming thread only.
  gst::LumaReader luma;
  GstVideoInfo info{};
  bool have_info = false;
  bool async = false;
  bool mode_known = false;
  bool frame_refused = false;  // and the user was told so
  GstClockTime last_detection = GST_CLOCK_TIME_NONE;
  Detectors detectors;
};

}  // namespace

struct _GstCalibDetect {
  GstBaseTransform parent;
  State* state;
};

G_DEFINE_FINAL_TYPE(GstCalibDetect, gst_calib_detect, GST_TYPE_BASE_TRANSFORM)
GST_ELEMENT_REGISTER_DEFINE_WITH_CODE(calibdetect, "calibdetect", GST_RANK_NONE,
                                      gst_calib_detect_get_type(),
                                      GST_DEBUG_CATEGORY_INIT(calibdetect_debug, "calibdetect", 0,
                                                              "calibration board detector"))

enum { PROP_0, PROP_BOARD, PROP_CAMERA, PROP_MODE, PROP_MAX_RATE, PROP_POST_MESSAGES, PROP_STATS };

static GType gst_calib_detect_mode_get_type() {
  static const GEnumValue kValues[] = {
      {kModeAuto, "Async when the source is live, sync otherwise", "auto"},
      {kModeSync, "On the streaming thread: each frame carries its own corners", "sync"},
      {kModeAsync, "On a worker: newest frame only, corners ride on a later frame", "async"},
      {0, nullptr, nullptr}};
  static const GType kType = g_enum_register_static("GstCalibDetectMode", kValues);
  return kType;
}

static void gst_calib_detect_set_property(GObject* object, guint id, const GValue* value,
                                          GParamSpec* spec) {
  State* state = GST_CALIB_DETECT(object)->state;
  const std::lock_guard guard(state->lock);
  switch (id) {
    case PROP_BOARD:
      state->settings.board = gst::string_of(value);
      state->boards_changed = true;
      break;
    case PROP_CAMERA:
      state->settings.camera = gst::string_of(value);
      break;
    case PROP_MODE:
      state->settings.mode = g_value_get_enum(value);
      break;
    case PROP_MAX_RATE:
      state->settings.max_rate = g_value_get_double(value);
      break;
    case PROP_POST_MESSAGES:
      state->settings.post_messages = g_value_get_boolean(value);
      break;
    default:
      G_OBJECT_WARN_INVALID_PROPERTY_ID(object, id, spec);
  }
}

static void gst_calib_detect_get_property(GObject* object, guint id, GValue* value,
                                          GParamSpec* spec) {
  State* state = GST_CALIB_DETECT(object)->state;
  const std::lock_guard guard(state->lock);
  switch (id) {
    case PROP_BOARD:
      gst::set_string(value, state->settings.board);
      break;
    case PROP_CAMERA:
      gst::set_string(value, state->settings.camera);
      break;
    case PROP_MODE:
      g_value_set_enum(value, state->settings.mode);
      break;
    case PROP_MAX_RATE:
      g_value_set_double(value, state->settings.max_rate);
      break;
    case PROP_POST_MESSAGES:
      g_value_set_boolean(value, state->settings.post_messages);
      break;
    case PROP_STATS:
      g_value_take_boxed(
          value, gst_structure_new("stats", "frames", G_TYPE_UINT64, state->frames, "detections",
                                   G_TYPE_UINT64, state->detections, "skipped", G_TYPE_UINT64,
                                   state->skipped, nullptr));
      break;
    default:
      G_OBJECT_WARN_INVALID_PROPERTY_ID(object, id, spec);
  }
}

// Reads the board property again where it changed. Keeps the old boards on an error.
static Status gst_calib_detect_update_boards(GstCalibDetect* self) {
  State* state = self->state;
  std::string text;
  {
    const std::lock_guard guard(state->lock);
    if (!state->boards_changed) return {};
    state->boards_changed = false;
    text = state->settings.board;
  }
  const auto boards = parse_boards(text);
  if (!boards) return make_error(boards.error().code, boards.error().message);
  auto detectors = std::make_shared<std::vector<BoardDetector>>();
  for (const Board& board : *boards) {
    auto detector = make_detector(board);
    if (!detector) return make_error(detector.error().code, detector.error().message);
    detectors->push_back({board, std::move(*detector)});
  }
  state->detectors = std::move(detectors);
  return {};
}

static void gst_calib_detect_post(GstCalibDetect* self, const Job& job, const Detection& detection,
                                  const Board& board, guint64 latency_us) {
  const Observation& o = detection.observation;
  GstStructure* s = gst::new_message("calib-detection", job.times, job.settings.camera);
  gst_structure_set(s, "board", G_TYPE_STRING, o.board.c_str(), "found", G_TYPE_BOOLEAN, o.found(),
                    "points", G_TYPE_INT, static_cast<int>(o.ids.size()), "total", G_TYPE_INT,
                    board.point_count(), "reason", G_TYPE_STRING,
                    std::string(to_string(detection.reason)).c_str(), "latency-us", G_TYPE_UINT64,
                    latency_us, nullptr);
  gst::post_message(GST_ELEMENT(self), s);
}

// Runs every detector over one picture. Streaming thread or worker, never both at once.
static std::vector<Observation> gst_calib_detect_run(GstCalibDetect* self, const Job& job,
                                                     const ImageView& image, std::stop_token stop) {
  std::vector<Observation> found;
  for (const auto& [board, detector] : *job.detectors) {
    const auto begin = std::chrono::steady_clock::now();
    Detection detection = detector->detect(image, stop);
    const auto taken = std::chrono::steady_clock::now() - begin;
    detection.observation.camera = job.settings.camera;
    detection.observation.board = board.text();
    detection.observation.timestamp = job.times.timestamp;
    detection.observation.image_size = image.size();
    if (job.settings.post_messages && !stop.stop_requested()) {
      const auto us = std::chrono::duration_cast<std::chrono::microseconds>(taken).count();
      gst_calib_detect_post(self, job, detection, board, static_cast<guint64>(us));
    }
    found.push_back(std::move(detection.observation));
  }
  const std::lock_guard guard(self->state->lock);
  ++self->state->detections;
  return found;
}

static void gst_calib_detect_offer(GstCalibDetect* self, Job job, const ImageView& image) {
  auto copy = std::make_shared<GrayImage>(image.width, image.height);
  for (int y = 0; y < image.height; ++y) {
    std::uint8_t* row = copy->row(y);
    const std::uint8_t* from = image.data + y * image.stride;
    if (image.step == 1) {
      std::copy_n(from, image.width, row);
    } else {
      for (int x = 0; x < image.width; ++x) row[x] = from[x * image.step];
    }
  }
  self->state->worker.offer([self, job = std::move(job), copy](std::stop_token stop) {
    auto found = gst_calib_detect_run(self, job, copy->view(), stop);
    const std::lock_guard guard(self->state->lock);
    if (stop.stop_requested() || job.generation != self->state->generation) return;
    self->state->result = std::move(found);
  });
}

// Asks once after each CAPS: only then does a live source know that it is one.
static void gst_calib_detect_choose_mode(GstCalibDetect* self, int mode) {
  State* state = self->state;
  if (state->mode_known) return;
  state->mode_known = true;
  const bool async =
      mode == kModeAsync || (mode == kModeAuto && gst::upstream_is_live(GST_BASE_TRANSFORM(self)));
  if (state->async && !async) state->worker.drain();  // the detectors change hands
  state->async = async;
  GST_INFO_OBJECT(self, "detecting %s", async ? "on the worker" : "on the streaming thread");
}

static bool gst_calib_detect_is_due(State* state, const gst::FrameTimes& times, double max_rate) {
  if (max_rate <= 0 || !GST_CLOCK_TIME_IS_VALID(times.running_time)) return true;
  const auto interval = static_cast<GstClockTime>(GST_SECOND / max_rate);
  const GstClockTime now = times.running_time;
  const GstClockTime last = state->last_detection;
  // The beat may be ahead of the frames, by less than an interval.
  const bool in_step = GST_CLOCK_TIME_IS_VALID(last) && now + interval >= last;
  if (in_step && now + interval / 4 < last + interval) return false;
  // On the beat, so that a camera's jitter does not cost every other frame.
  const bool late = !in_step || now >= last + 2 * interval;
  state->last_detection = late ? now : last + interval;
  return true;
}

// Detects on this frame, or hands it to the worker. Empty: nothing to attach from this frame.
static std::optional<std::vector<Observation>> gst_calib_detect_look(GstCalibDetect* self,
                                                                     const Job& job,
                                                                     GstBuffer* buffer) {
  State* state = self->state;
  GstVideoFrame frame;
  if (const Status checked = gst::check_frame(state->info, buffer); !checked) {
    if (!std::exchange(state->frame_refused, true)) {
      gst::post_warning(GST_ELEMENT(self), checked.error());
    }
    return std::nullopt;
  }
  if (!gst_video_frame_map(&frame, &state->info, buffer, GST_MAP_READ)) return std::nullopt;
  std::optional<std::vector<Observation>> found;
  const ImageView image = state->luma.view(frame);
  if (state->async) {
    gst_calib_detect_offer(self, job, image);
  } else {
    found = gst_calib_detect_run(self, job, image, {});
  }
  gst_video_frame_unmap(&frame);
  return found;
}

static GstFlowReturn gst_calib_detect_transform_ip(GstBaseTransform* trans, GstBuffer* buffer) {
  GstCalibDetect* self = GST_CALIB_DETECT(trans);
  State* state = self->state;
  if (!state->have_info) {
    gst::post_error(GST_ELEMENT(self),
                    {ErrorCode::kMalformed,
                     "A frame came before the caps that say what it is: set the caps upstream, "
                     "with caps=... of appsrc or a capsfilter."});
    return GST_FLOW_NOT_NEGOTIATED;
  }
  if (const Status updated = gst_calib_detect_update_boards(self); !updated) {
    gst::post_warning(GST_ELEMENT(self), updated.error());
  }

  Job job;
  job.times = gst::frame_times(&trans->segment, buffer);
  job.detectors = state->detectors;
  std::optional<std::vector<Observation>> result;
  {
    const std::lock_guard guard(state->lock);
    job.settings = state->settings;
    job.generation = state->generation;
    ++state->frames;
    result = std::exchange(state->result, std::nullopt);
  }
  gst_calib_detect_choose_mode(self, job.settings.mode);
  if (gst_calib_detect_is_due(state, job.times, job.settings.max_rate)) {
    if (auto now = gst_calib_detect_look(self, job, buffer)) result = std::move(now);
  } else {
    const std::lock_guard guard(state->lock);
    ++state->skipped;
  }
  if (result) gst::attach_observations(buffer, *result);
  return GST_FLOW_OK;
}

static gboolean gst_calib_detect_set_caps(GstBaseTransform* trans, GstCaps* caps,
                                          GstCaps* /*out_caps*/) {
  GstCalibDetect* self = GST_CALIB_DETECT(trans);
  State* state = self->state;
  state->have_info = false;
  if (!gst_video_info_from_caps(&state->info, caps)) return FALSE;
  if (const Status set = state->luma.set_format(state->info); !set) {
    gst::post_error(GST_ELEMENT(self), set.error());
    return FALSE;
  }
  state->have_info = true;
  state->mode_known = false;
  state->frame_refused = false;
  return TRUE;
}

// A result that no buffer took goes ahead of the event that ends its stretch of the stream.
static void gst_calib_detect_push_waiting(GstCalibDetect* self) {
  std::optional<std::vector<Observation>> result;
  {
    const std::lock_guard guard(self->state->lock);
    result = std::exchange(self->state->result, std::nullopt);
  }
  if (!result) return;
  gst_pad_push_event(
      GST_BASE_TRANSFORM_SRC_PAD(self),
      gst_event_new_custom(GST_EVENT_CUSTOM_DOWNSTREAM, gst::observations_to_structure(*result)));
}

// From here on another format or other times apply: what is still being computed is of no use.
static void gst_calib_detect_next_stretch(GstCalibDetect* self) {
  State* state = self->state;
  state->last_detection = GST_CLOCK_TIME_NONE;
  const std::lock_guard guard(state->lock);
  ++state->generation;
  state->result.reset();
}

static gboolean gst_calib_detect_sink_event(GstBaseTransform* trans, GstEvent* event) {
  GstCalibDetect* self = GST_CALIB_DETECT(trans);
  State* state = self->state;
  switch (GST_EVENT_TYPE(event)) {
    case GST_EVENT_EOS:
      state->worker.drain();
      gst_calib_detect_push_waiting(self);
      break;
    case GST_EVENT_CAPS:
    case GST_EVENT_SEGMENT:
      gst_calib_detect_push_waiting(self);
      gst_calib_detect_next_stretch(self);
      break;
    case GST_EVENT_FLUSH_START:
      state->worker.cancel();
      break;
    case GST_EVENT_FLUSH_STOP: {
      state->worker.resume();
      gst_calib_detect_next_stretch(self);
      break;
    }
    default:
      break;
  }
  return GST_BASE_TRANSFORM_CLASS(gst_calib_detect_parent_class)->sink_event(trans, event);
}

static gboolean gst_calib_detect_start(GstBaseTransform* trans) {
  GstCalibDetect* self = GST_CALIB_DETECT(trans);
  State* state = self->state;
  {
    const std::lock_guard guard(state->lock);
    state->boards_changed = true;
    state->result.reset();
    state->frames = state->detections = state->skipped = 0;
  }
  state->have_info = false;
  state->async = false;
  state->last_detection = GST_CLOCK_TIME_NONE;
  if (const Status updated = gst_calib_detect_update_boards(self); !updated) {
    gst::post_error(GST_ELEMENT(self), updated.error());
    return FALSE;
  }
  state->worker.start();
  return TRUE;
}

static gboolean gst_calib_detect_stop(GstBaseTransform* trans) {
  GST_CALIB_DETECT(trans)->state->worker.stop();
  return TRUE;
}

static GstStateChangeReturn gst_calib_detect_change_state(GstElement* element,
                                                          GstStateChange change) {
  // Before the pads are deactivated: that waits for the streaming thread, which may be draining.
  if (change == GST_STATE_CHANGE_PAUSED_TO_READY) GST_CALIB_DETECT(element)->state->worker.cancel();
  return GST_ELEMENT_CLASS(gst_calib_detect_parent_class)->change_state(element, change);
}

static void gst_calib_detect_finalize(GObject* object) {
  delete GST_CALIB_DETECT(object)->state;
  G_OBJECT_CLASS(gst_calib_detect_parent_class)->finalize(object);
}

static void gst_calib_detect_init(GstCalibDetect* self) {
  self->state = new State;
  gst::configure_meta_filter(GST_BASE_TRANSFORM(self));
  gst::explain_refused_caps(GST_ELEMENT(self));
}

static void gst_calib_detect_install_properties(GObjectClass* object_class) {
  g_object_class_install_property(
      object_class, PROP_BOARD,
      g_param_spec_string("board", "Board",
                          "The board to find, KIND:COLSxROWS:SIZE with inner corners and the side "
                          "of a square, or FILE.json#NAME; several separated by ;",
                          kDefaultBoard.data(), gst::kMutablePlaying));
  g_object_class_install_property(
      object_class, PROP_CAMERA,
      g_param_spec_string("camera", "Camera", "Name of the camera in metas, messages and files",
                          "cam0", gst::kMutablePlaying));
  g_object_class_install_property(
      object_class, PROP_MODE,
      g_param_spec_enum("mode", "Mode",
                        "Where boards are looked for; asked again at each new format",
                        gst_calib_detect_mode_get_type(), kModeAuto, gst::kMutablePlaying));
  g_object_class_install_property(
      object_class, PROP_MAX_RATE,
      g_param_spec_double("max-rate", "Maximum Rate",
                          "Frames per second of running time to look at, at the most (0 = all)", 0,
                          1000, 0, gst::kMutablePlaying));
  g_object_class_install_property(
      object_class, PROP_POST_MESSAGES,
      g_param_spec_boolean("post-messages", "Post Messages",
                           "Post a calib-detection message for every board and frame looked at",
                           FALSE, gst::kMutablePlaying));
  g_object_class_install_property(
      object_class, PROP_STATS,
      g_param_spec_boxed("stats", "Statistics",
                         "Counts since start: frames, detections, skipped (by max-rate)",
                         GST_TYPE_STRUCTURE, gst::kReadOnly));
  gst_type_mark_as_plugin_api(gst_calib_detect_mode_get_type(), static_cast<GstPluginAPIFlags>(0));
}

static void gst_calib_detect_class_init(GstCalibDetectClass* klass) {
  auto* object_class = G_OBJECT_CLASS(klass);
  auto* element_class = GST_ELEMENT_CLASS(klass);
  auto* trans_class = GST_BASE_TRANSFORM_CLASS(klass);
  object_class->set_property = gst_calib_detect_set_property;
  object_class->get_property = gst_calib_detect_get_property;
  object_class->finalize = gst_calib_detect_finalize;
  element_class->change_state = gst_calib_detect_change_state;
  trans_class->start = gst_calib_detect_start;
  trans_class->stop = gst_calib_detect_stop;
  trans_class->set_caps = gst_calib_detect_set_caps;
  trans_class->sink_event = gst_calib_detect_sink_event;
  trans_class->prepare_output_buffer = gst::share_input_buffer;
  trans_class->propose_allocation = gst::propose_uncropped_allocation;
  trans_class->transform_ip = gst_calib_detect_transform_ip;
  trans_class->transform_ip_on_passthrough = TRUE;
  gst_calib_detect_install_properties(object_class);
  gst::add_raw_video_pads(element_class);
  gst_element_class_set_static_metadata(
      element_class, "Calibration board detector", "Filter/Analyzer/Video",
      "Finds calibration boards and attaches their corners to the frames",
      "The gst-calvin authors");
}
