// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calibtestsrc: a camera that does not exist, pointed at a board.

/**
 * SECTION:element-calibtestsrc
 * @title: calibtestsrc
 *
 * Renders a calibration board as a camera would see it: any lens model, blur and noise, along a
 * motion of the board. Each buffer carries the exact corners and the pose as the custom meta
 * `calvin-ground-truth`.
 *
 * ## Example launch line
 * |[
 * gst-launch-1.0 -m calibtestsrc num-buffers=300 ! calibrate location=cam.json ! fakesink
 * ]|
 */

#include <algorithm>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include <gst/base/gstpushsrc.h>
#include <gst/video/video.h>

#include "calvin/io/calibration_io.hpp"
#include "elements.hpp"
#include "luma_writer.hpp"
#include "messages.hpp"
#include "metas.hpp"
#include "properties.hpp"
#include "test_scene.hpp"

GST_DEBUG_CATEGORY_STATIC(calibtestsrc_debug);
#define GST_CAT_DEFAULT calibtestsrc_debug

G_DECLARE_FINAL_TYPE(GstCalibTestSrc, gst_calib_test_src, GST, CALIB_TEST_SRC, GstPushSrc)

namespace {

using namespace calvin;

constexpr char kCaps[] =
    "video/x-raw, format = (string) { I420, NV12, YUY2, BGRx, GRAY8 }, "
    "width = (int) [ 16, 8192 ], height = (int) [ 16, 8192 ], "
    "framerate = (fraction) [ 1, 240 ], pixel-aspect-ratio = (fraction) 1/1, "
    "interlace-mode = (string) progressive";
constexpr ImageSize kDefaultSize = {640, 480};
constexpr double kDefaultNoise = 1;
constexpr double kDefaultBlur = 0.7;

struct Settings {
  gst::SceneSettings scene;
  RenderOptions render{.noise = kDefaultNoise, .blur = kDefaultBlur};
  std::string ground_truth;
};

struct State {
  std::mutex lock;
  Settings settings;    // lock
  GstVideoInfo info{};  // lock to write, and to read off the streaming thread

  // Streaming thread, and start() before it runs.
  gst::SceneSource source;
  std::optional<gst::TestScene> scene;  // of the present size
  gint64 frame = 0;                     // the number of the next one
  gint64 first_frame = 0;               // of the present format
  GstClockTime first_time = 0;          // its PTS
  GstClockTime position = 0;            // of the last seek
  bool reverse = false;
};

}  // namespace

struct _GstCalibTestSrc {
  GstPushSrc parent;
  State* state;
};

G_DEFINE_FINAL_TYPE(GstCalibTestSrc, gst_calib_test_src, GST_TYPE_PUSH_SRC)
GST_ELEMENT_REGISTER_DEFINE_WITH_CODE(calibtestsrc, "calibtestsrc", GST_RANK_NONE,
                                      gst_calib_test_src_get_type(),
                                      GST_DEBUG_CATEGORY_INIT(calibtestsrc_debug, "calibtestsrc", 0,
                                                              "synthetic calibration camera"))

enum {
  PROP_0,
  PROP_BOARD,
  PROP_CALIBRATION,
  PROP_MOTION,
  PROP_NOISE,
  PROP_BLUR,
  PROP_EXPOSURE,
  PROP_SEED,
  PROP_IS_LIVE,
  PROP_GROUND_TRUTH
};

static GType gst_calib_test_src_motion_get_type() {
  static const GEnumValue kValues[] = {
      {static_cast<int>(MotionKind::kRandom),
       "Independent poses all over the image: one per frame, when live one per 0.5 s", "random"},
      {static_cast<int>(MotionKind::kOrbit), "The camera circles the board in 10 s", "orbit"},
      {static_cast<int>(MotionKind::kHand), "A smooth path as of a board held by hand", "hand"},
      {static_cast<int>(MotionKind::kStatic), "One pose", "static"},
      {0, nullptr, nullptr}};
  static const GType kType = g_enum_register_static("GstCalibTestSrcMotion", kValues);
  return kType;
}

