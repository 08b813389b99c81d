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
#include <optional>
#include <string>
#include <utility>

#include <gst/base/gstpushsrc.h>
#include <gst/video/video.h>

#include "calvin/io/calibration_io.hpp"
#include "common/element_class.hpp"
#include "common/frames/frame_planes.hpp"
#include "common/messages.hpp"
#include "common/metas.hpp"
#include "common/values.hpp"
#include "elements.hpp"
#include "testsrc/luma_writer.hpp"
#include "testsrc/test_properties.hpp"
#include "testsrc/test_state.hpp"

GST_DEBUG_CATEGORY_STATIC(calibtestsrc_debug);
#define GST_CAT_DEFAULT calibtestsrc_debug

G_DECLARE_FINAL_TYPE(GstCalibTestSrc, gst_calib_test_src, GST, CALIB_TEST_SRC, GstPushSrc)

namespace {

using namespace calvin;

// I420 where downstream has no wish.
constexpr char kCaps[] =
    "video/x-raw, format = (string) " CALVIN_PLANE_FORMATS
    ", "
    "width = (int) [ 16, 8192 ], height = (int) [ 16, 8192 ], "
    "framerate = (fraction) [ 1/3600, 240 ], pixel-aspect-ratio = (fraction) 1/1, "
    "interlace-mode = (string) progressive";
constexpr ImageSize kDefaultSize = {640, 480};

}  // namespace

struct _GstCalibTestSrc {
  GstPushSrc parent;
  gst::TestState* state;
};

G_DEFINE_FINAL_TYPE(GstCalibTestSrc, gst_calib_test_src, GST_TYPE_PUSH_SRC)
GST_ELEMENT_REGISTER_DEFINE_WITH_CODE(calibtestsrc, "calibtestsrc", GST_RANK_NONE,
                                      gst_calib_test_src_get_type(),
                                      GST_DEBUG_CATEGORY_INIT(calibtestsrc_debug, "calibtestsrc", 0,
                                                              "synthetic calibration camera"))

static gst::TestState& gst_calib_test_src_state(GObject* object) {
  return *GST_CALIB_TEST_SRC(object)->state;
}

static gboolean gst_calib_test_src_start(GstBaseSrc* src) {
  GstCalibTestSrc* self = GST_CALIB_TEST_SRC(src);
  gst::TestState* state = self->state;
  state->scene.reset();
  state->timeline = {};
  GstVideoInfo none;
  gst_video_info_init(&none);
  state->set_info(none);
  auto source = gst::read_scene_settings(self->state->settings().scene);
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
  const std::string location = self->state->settings().ground_truth;
  if (!location.empty()) {
    if (Status written = write_calibration(location, scene->truth()); !written) return written;
  }
  GST_INFO_OBJECT(self, "renders %s through %s, %dx%d px", scene->truth().board.c_str(),
                  scene->truth().model.c_str(), size.width, size.height);
  self->state->scene = std::move(*scene);
  return {};
}

