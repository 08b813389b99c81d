// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

/**
 * SECTION:element-caliboverlay
 * @title: caliboverlay
 *
 * Draws what calibdetect and calibsolve left on the buffers: the corners of the board, how far the
 * calibration is and what to show next. Buffers with nothing to draw pass untouched.
 *
 * |[
 * gst-launch-1.0 calibtestsrc ! calibdetect ! caliboverlay ! videoconvert ! autovideosink
 * ]|
 */

#include <algorithm>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <gst/video/gstvideofilter.h>
#include <gst/video/video.h>

#include "calvin/draw/mirrored.hpp"
#include "calvin/draw/overlay.hpp"
#include "common/element_class.hpp"
#include "common/frames/dma_caps.hpp"
#include "common/frames/frame_part.hpp"
#include "common/frames/mapped_frame.hpp"
#include "common/frames/meta_filter.hpp"
#include "common/frames/padded_frame.hpp"
#include "common/frames/refused_caps.hpp"
#include "common/messages.hpp"
#include "common/metas.hpp"
#include "elements.hpp"
#include "overlay/mirror_frame.hpp"
#include "overlay/overlay_blend.hpp"
#include "overlay/overlay_state.hpp"

GST_DEBUG_CATEGORY_STATIC(caliboverlay_debug);
#define GST_CAT_DEFAULT caliboverlay_debug

namespace {

using namespace calvin;

using State = gst::OverlayState;

void read_metas(State& state, GstBuffer* buffer) {
  const GstClockTime now = GST_BUFFER_PTS(buffer);
  state.observations.expire(now);
  state.progress.expire(now);
  state.captured.expire(now);
  if (gst_buffer_get_custom_meta(buffer, gst::kObservationName) != nullptr) {
    state.observations.take(gst::read_observations(buffer), now);
  }
  if (auto progress = gst::read_guidance(buffer)) {
    if (progress->captured) state.captured.take(true, now);
    state.progress.take(std::move(progress), now);
  }
}

// What one looks at: the board, and where it is wanted.
struct InView {
  const std::vector<Observation>& boards;
  std::span<const Pixel> ghost;  // Progress::ghost
};

// How much of that lies under what is drawn there; corners count more than the squares around them,
// and these more than the ghost.
int hidden(const OverlayBox& box, const InView& in_view, ImageSize frame) {
  const int corners = hides_corner(box, in_view.boards, frame) ? 4 : 0;
  const int squares = hides_square(box, in_view.boards, frame) ? 2 : 0;
  return corners + squares + (hides_outline(box, in_view.ghost, frame) ? 1 : 0);
}

// What is drawn changes places once the other place hides less.
void place_panel(State& state, const InView& in_view, const Progress& progress, ImageSize frame) {
  const PanelSide other = state.panel == PanelSide::kLeft ? PanelSide::kRight : PanelSide::kLeft;
  const auto hidden_at = [&](PanelSide side) {
    return hidden(overlay_panel_box(frame, progress, side), in_view, frame);
  };
  if (hidden_at(other) < hidden_at(state.panel)) state.panel = other;
}

const OverlayTile* draw_words(State& state, const InView& in_view,
                              const gst::Caption::Words& words) {
  using Place = gst::Caption::Place;
  const auto hidden_by = [&](const OverlayTile& tile) {
    return hidden({tile.x, tile.y, tile.width, tile.height}, in_view, words.frame);
  };
  const Place other = state.words_at == Place::kBottom ? Place::kTop : Place::kBottom;
  const OverlayTile* here = state.caption.draw(words, state.words_at);
  if (here == nullptr || hidden_by(*here) == 0) return here;
  const OverlayTile* there = state.caption.draw(words, other);
  if (hidden_by(*there) >= hidden_by(*here)) return here;
  state.words_at = other;
  return there;
}

// What is told in words for the buffer at hand.
void draw_all_words(State& state, const gst::OverlaySettings& settings,
                    const std::vector<Observation>& seen, const Progress& progress,
                    ImageSize frame) {
  InView in_view = {seen, {}};
  if (settings.ghost) in_view.ghost = progress.ghost;
  OverlaySpan room{0, frame.width};
  if (settings.coverage) {
    place_panel(state, in_view, progress, frame);
    state.words_in_panel =
        state.panel_words.draw(overlay_panel_words(frame, progress, state.panel), frame);
    room = beside_panel(overlay_panel_box(frame, progress, state.panel), frame);
  }
  state.numbers = state.point_numbers.draw(overlay_point_numbers(frame, progress), frame);
  if (!settings.caption) return;
  state.words = draw_words(state, in_view, {overlay_caption(progress), frame, room, progress.done});
}

// To find and read fonts takes longer than a frame may: before there is one.
void load_fonts(State& state) {
  constexpr ImageSize kAny{640, 480};
  state.caption.draw({"Words", kAny, {0, kAny.width}}, gst::Caption::Place::kBottom);
  state.panel_words.draw(overlay_panel_words(kAny, Progress{}, PanelSide::kLeft), kAny);
  Progress with_point;
  with_point.points = {{0, {0.5, 0.5}}};
  state.point_numbers.draw(overlay_point_numbers(kAny, with_point), kAny);
}

}  // namespace