static void gst_calib_test_src_set_property(GObject* object, guint id, const GValue* value,
                                            GParamSpec* spec) {
  State* state = GST_CALIB_TEST_SRC(object)->state;
  gst::warn_if_late(GST_ELEMENT(object), spec);
  if (id == PROP_IS_LIVE) {
    gst_base_src_set_live(GST_BASE_SRC(object), g_value_get_boolean(value));
    return;
  }
  const std::lock_guard guard(state->lock);
  Settings& settings = state->settings;
  switch (id) {
    case PROP_BOARD:
      settings.scene.board = gst::string_of(value);
      break;
    case PROP_CALIBRATION:
      settings.scene.calibration = gst::string_of(value);
      break;
    case PROP_MOTION:
      settings.scene.motion = static_cast<MotionKind>(g_value_get_enum(value));
      break;
    case PROP_NOISE:
      settings.render.noise = g_value_get_double(value);
      break;
    case PROP_BLUR:
      settings.render.blur = g_value_get_double(value);
      break;
    case PROP_EXPOSURE:
      settings.render.exposure = g_value_get_double(value);
      break;
    case PROP_SEED:
      settings.scene.seed = g_value_get_uint64(value);
      break;
    case PROP_GROUND_TRUTH:
      settings.ground_truth = gst::string_of(value);
      break;
    default:
      G_OBJECT_WARN_INVALID_PROPERTY_ID(object, id, spec);
  }
}

static void gst_calib_test_src_get_property(GObject* object, guint id, GValue* value,
                                            GParamSpec* spec) {
  State* state = GST_CALIB_TEST_SRC(object)->state;
  if (id == PROP_IS_LIVE) {
    g_value_set_boolean(value, gst_base_src_is_live(GST_BASE_SRC(object)));
    return;
  }
  const std::lock_guard guard(state->lock);
  const Settings& settings = state->settings;
  switch (id) {
    case PROP_BOARD:
      gst::set_string(value, settings.scene.board);
      break;
    case PROP_CALIBRATION:
      gst::set_string(value, settings.scene.calibration);
      break;
    case PROP_MOTION:
      g_value_set_enum(value, static_cast<int>(settings.scene.motion));
      break;
    case PROP_NOISE:
      g_value_set_double(value, settings.render.noise);
      break;
    case PROP_BLUR:
      g_value_set_double(value, settings.render.blur);
      break;
    case PROP_EXPOSURE:
      g_value_set_double(value, settings.render.exposure);
      break;
    case PROP_SEED:
      g_value_set_uint64(value, settings.scene.seed);
      break;
    case PROP_GROUND_TRUTH:
      gst::set_string(value, settings.ground_truth);
      break;
    default:
      G_OBJECT_WARN_INVALID_PROPERTY_ID(object, id, spec);
  }
}

static Settings gst_calib_test_src_settings(GstCalibTestSrc* self) {
  const std::lock_guard guard(self->state->lock);
  return self->state->settings;
}

static gboolean gst_calib_test_src_start(GstBaseSrc* src) {
  GstCalibTestSrc* self = GST_CALIB_TEST_SRC(src);
  State* state = self->state;
  state->scene.reset();
  state->frame = state->first_frame = 0;
  state->first_time = 0;
  state->reverse = false;
  {
    const std::lock_guard guard(state->lock);
    gst_video_info_init(&state->info);
  }
  auto source = gst::read_scene_settings(gst_calib_test_src_settings(self).scene);
  if (!source) {
    gst::post_error(GST_ELEMENT(self), source.error());
    return FALSE;
  }
  state->source = std::move(*source);
  return TRUE;
}

static gboolean gst_calib_test_src_stop(GstBaseSrc* src) {
  GST_CALIB_TEST_SRC(src)->state->scene.reset();
  return TRUE;
}

static Status gst_calib_test_src_build_scene(GstCalibTestSrc* self, ImageSize size) {
  auto scene = gst::TestScene::make(self->state->source, size);
  if (!scene) return tl::unexpected(scene.error());
  const std::string location = gst_calib_test_src_settings(self).ground_truth;
  if (!location.empty()) {
    if (Status written = write_calibration(location, scene->truth()); !written) return written;
  }
  self->state->scene = std::move(*scene);
  return {};
}

