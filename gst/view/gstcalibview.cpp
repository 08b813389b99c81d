// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calibview: shows where the cameras of a rig stand.

/**
 * SECTION:element-calibview
 * @title: calibview
 *
 * A source of video that shows the cameras of a rig in space: where they stand, what they look at,
 * and how well that is known. The view goes slowly around the rig; a mouse in the window of the
 * sink turns it, and its wheel comes closer. Behind a pad of calibrig it is a filter, and shows the
 * rig that is solved there.
 *
 * ## Example launch line
 * |[
 * gst-launch-1.0 calibview rig=rig.json ! videoconvert ! autovideosink
 * ]|
 */

#include <memory>

#include <gst/gst.h>

#include "common/messages.hpp"
#include "elements.hpp"
#include "view/view_caps.hpp"
#include "view/view_elements.hpp"
#include "view/view_state.hpp"

GST_DEBUG_CATEGORY(calibview_debug);
#define GST_CAT_DEFAULT calibview_debug

using namespace calvin;

G_DECLARE_FINAL_TYPE(GstCalibView, gst_calib_view, GST, CALIB_VIEW, GstBin)

// Its child is a source while nobody has asked for the pad `sink`, and a filter then.
struct _GstCalibView {
  GstBin parent;
  std::shared_ptr<gst::ViewState>* state;
  gboolean is_disposed;
};

G_DEFINE_FINAL_TYPE(GstCalibView, gst_calib_view, GST_TYPE_BIN)
GST_ELEMENT_REGISTER_DEFINE_WITH_CODE(calibview, "calibview", GST_RANK_NONE,
                                      gst_calib_view_get_type(),
                                      GST_DEBUG_CATEGORY_INIT(calibview_debug, "calibview", 0,
                                                              "view of a rig of cameras"))

static gst::ViewState& gst_calib_view_state(GObject* object) {
  return **GST_CALIB_VIEW(object)->state;
}

// Takes the child out of which the ghost pad leads, if any, and puts another one in.
static void gst_calib_view_put(GstCalibView* self, GstElement* child) {
  g_autoptr(GstPad) ghost = gst_element_get_static_pad(GST_ELEMENT(self), "src");
  g_autoptr(GstPad) target = gst_ghost_pad_get_target(GST_GHOST_PAD(ghost));
  if (target != nullptr) {
    g_autoptr(GstElement) before = gst_pad_get_parent_element(target);
    gst_ghost_pad_set_target(GST_GHOST_PAD(ghost), nullptr);
    gst_element_set_state(before, GST_STATE_NULL);
    gst_bin_remove(GST_BIN(self), before);
  }
  gst_bin_add(GST_BIN(self), child);
  g_autoptr(GstPad) pad = gst_element_get_static_pad(child, "src");
  gst_ghost_pad_set_target(GST_GHOST_PAD(ghost), pad);
  gst_element_sync_state_with_parent(child);
}

// A pipeline in one text asks for it before it runs.
static GstPad* gst_calib_view_request_new_pad(GstElement* element, GstPadTemplate* pad_template,
                                              const char* /*name*/, const GstCaps* /*caps*/) {
  g_autoptr(GstPad) there = gst_element_get_static_pad(element, "sink");
  if (there != nullptr) return nullptr;
  if (GST_STATE(element) > GST_STATE_READY) {
    GST_ELEMENT_WARNING(element, CORE, PAD,
                        ("calibview runs as a source: link its pad 'sink' in the states NULL or "
                         "READY to have a filter."),
                        (nullptr));
    return nullptr;
  }
  GstCalibView* self = GST_CALIB_VIEW(element);
  GstElement* filter = gst::new_view_filter(*self->state);
  gst_calib_view_put(self, filter);
  g_autoptr(GstPad) target = gst_element_get_static_pad(filter, "sink");
  GstPad* pad = gst_ghost_pad_new_from_template("sink", target, pad_template);
  gst_element_add_pad(element, pad);
  return pad;
}

static void gst_calib_view_release_pad(GstElement* element, GstPad* pad) {
  gst_ghost_pad_set_target(GST_GHOST_PAD(pad), nullptr);
  gst_element_remove_pad(element, pad);
  // Of what runs the filter stays, without input; and what goes releases its pads.
  GstCalibView* self = GST_CALIB_VIEW(element);
  if (GST_STATE(element) > GST_STATE_READY || self->is_disposed) return;
  gst_calib_view_put(self, gst::new_view_source(*self->state));
}

static void gst_calib_view_dispose(GObject* object) {
  GST_CALIB_VIEW(object)->is_disposed = TRUE;
  G_OBJECT_CLASS(gst_calib_view_parent_class)->dispose(object);
}

static void gst_calib_view_finalize(GObject* object) {
  delete GST_CALIB_VIEW(object)->state;
  G_OBJECT_CLASS(gst_calib_view_parent_class)->finalize(object);
}

static void gst_calib_view_init(GstCalibView* self) {
  self->state = new std::shared_ptr<gst::ViewState>(std::make_shared<gst::ViewState>());
  GstPadTemplate* pad_template =
      gst_element_class_get_pad_template(GST_ELEMENT_GET_CLASS(self), "src");
  gst_element_add_pad(GST_ELEMENT(self),
                      gst_ghost_pad_new_no_target_from_template("src", pad_template));
  gst_calib_view_put(self, gst::new_view_source(*self->state));
}

static void gst_calib_view_class_init(GstCalibViewClass* klass) {
  auto* object_class = G_OBJECT_CLASS(klass);
  auto* element_class = GST_ELEMENT_CLASS(klass);
  object_class->dispose = gst_calib_view_dispose;
  object_class->finalize = gst_calib_view_finalize;
  gst::install_properties<gst_calib_view_state, gst::kViewProperties>(object_class);
  element_class->request_new_pad = gst_calib_view_request_new_pad;
  element_class->release_pad = gst_calib_view_release_pad;
  g_autoptr(GstCaps) in = gst_caps_from_string(gst::kViewInputCaps);
  g_autoptr(GstCaps) out = gst_caps_from_string(gst::kAnyViewCaps);
  gst_element_class_add_pad_template(
      element_class, gst_pad_template_new("sink", GST_PAD_SINK, GST_PAD_REQUEST, in));
  gst_element_class_add_pad_template(element_class,
                                     gst_pad_template_new("src", GST_PAD_SRC, GST_PAD_ALWAYS, out));
  gst_element_class_set_static_metadata(
      element_class, "View of a rig of cameras", "Source/Filter/Video",
      "Shows where the cameras of a rig stand, and what they look at", "The gst-calvin authors");
}