#define GST_TYPE_CALIB_OVERLAY (gst_calib_overlay_get_type())
G_DECLARE_FINAL_TYPE(GstCalibOverlay, gst_calib_overlay, GST, CALIB_OVERLAY, GstVideoFilter)

struct _GstCalibOverlay {
  GstVideoFilter parent;
  State* state;
};

G_DEFINE_FINAL_TYPE(GstCalibOverlay, gst_calib_overlay, GST_TYPE_VIDEO_FILTER)
GST_ELEMENT_REGISTER_DEFINE_WITH_CODE(caliboverlay, "caliboverlay", GST_RANK_NONE,
                                      GST_TYPE_CALIB_OVERLAY,
                                      GST_DEBUG_CATEGORY_INIT(caliboverlay_debug, "caliboverlay", 0,
                                                              "Calibration overlay"))

static State& gst_calib_overlay_state(GObject* object) { return *GST_CALIB_OVERLAY(object)->state; }

static gboolean gst_calib_overlay_start(GstBaseTransform* trans) {
  State& state = *GST_CALIB_OVERLAY(trans)->state;
  state.forget();
  state.blending_failed = false;
  load_fonts(state);
  // Only a build that cannot draw at all refuses to draw nothing.
  if (const auto nothing = draw_overlay({}, {}, {}); !nothing) {
    gst::post_warning(GST_ELEMENT(trans), nothing.error());
  }
  return TRUE;
}

static gboolean gst_calib_overlay_stop(GstBaseTransform* trans) {
  GST_CALIB_OVERLAY(trans)->state->forget();
  return TRUE;
}

static gboolean gst_calib_overlay_sink_event(GstBaseTransform* trans, GstEvent* event) {
  if (GST_EVENT_TYPE(event) == GST_EVENT_FLUSH_STOP) {
    GST_DEBUG_OBJECT(trans, "a flush: forgets what it drew");
    GST_CALIB_OVERLAY(trans)->state->forget();
  }
  return GST_BASE_TRANSFORM_CLASS(gst_calib_overlay_parent_class)->sink_event(trans, event);
}