// The PTS of a frame, from its number alone.
static GstClockTime gst_calib_test_src_time_of(const State* state, gint64 frame) {
  return state->first_time +
         gst_util_uint64_scale(static_cast<guint64>(frame - state->first_frame),
                               GST_VIDEO_INFO_FPS_D(&state->info) * GST_SECOND,
                               static_cast<guint64>(GST_VIDEO_INFO_FPS_N(&state->info)));
}

// The frame to begin with where it was seeked to. A seek before the first caps waits for them.
static void gst_calib_test_src_find_frame(State* state) {
  if (GST_VIDEO_INFO_FPS_N(&state->info) <= 0) return;
  // The last frame that starts before the position or on it; times are rounded down.
  state->frame = static_cast<gint64>(gst_util_uint64_scale_ceil(
                     state->position + 1, static_cast<guint64>(GST_VIDEO_INFO_FPS_N(&state->info)),
                     GST_VIDEO_INFO_FPS_D(&state->info) * GST_SECOND)) -
                 1;
  if (state->reverse && gst_calib_test_src_time_of(state, state->frame) == state->position) {
    --state->frame;  // it would start where playing ends
  }
}

static gboolean gst_calib_test_src_set_caps(GstBaseSrc* src, GstCaps* caps) {
  GstCalibTestSrc* self = GST_CALIB_TEST_SRC(src);
  State* state = self->state;
  GstVideoInfo info;
  if (!gst_video_info_from_caps(&info, caps)) {
    GST_ERROR_OBJECT(self, "cannot understand the caps %" GST_PTR_FORMAT, static_cast<void*>(caps));
    return FALSE;
  }
  const ImageSize size = {GST_VIDEO_INFO_WIDTH(&info), GST_VIDEO_INFO_HEIGHT(&info)};
  if (const Status built = gst_calib_test_src_build_scene(self, size); !built) {
    gst::post_error(GST_ELEMENT(self), built.error());
    return FALSE;
  }
  // Time goes on where the frames of the former format ended.
  const bool first = GST_VIDEO_INFO_FPS_N(&state->info) <= 0;
  if (!first) {
    state->first_time +=
        gst_util_uint64_scale(static_cast<guint64>(state->frame - state->first_frame),
                              GST_VIDEO_INFO_FPS_D(&state->info) * GST_SECOND,
                              static_cast<guint64>(GST_VIDEO_INFO_FPS_N(&state->info)));
    state->first_frame = state->frame;
  }
  {
    const std::lock_guard guard(state->lock);
    state->info = info;
  }
  if (first) gst_calib_test_src_find_frame(state);
  gst_base_src_set_blocksize(src, static_cast<guint>(GST_VIDEO_INFO_SIZE(&info)));
  return TRUE;
}

// Whether the pipeline, or a bin on the way to it, is on its way down: sinks first.
static bool gst_calib_test_src_goes_down(GstBaseSrc* src) {
  g_autoptr(GstObject) object = GST_OBJECT(gst_object_ref(src));
  while (object != nullptr) {
    if (GST_IS_ELEMENT(object) && GST_STATE_TARGET(object) <= GST_STATE_READY) return true;
    GstObject* parent = gst_object_get_parent(object);
    gst_object_unref(std::exchange(object, parent));
  }
  return false;
}

static gboolean gst_calib_test_src_negotiate(GstBaseSrc* src) {
  g_autoptr(GstCaps) wanted = gst_pad_get_allowed_caps(GST_BASE_SRC_PAD(src));
  if (wanted != nullptr && gst_caps_is_empty(wanted)) {
    // Elements that have stopped already may take nothing: the next frame finds them flushing.
    if (GST_CALIB_TEST_SRC(src)->state->scene && gst_calib_test_src_goes_down(src)) return TRUE;
    gst::post_error(GST_ELEMENT(src),
                    {ErrorCode::kUnsupported,
                     "Downstream takes no video that calibtestsrc makes (I420, NV12, YUY2, BGRx or "
                     "GRAY8, 16x16 to 8192x8192 px, 1 to 240 frames per second): insert "
                     "videoconvert, videoscale or videorate behind it."});
    return FALSE;
  }
  return GST_BASE_SRC_CLASS(gst_calib_test_src_parent_class)->negotiate(src);
}

