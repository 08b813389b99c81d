// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calibrate: calibdetect ! calibsolve ! caliboverlay in one element.

/**
 * SECTION:element-calibrate
 * @title: calibrate
 *
 * A bin of calibdetect (named `detect`), calibsolve (`solve`) and caliboverlay (`overlay`). It has
 * the properties and signals of all three; those of one child alone are reached as
 * `solve::location` through GstChildProxy.
 *
 * ## Example launch line
 * |[
 * gst-launch-1.0 v4l2src ! calibrate board=checkerboard:9x6:25mm location=camera.json !
 * videoconvert ! autovideosink
 * ]|
 */

#include <array>
#include <string_view>
#include <vector>

#include <gst/gst.h>

#include "elements.hpp"
#include "meta_filter.hpp"
#include "properties.hpp"
#include "refused_caps.hpp"

GST_DEBUG_CATEGORY_STATIC(calibrate_debug);
#define GST_CAT_DEFAULT calibrate_debug

G_DECLARE_FINAL_TYPE(GstCalibrate, gst_calibrate, GST, CALIBRATE, GstBin)

struct _GstCalibrate {
  GstBin parent;
  GstElement* detect;  // owned by the bin, as the next two
  GstElement* solve;
  GstElement* overlay;  // nullptr: left out
  GstPad* src;          // ghost
};

G_DEFINE_FINAL_TYPE_WITH_CODE(GstCalibrate, gst_calibrate, GST_TYPE_BIN,
                              G_IMPLEMENT_INTERFACE(GST_TYPE_PRESET, nullptr))
GST_ELEMENT_REGISTER_DEFINE_WITH_CODE(calibrate, "calibrate", GST_RANK_NONE,
                                      gst_calibrate_get_type(),
                                      GST_DEBUG_CATEGORY_INIT(calibrate_debug, "calibrate", 0,
                                                              "camera calibration bin"))

enum { PROP_0, PROP_OVERLAY, PROP_FIRST_FORWARDED };

// The properties of the children, each forwarded under its own name. `camera` is one of both.
static std::vector<const char*>& gst_calibrate_forwarded() {
  static std::vector<const char*> names;
  return names;
}

static std::array<GstElement*, 3> gst_calibrate_children(GstCalibrate* self) {
  return {self->detect, self->solve, self->overlay};
}

static bool gst_calibrate_has(GstElement* child, const char* name) {
  return child != nullptr &&
         g_object_class_find_property(G_OBJECT_GET_CLASS(child), name) != nullptr;
}

// Links the end of the chain to the ghost pad, with the overlay or without it.
static void gst_calibrate_set_overlay(GstCalibrate* self, bool wanted) {
  if (wanted == (self->overlay != nullptr)) return;
  // A pad has one peer: the chain is opened before it is longer or shorter.
  gst_ghost_pad_set_target(GST_GHOST_PAD(self->src), nullptr);
  if (wanted) {
    self->overlay = gst_element_factory_make("caliboverlay", "overlay");
    gst_bin_add(GST_BIN(self), self->overlay);
    gst_element_link(self->solve, self->overlay);
    gst_element_sync_state_with_parent(self->overlay);
  } else {
    gst_element_set_state(self->overlay, GST_STATE_NULL);
    gst_bin_remove(GST_BIN(self), self->overlay);
    self->overlay = nullptr;
  }
  GstElement* last = self->overlay != nullptr ? self->overlay : self->solve;
  g_autoptr(GstPad) pad = gst_element_get_static_pad(last, "src");
  gst_ghost_pad_set_target(GST_GHOST_PAD(self->src), pad);
}

static void gst_calibrate_set_property(GObject* object, guint id, const GValue* value,
                                       GParamSpec* spec) {
  GstCalibrate* self = GST_CALIBRATE(object);
  if (id == PROP_OVERLAY) {
    if (GST_STATE(self) > GST_STATE_READY) {
      GST_ELEMENT_WARNING(self, LIBRARY, SETTINGS,
                          ("The property 'overlay' cannot change while the element runs and stays "
                           "as it was: set it in the states NULL or READY."),
                          (nullptr));
      return;
    }
    gst_calibrate_set_overlay(self, g_value_get_boolean(value));
    return;
  }
  for (GstElement* child : gst_calibrate_children(self)) {
    if (gst_calibrate_has(child, spec->name)) {
      g_object_set_property(G_OBJECT(child), spec->name, value);
    }
  }
}