// A pointer in the mirror is over the other side of what is upstream. Any thread.
static gboolean gst_calib_overlay_src_event(GstBaseTransform* trans, GstEvent* event) {
  State& state = *GST_CALIB_OVERLAY(trans)->state;
  double x = 0;
  if (GST_EVENT_TYPE(event) == GST_EVENT_NAVIGATION && state.settings().mirror &&
      gst_event_get_structure(event) != nullptr &&
      gst_structure_get_double(gst_event_get_structure(event), "pointer_x", &x)) {
    event = GST_EVENT(gst_mini_object_make_writable(GST_MINI_OBJECT(event)));
    gst_structure_set(gst_event_writable_structure(event), "pointer_x", G_TYPE_DOUBLE,
                      state.width - 1 - x, nullptr);
  }
  return GST_BASE_TRANSFORM_CLASS(gst_calib_overlay_parent_class)->src_event(trans, event);
}

static gboolean gst_calib_overlay_set_info(GstVideoFilter* filter, GstCaps* in_caps,
                                           GstVideoInfo* in, GstCaps* /*out_caps*/,
                                           GstVideoInfo* /*out*/) {
  GST_CALIB_OVERLAY(filter)->state->width = GST_VIDEO_INFO_WIDTH(in);
  GST_INFO_OBJECT(filter, "draws on %" GST_PTR_FORMAT, static_cast<void*>(in_caps));
  GST_CALIB_OVERLAY(filter)->state->forget();
  GST_CALIB_OVERLAY(filter)->state->frame_refused = false;
  return TRUE;
}

static Result<gst::MappedFrame> map_whole(GstBaseTransform* trans, GstBuffer* buffer,
                                          GstMapFlags access) {
  const State& state = *GST_CALIB_OVERLAY(trans)->state;
  const GstVideoInfo& info = GST_VIDEO_FILTER(trans)->in_info;
  return gst::MappedFrame::map(state.part ? gst::with_size(info, state.part->whole) : info, buffer,
                               access);
}

static void refuse(GstBaseTransform* trans, const Error& why) {
  GST_WARNING_OBJECT(trans, "draws nothing: %s", why.message.c_str());
  if (std::exchange(GST_CALIB_OVERLAY(trans)->state->frame_refused, true)) return;
  gst::post_warning(GST_ELEMENT(trans), why);
}

static bool may_draw_on(GstBaseTransform* trans, GstBuffer* buffer) {
  const auto frame = map_whole(trans, buffer, GST_MAP_READ);
  if (!frame) refuse(trans, frame.error());
  return frame.has_value();
}

// Decides before the buffer is made writable: one without a drawing is never copied.
static void gst_calib_overlay_before_transform(GstBaseTransform* trans, GstBuffer* buffer) {
  State& state = *GST_CALIB_OVERLAY(trans)->state;
  const GstVideoInfo& info = GST_VIDEO_FILTER(trans)->in_info;
  state.part = gst::part_of(buffer, info);
  const ImageSize whole{GST_VIDEO_INFO_WIDTH(&info), GST_VIDEO_INFO_HEIGHT(&info)};
  const ImageSize frame = state.part ? state.part->size : whole;
  read_metas(state, buffer);

  const gst::OverlaySettings settings = state.settings();
  state.mirror = settings.mirror;
  std::optional<Progress> progress = state.progress.value;
  if (progress) progress->captured = state.captured.value;
  if (progress && settings.mirror) progress = mirrored(*std::move(progress));
  std::vector<Observation> seen = state.observations.value;
  if (settings.mirror) {
    for (Observation& o : seen) o = mirrored(std::move(o), frame);
  }
  state.words = nullptr;
  state.words_in_panel = state.numbers = {};
  if (progress) draw_all_words(state, settings, seen, *progress, frame);
  const auto tiles = state.painter.draw(frame, seen, progress,
                                        {.ghost = settings.ghost,
                                         .coverage = settings.coverage,
                                         .words = gst::Labels::can_draw(),
                                         .panel = state.panel});
  state.tiles = tiles.value_or(std::span<const OverlayTile>());
  if (!tiles) GST_DEBUG_OBJECT(trans, "draws nothing: %s", tiles.error().message.c_str());
  const bool drawing = !state.tiles.empty() || state.words != nullptr || state.mirror;
  GST_LOG_OBJECT(
      trans, "%" GST_PTR_FORMAT ": %" G_GSIZE_FORMAT " boards, %s words, %" G_GSIZE_FORMAT " tiles",
      static_cast<void*>(buffer), state.observations.value.size(),
      state.words != nullptr ? "with" : "no", state.tiles.size());
  gst_base_transform_set_passthrough(trans, !drawing || !may_draw_on(trans, buffer));
}