static GstCaps* gst_calib_test_src_fixate(GstBaseSrc* src, GstCaps* caps) {
  const auto& calibration = GST_CALIB_TEST_SRC(src)->state->source.calibration;
  ImageSize size = kDefaultSize;
  if (calibration && calibration->image_size.width > 0) size = calibration->image_size;
  caps = gst_caps_make_writable(gst_caps_truncate(caps));
  GstStructure* s = gst_caps_get_structure(caps, 0);
  gst_structure_fixate_field_nearest_int(s, "width", size.width);
  gst_structure_fixate_field_nearest_int(s, "height", size.height);
  gst_structure_fixate_field_nearest_fraction(s, "framerate", 30, 1);
  gst_structure_fixate_field(s, "format");
  // Grey levels use all of 0 to 255, so that a conversion to GRAY8 or RGB keeps them.
  const char* format = gst_structure_get_string(s, "format");
  const GstVideoFormatInfo* known = gst_video_format_get_info(gst_video_format_from_string(format));
  if (GST_VIDEO_FORMAT_INFO_IS_YUV(known) && !gst_structure_has_field(s, "colorimetry")) {
    gst_structure_set(s, "colorimetry", G_TYPE_STRING, "1:4:0:0", nullptr);
  }
  return GST_BASE_SRC_CLASS(gst_calib_test_src_parent_class)->fixate(src, caps);
}

static gboolean gst_calib_test_src_decide_allocation(GstBaseSrc* src, GstQuery* query) {
  const State* state = GST_CALIB_TEST_SRC(src)->state;
  GstCaps* caps = nullptr;
  gst_query_parse_allocation(query, &caps, nullptr);
  g_autoptr(GstBufferPool) pool = nullptr;
  auto size = static_cast<guint>(GST_VIDEO_INFO_SIZE(&state->info));
  guint least = 0;
  guint most = 0;
  const bool update = gst_query_get_n_allocation_pools(query) > 0;
  if (update) {
    guint wanted = 0;
    gst_query_parse_nth_allocation_pool(query, 0, &pool, &wanted, &least, &most);
    size = std::max(size, wanted);
  }
  if (pool == nullptr) pool = gst_video_buffer_pool_new();
  GstStructure* config = gst_buffer_pool_get_config(pool);
  gst_buffer_pool_config_set_params(config, caps, size, least, most);
  if (gst_query_find_allocation_meta(query, GST_VIDEO_META_API_TYPE, nullptr)) {
    gst_buffer_pool_config_add_option(config, GST_BUFFER_POOL_OPTION_VIDEO_META);
  }
  gst_buffer_pool_set_config(pool, config);
  if (update) {
    gst_query_set_nth_allocation_pool(query, 0, pool, size, least, most);
  } else {
    gst_query_add_allocation_pool(query, pool, size, least, most);
  }
  return GST_BASE_SRC_CLASS(gst_calib_test_src_parent_class)->decide_allocation(src, query);
}

static bool gst_calib_test_src_draw(GstCalibTestSrc* self, const SE3& pose, GstBuffer* buffer) {
  State* state = self->state;
  const RenderOptions options = gst_calib_test_src_settings(self).render;
  GstVideoFrame frame;
  if (!gst_video_frame_map(&frame, &state->info, buffer, GST_MAP_WRITE)) return false;
  gst::write_luma(state->scene->picture(pose, state->frame, options), frame);
  gst_video_frame_unmap(&frame);
  return true;
}