static void gst_calibrate_get_property(GObject* object, guint id, GValue* value, GParamSpec* spec) {
  GstCalibrate* self = GST_CALIBRATE(object);
  if (id == PROP_OVERLAY) {
    g_value_set_boolean(value, self->overlay != nullptr);
    return;
  }
  // Settings of both are set on both; of the findings, the solver's count.
  const bool setting = (spec->flags & G_PARAM_WRITABLE) != 0;
  GstElement* first = setting ? self->detect : self->solve;
  GstElement* second = setting ? self->solve : self->detect;
  for (GstElement* child : {first, second, self->overlay}) {
    if (!gst_calibrate_has(child, spec->name)) continue;
    g_object_get_property(G_OBJECT(child), spec->name, value);
    return;
  }
}

static void gst_calibrate_notify(GObject* /*child*/, GParamSpec* spec, GstCalibrate* self) {
  if (g_object_class_find_property(G_OBJECT_GET_CLASS(self), spec->name) != nullptr &&
      std::string_view(spec->name) != "name" && std::string_view(spec->name) != "parent") {
    g_object_notify(G_OBJECT(self), spec->name);
  }
}

static void gst_calibrate_capture_view(GstCalibrate* self) {
  g_signal_emit_by_name(self->solve, "capture-view");
}

static void gst_calibrate_solve(GstCalibrate* self) { g_signal_emit_by_name(self->solve, "solve"); }

static void gst_calibrate_reset(GstCalibrate* self) { g_signal_emit_by_name(self->solve, "reset"); }

static gboolean gst_calibrate_remove_view(GstCalibrate* self, guint index) {
  gboolean removed = FALSE;
  g_signal_emit_by_name(self->solve, "remove-view", index, &removed);
  return removed;
}

static void gst_calibrate_init(GstCalibrate* self) {
  self->detect = gst_element_factory_make("calibdetect", "detect");
  self->solve = gst_element_factory_make("calibsolve", "solve");
  gst_bin_add_many(GST_BIN(self), self->detect, self->solve, nullptr);
  gst_element_link(self->detect, self->solve);
  for (GstElement* child : {self->detect, self->solve}) {
    // A child may outlive the bin.
    g_signal_connect_object(child, "notify", G_CALLBACK(gst_calibrate_notify), self,
                            static_cast<GConnectFlags>(0));
  }

  g_autoptr(GstPad) sink = gst_element_get_static_pad(self->detect, "sink");
  g_autoptr(GstPadTemplate) sink_template = gst_pad_get_pad_template(sink);
  gst_element_add_pad(GST_ELEMENT(self),
                      gst_ghost_pad_new_from_template("sink", sink, sink_template));
  g_autoptr(GstPad) src = gst_element_get_static_pad(self->solve, "src");
  g_autoptr(GstPadTemplate) src_template = gst_pad_get_pad_template(src);
  self->src = gst_ghost_pad_new_from_template("src", src, src_template);
  gst_element_add_pad(GST_ELEMENT(self), self->src);
  gst_calibrate_set_overlay(self, true);
  calvin::gst::explain_refused_caps(GST_ELEMENT(self));
}