static gboolean gst_calib_test_src_set_caps(GstBaseSrc* src, GstCaps* caps) {
  GstCalibTestSrc* self = GST_CALIB_TEST_SRC(src);
  gst::TestState* state = self->state;
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
  state->set_info(info);
  GST_INFO_OBJECT(self, "makes %" GST_PTR_FORMAT, static_cast<void*>(caps));
  state->timeline.set_rate(GST_VIDEO_INFO_FPS_N(&info), GST_VIDEO_INFO_FPS_D(&info));
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
    gst::post_error(
        GST_ELEMENT(src),
        {ErrorCode::kUnsupported,
         "Downstream takes no video that calibtestsrc makes (raw video of all formats but "
         "RGB8P, 16x16 to 8192x8192 px, up to 240 frames per second): insert "
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
  gst::fixate_rate(s, 30);
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
  const gst::TestState* state = GST_CALIB_TEST_SRC(src)->state;
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

static bool gst_calib_test_src_draw(GstCalibTestSrc* self, const gst::TestFrame& shown,
                                    const RenderOptions& options, GstBuffer* buffer) {
  gst::TestState* state = self->state;
  GstVideoFrame frame;
  if (!gst_video_frame_map(&frame, &state->info, buffer, GST_MAP_WRITE)) return false;
  gst::write_luma(state->scene->picture(shown, options), frame);
  gst_video_frame_unmap(&frame);
  return true;
}

static GstFlowReturn gst_calib_test_src_fill(GstPushSrc* push, GstBuffer* buffer) {
  GstCalibTestSrc* self = GST_CALIB_TEST_SRC(push);
  gst::TestState* state = self->state;
  if (!state->scene) return GST_FLOW_NOT_NEGOTIATED;
  const gst::FrameTimeline& timeline = state->timeline;
  if (timeline.is_over()) {
    GST_DEBUG_OBJECT(self, "was played backwards to the start");
    return GST_FLOW_EOS;
  }

  const gst::TestSettings settings = state->settings();
  const gst::TestFrame frame = {timeline.frame(), timeline.time(), settings.readout_time,
                                state->is_live()};
  if (!gst_calib_test_src_draw(self, frame, settings.render, buffer)) {
    GST_ELEMENT_ERROR(self, RESOURCE, WRITE, ("The frame's memory cannot be written."), (nullptr));
    return GST_FLOW_ERROR;
  }
  GST_BUFFER_PTS(buffer) = timeline.time();
  GST_BUFFER_DTS(buffer) = GST_CLOCK_TIME_NONE;
  GST_BUFFER_DURATION(buffer) = timeline.duration();
  GST_BUFFER_OFFSET(buffer) = static_cast<guint64>(timeline.frame());
  GST_BUFFER_OFFSET_END(buffer) = static_cast<guint64>(timeline.frame()) + 1;

  const gst::TrueBoard board = {state->scene->observation(frame),
                                to_pose(state->scene->pose(frame))};
  gst::attach_ground_truth(buffer, {state->scene->truth_json(), {board}});
  GST_LOG_OBJECT(self, "frame %" G_GINT64_FORMAT ": %" G_GSIZE_FORMAT " corners in view",
                 timeline.frame(), board.observation.ids.size());
  state->timeline.advance();
  return GST_FLOW_OK;
}

static gboolean gst_calib_test_src_is_seekable(GstBaseSrc* /*src*/) { return TRUE; }

static gboolean gst_calib_test_src_do_seek(GstBaseSrc* src, GstSegment* segment) {
  GST_DEBUG_OBJECT(src, "seeks to %" GST_SEGMENT_FORMAT, static_cast<void*>(segment));
  segment->time = segment->start;
  GST_CALIB_TEST_SRC(src)->state->timeline.seek(segment->position, segment->rate < 0);
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
  const GstVideoInfo info = GST_CALIB_TEST_SRC(src)->state->shared_info();
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

static void gst_calib_test_src_init(GstCalibTestSrc* self) {
  self->state = new gst::TestState(GST_BASE_SRC(self));
  gst_base_src_set_format(GST_BASE_SRC(self), GST_FORMAT_TIME);
}

static void gst_calib_test_src_class_init(GstCalibTestSrcClass* klass) {
  auto* object_class = G_OBJECT_CLASS(klass);
  auto* element_class = GST_ELEMENT_CLASS(klass);
  auto* base_class = GST_BASE_SRC_CLASS(klass);
  gst::install_finalize<gst_calib_test_src_state>(object_class);
  gst::install_properties<gst_calib_test_src_state, gst::kTestProperties>(object_class);
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
  g_autoptr(GstCaps) caps = gst_caps_from_string(kCaps);
  gst_element_class_add_pad_template(
      element_class, gst_pad_template_new("src", GST_PAD_SRC, GST_PAD_ALWAYS, caps));
  gst_element_class_set_static_metadata(
      element_class, "Synthetic calibration camera", "Source/Video",
      "Renders a calibration board as a camera would see it, with exact ground truth",
      "The gst-calvin authors");
}