static GstFlowReturn gst_calib_test_src_fill(GstPushSrc* push, GstBuffer* buffer) {
  GstCalibTestSrc* self = GST_CALIB_TEST_SRC(push);
  State* state = self->state;
  if (!state->scene) return GST_FLOW_NOT_NEGOTIATED;
  if (state->frame < state->first_frame) return GST_FLOW_EOS;  // played backwards to the start

  const GstClockTime time = gst_calib_test_src_time_of(state, state->frame);
  const bool live = gst_base_src_is_live(GST_BASE_SRC(self));
  const SE3 pose = state->scene->pose(state->frame, time, live);
  if (!gst_calib_test_src_draw(self, pose, buffer)) {
    GST_ELEMENT_ERROR(self, RESOURCE, WRITE, ("The frame's memory cannot be written."), (nullptr));
    return GST_FLOW_ERROR;
  }
  GST_BUFFER_PTS(buffer) = time;
  GST_BUFFER_DTS(buffer) = GST_CLOCK_TIME_NONE;
  GST_BUFFER_DURATION(buffer) = gst_calib_test_src_time_of(state, state->frame + 1) - time;
  GST_BUFFER_OFFSET(buffer) = static_cast<guint64>(state->frame);
  GST_BUFFER_OFFSET_END(buffer) = static_cast<guint64>(state->frame) + 1;

  const gst::TrueBoard board = {state->scene->observation(pose, time), to_pose(pose)};
  gst::attach_ground_truth(buffer, {state->scene->truth_json(), {board}});
  state->frame += state->reverse ? -1 : 1;
  return GST_FLOW_OK;
}

static gboolean gst_calib_test_src_is_seekable(GstBaseSrc* /*src*/) { return TRUE; }

static gboolean gst_calib_test_src_do_seek(GstBaseSrc* src, GstSegment* segment) {
  State* state = GST_CALIB_TEST_SRC(src)->state;
  segment->time = segment->start;
  state->reverse = segment->rate < 0;
  state->first_frame = 0;
  state->first_time = 0;
  state->frame = 0;
  state->position = segment->position;
  gst_calib_test_src_find_frame(state);
  return TRUE;
}

static void gst_calib_test_src_get_times(GstBaseSrc* src, GstBuffer* buffer, GstClockTime* start,
                                         GstClockTime* end) {
  *start = *end = GST_CLOCK_TIME_NONE;
  if (!gst_base_src_is_live(src) || !GST_BUFFER_PTS_IS_VALID(buffer)) return;
  *start = GST_BUFFER_PTS(buffer);
  *end = *start + GST_BUFFER_DURATION(buffer);
}

static gboolean gst_calib_test_src_query(GstBaseSrc* src, GstQuery* query) {
  // Any thread.
  State* state = GST_CALIB_TEST_SRC(src)->state;
  GstVideoInfo info;
  {
    const std::lock_guard guard(state->lock);
    info = state->info;
  }
  const bool known = GST_VIDEO_INFO_FPS_N(&info) > 0;
  if (GST_QUERY_TYPE(query) == GST_QUERY_LATENCY && known) {
    gst_query_set_latency(
        query, gst_base_src_is_live(src),
        gst_util_uint64_scale(GST_SECOND, GST_VIDEO_INFO_FPS_D(&info), GST_VIDEO_INFO_FPS_N(&info)),
        GST_CLOCK_TIME_NONE);
    return TRUE;
  }
  if (GST_QUERY_TYPE(query) == GST_QUERY_CONVERT && known) {
    GstFormat from;
    GstFormat to;
    gint64 value;
    gint64 converted;
    gst_query_parse_convert(query, &from, &value, &to, nullptr);
    if (!gst_video_info_convert(&info, from, value, to, &converted)) return FALSE;
    gst_query_set_convert(query, from, value, to, converted);
    return TRUE;
  }
  return GST_BASE_SRC_CLASS(gst_calib_test_src_parent_class)->query(src, query);
}

static void gst_calib_test_src_finalize(GObject* object) {
  delete GST_CALIB_TEST_SRC(object)->state;
  G_OBJECT_CLASS(gst_calib_test_src_parent_class)->finalize(object);
}

static void gst_calib_test_src_init(GstCalibTestSrc* self) {
  self->state = new State;
  gst_base_src_set_format(GST_BASE_SRC(self), GST_FORMAT_TIME);
}