// A property of a child, to be installed on the bin as well.
static GParamSpec* gst_calibrate_copy_spec(GParamSpec* spec) {
  const char* name = spec->name;
  const char* nick = g_param_spec_get_nick(spec);
  const char* blurb = g_param_spec_get_blurb(spec);
  const GParamFlags flags = spec->flags;
  if (G_IS_PARAM_SPEC_STRING(spec)) {
    return g_param_spec_string(name, nick, blurb, G_PARAM_SPEC_STRING(spec)->default_value, flags);
  }
  if (G_IS_PARAM_SPEC_ENUM(spec)) {
    return g_param_spec_enum(name, nick, blurb, spec->value_type,
                             G_PARAM_SPEC_ENUM(spec)->default_value, flags);
  }
  if (G_IS_PARAM_SPEC_BOOLEAN(spec)) {
    return g_param_spec_boolean(name, nick, blurb, G_PARAM_SPEC_BOOLEAN(spec)->default_value,
                                flags);
  }
  if (G_IS_PARAM_SPEC_INT(spec)) {
    const auto* s = G_PARAM_SPEC_INT(spec);
    return g_param_spec_int(name, nick, blurb, s->minimum, s->maximum, s->default_value, flags);
  }
  if (G_IS_PARAM_SPEC_DOUBLE(spec)) {
    const auto* s = G_PARAM_SPEC_DOUBLE(spec);
    return g_param_spec_double(name, nick, blurb, s->minimum, s->maximum, s->default_value, flags);
  }
  if (G_IS_PARAM_SPEC_BOXED(spec)) {
    return g_param_spec_boxed(name, nick, blurb, spec->value_type, flags);
  }
  return nullptr;
}

// Installs the own properties of a child element's class, first come first served. What the
// detector found is not for the bin: it has the solver's `stats`.
static void gst_calibrate_forward_properties(GObjectClass* object_class, const char* factory) {
  const bool settings_only = std::string_view(factory) == "calibdetect";
  g_autoptr(GstElement) child = gst_element_factory_make(factory, nullptr);
  if (child == nullptr) return;
  gst_object_ref_sink(child);
  guint n = 0;
  g_autofree GParamSpec** specs = g_object_class_list_properties(G_OBJECT_GET_CLASS(child), &n);
  for (guint i = 0; i < n; ++i) {
    if (specs[i]->owner_type != G_OBJECT_TYPE(child)) continue;
    if (settings_only && (specs[i]->flags & G_PARAM_WRITABLE) == 0) continue;
    if (g_object_class_find_property(object_class, specs[i]->name) != nullptr) continue;
    GParamSpec* copy = gst_calibrate_copy_spec(specs[i]);
    if (copy == nullptr) continue;
    auto& names = gst_calibrate_forwarded();
    names.push_back(copy->name);
    g_object_class_install_property(
        object_class, static_cast<guint>(PROP_FIRST_FORWARDED + names.size() - 1), copy);
  }
}

static void gst_calibrate_install_signals(GType type) {
  constexpr auto kAction = static_cast<GSignalFlags>(G_SIGNAL_RUN_LAST | G_SIGNAL_ACTION);
  const auto action = [type](const char* name, void (*handler)(GstCalibrate*)) {
    g_signal_new_class_handler(name, type, kAction, G_CALLBACK(handler), nullptr, nullptr, nullptr,
                               G_TYPE_NONE, 0);
  };
  /**
   * GstCalibrate::capture-view:
   *
   * See #GstCalibSolve::capture-view; likewise solve, reset and remove-view.
   */
  action("capture-view", gst_calibrate_capture_view);
  action("solve", gst_calibrate_solve);
  action("reset", gst_calibrate_reset);
  g_signal_new_class_handler("remove-view", type, kAction, G_CALLBACK(gst_calibrate_remove_view),
                             nullptr, nullptr, nullptr, G_TYPE_BOOLEAN, 1, G_TYPE_UINT);
}

static void gst_calibrate_class_init(GstCalibrateClass* klass) {
  auto* object_class = G_OBJECT_CLASS(klass);
  auto* element_class = GST_ELEMENT_CLASS(klass);
  object_class->set_property = gst_calibrate_set_property;
  object_class->get_property = gst_calibrate_get_property;
  g_object_class_install_property(
      object_class, PROP_OVERLAY,
      g_param_spec_boolean("overlay", "Overlay",
                           "Draw what was found and what to show next into the picture", TRUE,
                           calvin::gst::kMutableReady));
  for (const char* factory : {"calibdetect", "calibsolve", "caliboverlay"}) {
    gst_calibrate_forward_properties(object_class, factory);
  }
  gst_calibrate_install_signals(G_TYPE_FROM_CLASS(klass));

  calvin::gst::add_raw_video_pads(element_class);
  gst_element_class_set_static_metadata(
      element_class, "Camera calibration", "Filter/Analyzer/Video",
      "Finds calibration boards, solves the camera and draws how it goes",
      "The gst-calvin authors");
}