static void draw_on(GstCalibOverlay* self, GstVideoFrame& frame) {
  State& state = *self->state;
  std::optional<gst::PaddedFrame> padded;
  if (gst::needs_padding(frame.info)) padded.emplace(frame);
  GstVideoFrame* under = padded ? &**padded : &frame;
  if (state.mirror) gst::mirror_frame(*under, state.part);
  bool blended = true;
  state.blender.begin_frame(under, state.part);
  const auto blend = [&](const OverlayTile& tile) {
    blended = state.blender.blend(tile) && blended;
  };
  for (const auto& tiles : {state.tiles, state.numbers, state.words_in_panel}) {
    for (const OverlayTile& tile : tiles) {
      if (!tile.pixels.empty()) blend(tile);
    }
  }
  if (state.words != nullptr) blend(*state.words);
  if (padded) padded->copy_to(frame);
  if (!blended && !state.blending_failed) {
    state.blending_failed = true;
    GST_ELEMENT_WARNING(self, STREAM, FORMAT,
                        ("Nothing can be drawn on %s video; put a videoconvert in front.",
                         gst_video_format_to_string(GST_VIDEO_FRAME_FORMAT(&frame))),
                        (nullptr));
  }
}

// GstVideoFilter would complain of every frame that cannot be written, as of an error of its own.
static GstFlowReturn gst_calib_overlay_transform_ip(GstBaseTransform* trans, GstBuffer* buffer) {
  auto frame = map_whole(trans, buffer, GST_MAP_READWRITE);
  if (frame) {
    draw_on(GST_CALIB_OVERLAY(trans), **frame);
  } else {
    refuse(trans, frame.error());
  }
  return GST_FLOW_OK;
}

static void gst_calib_overlay_init(GstCalibOverlay* self) {
  self->state = new State;
  gst_base_transform_set_in_place(GST_BASE_TRANSFORM(self), TRUE);
  gst_base_transform_set_passthrough(GST_BASE_TRANSFORM(self), TRUE);
  gst::explain_refused_caps(GST_ELEMENT(self));
}

static void gst_calib_overlay_class_init(GstCalibOverlayClass* klass) {
  gst::install_finalize<gst_calib_overlay_state>(G_OBJECT_CLASS(klass));
  gst::install_properties<gst_calib_overlay_state, gst::kOverlayProperties>(G_OBJECT_CLASS(klass));

  GstBaseTransformClass* transform_class = GST_BASE_TRANSFORM_CLASS(klass);
  gst::install_pixel_filter(transform_class);
  transform_class->start = gst_calib_overlay_start;
  transform_class->stop = gst_calib_overlay_stop;
  transform_class->sink_event = gst_calib_overlay_sink_event;
  transform_class->src_event = gst_calib_overlay_src_event;
  transform_class->transform_caps = gst::map_memory_transform_caps;
  transform_class->before_transform = gst_calib_overlay_before_transform;
  transform_class->transform_ip = gst_calib_overlay_transform_ip;

  GstVideoFilterClass* filter_class = GST_VIDEO_FILTER_CLASS(klass);
  filter_class->set_info = gst_calib_overlay_set_info;

  GstElementClass* element_class = GST_ELEMENT_CLASS(klass);
  gst::add_raw_video_pads(element_class);
  gst_element_class_set_static_metadata(
      element_class, "Calibration overlay", "Filter/Effect/Video",
      "Draws found boards and the progress of a calibration on the video",
      "The gst-calvin authors");
}