static void gst_calib_test_src_install_scene_properties(GObjectClass* object_class) {
  g_object_class_install_property(
      object_class, PROP_BOARD,
      g_param_spec_string(
          "board", "Board",
          "The board to render, KIND:COLSxROWS:SIZE with inner corners and the side "
          "of a square, or FILE.json#NAME",
          kDefaultBoard.data(), gst::kMutableReady));
  g_object_class_install_property(
      object_class, PROP_CALIBRATION,
      g_param_spec_string("calibration", "Calibration",
                          "The camera to be: a calibration file, its content, or a list "
                          "fx=..,fy=..,cx=..,cy=..,k1=..,width=..,height=..; unset: a brown5 "
                          "camera 70 degrees wide, for any size",
                          nullptr, gst::kMutableReady));
  g_object_class_install_property(
      object_class, PROP_MOTION,
      g_param_spec_enum("motion", "Motion", "How the board moves before the camera",
                        gst_calib_test_src_motion_get_type(), static_cast<int>(MotionKind::kRandom),
                        gst::kMutableReady));
  g_object_class_install_property(
      object_class, PROP_SEED,
      g_param_spec_uint64("seed", "Seed", "Choice of the poses and the noise, never of the camera",
                          0, G_MAXUINT64, 0, gst::kMutableReady));
  g_object_class_install_property(
      object_class, PROP_IS_LIVE,
      g_param_spec_boolean("is-live", "Is Live", "Deliver frames in real time, as a camera does",
                           FALSE, gst::kMutableReady));
  g_object_class_install_property(
      object_class, PROP_GROUND_TRUTH,
      g_param_spec_string("ground-truth", "Ground Truth",
                          "File to write the camera to, as a calibration; unset: none", nullptr,
                          gst::kMutableReady));
}

static void gst_calib_test_src_install_image_properties(GObjectClass* object_class) {
  g_object_class_install_property(
      object_class, PROP_NOISE,
      g_param_spec_double("noise", "Noise", "Noise of the sensor in grey levels of 255, 1 sigma", 0,
                          100, kDefaultNoise, gst::kMutablePlaying));
  g_object_class_install_property(
      object_class, PROP_BLUR,
      g_param_spec_double("blur", "Blur", "Gaussian blur of the optics in px, 1 sigma", 0, 50,
                          kDefaultBlur, gst::kMutablePlaying));
  g_object_class_install_property(
      object_class, PROP_EXPOSURE,
      g_param_spec_double("exposure", "Exposure",
                          "Factor on all grey levels; those above 255 are cut off", 0, 100, 1,
                          gst::kMutablePlaying));
}

static void gst_calib_test_src_class_init(GstCalibTestSrcClass* klass) {
  auto* object_class = G_OBJECT_CLASS(klass);
  auto* element_class = GST_ELEMENT_CLASS(klass);
  auto* base_class = GST_BASE_SRC_CLASS(klass);
  object_class->set_property = gst_calib_test_src_set_property;
  object_class->get_property = gst_calib_test_src_get_property;
  object_class->finalize = gst_calib_test_src_finalize;
  base_class->start = gst_calib_test_src_start;
  base_class->stop = gst_calib_test_src_stop;
  base_class->set_caps = gst_calib_test_src_set_caps;
  base_class->negotiate = gst_calib_test_src_negotiate;
  base_class->fixate = gst_calib_test_src_fixate;
  base_class->decide_allocation = gst_calib_test_src_decide_allocation;
  base_class->is_seekable = gst_calib_test_src_is_seekable;
  base_class->do_seek = gst_calib_test_src_do_seek;
  base_class->get_times = gst_calib_test_src_get_times;
  base_class->query = gst_calib_test_src_query;
  GST_PUSH_SRC_CLASS(klass)->fill = gst_calib_test_src_fill;
  gst_calib_test_src_install_scene_properties(object_class);
  gst_calib_test_src_install_image_properties(object_class);
  gst_type_mark_as_plugin_api(gst_calib_test_src_motion_get_type(),
                              static_cast<GstPluginAPIFlags>(0));
  g_autoptr(GstCaps) caps = gst_caps_from_string(kCaps);
  gst_element_class_add_pad_template(
      element_class, gst_pad_template_new("src", GST_PAD_SRC, GST_PAD_ALWAYS, caps));
  gst_element_class_set_static_metadata(
      element_class, "Synthetic calibration camera", "Source/Video",
      "Renders a calibration board as a camera would see it, with exact ground truth",
      "The gst-calvin authors");
}
