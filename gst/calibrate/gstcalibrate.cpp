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

#include <memory>
#include <string_view>

#include <gst/gst.h>

#include "common/frames/meta_filter.hpp"
#include "common/frames/refused_caps.hpp"
#include "common/property_kinds.hpp"
#include "elements.hpp"

GST_DEBUG_CATEGORY_STATIC(calibrate_debug);
#define GST_CAT_DEFAULT calibrate_debug

using namespace calvin;

namespace {

struct Unref {
  void operator()(GstElement* element) const { gst_object_unref(element); }
};
using ElementPtr = std::unique_ptr<GstElement, Unref>;

}  // namespace

G_DECLARE_FINAL_TYPE(GstCalibrate, gst_calibrate, GST, CALIBRATE, GstBin)

// Nothing is kept of the children: an application may take them out, or put others in their place.
// The overlay that `overlay=false` leaves out is kept with its properties as data of the object.
struct _GstCalibrate {
  GstBin parent;
};

G_DEFINE_FINAL_TYPE_WITH_CODE(GstCalibrate, gst_calibrate, GST_TYPE_BIN,
                              G_IMPLEMENT_INTERFACE(GST_TYPE_PRESET, nullptr))
GST_ELEMENT_REGISTER_DEFINE_WITH_CODE(calibrate, "calibrate", GST_RANK_NONE,
                                      gst_calibrate_get_type(),
                                      GST_DEBUG_CATEGORY_INIT(calibrate_debug, "calibrate", 0,
                                                              "camera calibration bin"))

// Behind it come the properties of the children, each forwarded under its own name.
enum { PROP_0, PROP_OVERLAY };

static constexpr const char* kDetect = "detect";
static constexpr const char* kSolve = "solve";
static constexpr const char* kOverlay = "overlay";
static constexpr const char* kLeftOut = "overlay-left-out";

// The child of that name, nullptr where there is none.
static ElementPtr gst_calibrate_child(GstCalibrate* self, const char* name) {
  return ElementPtr(gst_bin_get_by_name(GST_BIN(self), name));
}

// Likewise of what has properties: the overlay has them while it is left out, too.
static ElementPtr gst_calibrate_owner(GstCalibrate* self, const char* name) {
  ElementPtr child = gst_calibrate_child(self, name);
  if (child || std::string_view(name) != kOverlay) return child;
  auto* left_out = static_cast<GstElement*>(g_object_get_data(G_OBJECT(self), kLeftOut));
  return ElementPtr(left_out != nullptr ? GST_ELEMENT(gst_object_ref(left_out)) : nullptr);
}

static bool gst_calibrate_has(GstElement* child, const char* name) {
  return child != nullptr &&
         g_object_class_find_property(G_OBJECT_GET_CLASS(child), name) != nullptr;
}

static void gst_calibrate_notify(GObject* /*child*/, GParamSpec* spec, GstCalibrate* self) {
  if (g_object_class_find_property(G_OBJECT_GET_CLASS(self), spec->name) != nullptr &&
      std::string_view(spec->name) != "name" && std::string_view(spec->name) != "parent") {
    g_object_notify(G_OBJECT(self), spec->name);
  }
}

// Whoever puts them in: the bin speaks for its children alone.
static bool gst_calibrate_is_child(GstElement* element) {
  g_autofree char* name = gst_object_get_name(GST_OBJECT(element));
  const std::string_view known(name);
  return known == kDetect || known == kSolve || known == kOverlay;
}

static void gst_calibrate_element_added(GstBin* bin, GstElement* element) {
  if (!gst_calibrate_is_child(element)) return;
  GST_DEBUG_OBJECT(bin, "listens to %s", GST_OBJECT_NAME(element));
  // A child may outlive the bin.
  g_signal_connect_object(element, "notify", G_CALLBACK(gst_calibrate_notify), bin,
                          static_cast<GConnectFlags>(0));
}

static void gst_calibrate_element_removed(GstBin* bin, GstElement* element) {
  g_signal_handlers_disconnect_by_func(element, reinterpret_cast<gpointer>(gst_calibrate_notify),
                                       bin);
}

// A child, linked behind the one of that name.
static void gst_calibrate_add(GstCalibrate* self, GstElement* child, const char* before) {
  gst_bin_add(GST_BIN(self), child);
  const ElementPtr upstream = before != nullptr ? gst_calibrate_child(self, before) : nullptr;
  if (upstream) gst_element_link(upstream.get(), child);
}

// Links the end of the chain to the ghost pad, with the overlay or without it.
static void gst_calibrate_set_overlay(GstCalibrate* self, bool wanted) {
  ElementPtr overlay = gst_calibrate_child(self, kOverlay);
  if (wanted == (overlay != nullptr)) return;
  GST_INFO_OBJECT(self, "the overlay is %s", wanted ? "put in" : "left out");
  g_autoptr(GstPad) src = gst_element_get_static_pad(GST_ELEMENT(self), "src");
  // A pad has one peer: the chain is opened before it is longer or shorter.
  gst_ghost_pad_set_target(GST_GHOST_PAD(src), nullptr);
  if (wanted) {
    const ElementPtr left_out(
        static_cast<GstElement*>(g_object_steal_data(G_OBJECT(self), kLeftOut)));
    GstElement* child =
        left_out ? left_out.get() : gst_element_factory_make("caliboverlay", kOverlay);
    gst_calibrate_add(self, child, kSolve);
    gst_element_sync_state_with_parent(gst_calibrate_child(self, kOverlay).get());
  } else {
    gst_element_set_state(overlay.get(), GST_STATE_NULL);
    gst_bin_remove(GST_BIN(self), overlay.get());
    g_object_set_data_full(G_OBJECT(self), kLeftOut, overlay.release(), gst_object_unref);
  }
  const ElementPtr last = gst_calibrate_child(self, wanted ? kOverlay : kSolve);
  if (!last) return;
  g_autoptr(GstPad) pad = gst_element_get_static_pad(last.get(), "src");
  gst_ghost_pad_set_target(GST_GHOST_PAD(src), pad);
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
  bool known = false;
  for (const char* name : {kDetect, kSolve, kOverlay}) {
    const ElementPtr child = gst_calibrate_owner(self, name);
    if (!gst_calibrate_has(child.get(), spec->name)) continue;
    GST_DEBUG_OBJECT(self, "%s goes to %s", spec->name, name);
    g_object_set_property(G_OBJECT(child.get()), spec->name, value);
    known = true;
  }
  if (!known) GST_WARNING_OBJECT(self, "the child with the property %s is gone", spec->name);
}

static void gst_calibrate_get_property(GObject* object, guint id, GValue* value, GParamSpec* spec) {
  GstCalibrate* self = GST_CALIBRATE(object);
  if (id == PROP_OVERLAY) {
    g_value_set_boolean(value, gst_calibrate_child(self, kOverlay) != nullptr);
    return;
  }
  // Settings of both are set on both; of the findings, the solver's count.
  const bool setting = (spec->flags & G_PARAM_WRITABLE) != 0;
  const char* first = setting ? kDetect : kSolve;
  const char* second = setting ? kSolve : kDetect;
  for (const char* name : {first, second, kOverlay}) {
    const ElementPtr child = gst_calibrate_owner(self, name);
    if (!gst_calibrate_has(child.get(), spec->name)) continue;
    g_object_get_property(G_OBJECT(child.get()), spec->name, value);
    return;
  }
  g_param_value_set_default(spec, value);
}

// Emits an action signal of the solver, if there is one.
template <typename... Arguments>
static void gst_calibrate_emit(GstCalibrate* self, const char* signal, Arguments... arguments) {
  const ElementPtr solve = gst_calibrate_child(self, kSolve);
  if (!solve || g_signal_lookup(signal, G_OBJECT_TYPE(solve.get())) == 0) {
    GST_WARNING_OBJECT(self, "the child for the signal %s is gone", signal);
    return;
  }
  g_signal_emit_by_name(solve.get(), signal, arguments...);
}

static void gst_calibrate_capture_view(GstCalibrate* self) {
  gst_calibrate_emit(self, "capture-view");
}

static void gst_calibrate_solve(GstCalibrate* self) { gst_calibrate_emit(self, "solve"); }

static void gst_calibrate_reset(GstCalibrate* self) { gst_calibrate_emit(self, "reset"); }

static gboolean gst_calibrate_remove_view(GstCalibrate* self, guint index) {
  gboolean removed = FALSE;
  gst_calibrate_emit(self, "remove-view", index, &removed);
  return removed;
}

static void gst_calibrate_add_point(GstCalibrate* self, double u, double v, double x, double y,
                                    double z) {
  gst_calibrate_emit(self, "add-point", u, v, x, y, z);
}

static gboolean gst_calibrate_remove_point(GstCalibrate* self, guint index) {
  gboolean removed = FALSE;
  gst_calibrate_emit(self, "remove-point", index, &removed);
  return removed;
}

// A ghost pad for the pad of that name of a child.
static void gst_calibrate_expose(GstCalibrate* self, const char* child, const char* name) {
  const ElementPtr element = gst_calibrate_child(self, child);
  g_autoptr(GstPad) pad = gst_element_get_static_pad(element.get(), name);
  g_autoptr(GstPadTemplate) pad_template = gst_pad_get_pad_template(pad);
  gst_element_add_pad(GST_ELEMENT(self), gst_ghost_pad_new_from_template(name, pad, pad_template));
}

static void gst_calibrate_init(GstCalibrate* self) {
  gst_calibrate_add(self, gst_element_factory_make("calibdetect", kDetect), nullptr);
  gst_calibrate_add(self, gst_element_factory_make("calibsolve", kSolve), kDetect);
  gst_calibrate_expose(self, kDetect, "sink");
  gst_calibrate_expose(self, kSolve, "src");
  gst_calibrate_set_overlay(self, true);
  gst::explain_refused_caps(GST_ELEMENT(self));
}

// Installs the rows of the children's tables in the order of the chain; the first table that names
// a property describes it. What the detector found is left out: the bin has the solver's `stats`.
static void gst_calibrate_install_forwarded(GObjectClass* object_class) {
  guint id = PROP_OVERLAY;
  const auto forward = [&](GParamSpec* spec, bool wanted) {
    g_param_spec_ref_sink(spec);
    if (wanted && g_object_class_find_property(object_class, spec->name) == nullptr) {
      g_object_class_install_property(object_class, ++id, spec);
    }
    g_param_spec_unref(spec);
  };
  for (GParamSpec* spec : gst::new_calibdetect_specs()) {
    forward(spec, (spec->flags & G_PARAM_WRITABLE) != 0);
  }
  for (GParamSpec* spec : gst::new_calibsolve_specs()) forward(spec, true);
  for (GParamSpec* spec : gst::new_caliboverlay_specs()) forward(spec, true);
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
   * See #GstCalibSolve::capture-view; likewise solve, reset, remove-view, add-point and
   * remove-point.
   */
  action("capture-view", gst_calibrate_capture_view);
  action("solve", gst_calibrate_solve);
  action("reset", gst_calibrate_reset);
  g_signal_new_class_handler("remove-view", type, kAction, G_CALLBACK(gst_calibrate_remove_view),
                             nullptr, nullptr, nullptr, G_TYPE_BOOLEAN, 1, G_TYPE_UINT);
  g_signal_new_class_handler("add-point", type, kAction, G_CALLBACK(gst_calibrate_add_point),
                             nullptr, nullptr, nullptr, G_TYPE_NONE, 5, G_TYPE_DOUBLE,
                             G_TYPE_DOUBLE, G_TYPE_DOUBLE, G_TYPE_DOUBLE, G_TYPE_DOUBLE);
  g_signal_new_class_handler("remove-point", type, kAction, G_CALLBACK(gst_calibrate_remove_point),
                             nullptr, nullptr, nullptr, G_TYPE_BOOLEAN, 1, G_TYPE_UINT);
}

static void gst_calibrate_class_init(GstCalibrateClass* klass) {
  auto* object_class = G_OBJECT_CLASS(klass);
  auto* element_class = GST_ELEMENT_CLASS(klass);
  auto* bin_class = GST_BIN_CLASS(klass);
  object_class->set_property = gst_calibrate_set_property;
  object_class->get_property = gst_calibrate_get_property;
  bin_class->element_added = gst_calibrate_element_added;
  bin_class->element_removed = gst_calibrate_element_removed;
  g_object_class_install_property(
      object_class, PROP_OVERLAY,
      gst::new_spec(
          {"overlay", "Overlay", "Draw what was found and what to show next into the picture",
           gst::kMutableReady},
          true));
  gst_calibrate_install_forwarded(object_class);
  gst_calibrate_install_signals(G_TYPE_FROM_CLASS(klass));

  gst::add_raw_video_pads(element_class);
  gst_element_class_set_static_metadata(
      element_class, "Camera calibration", "Filter/Analyzer/Video",
      "Finds calibration boards, solves the camera and draws how it goes",
      "The gst-calvin authors");
}
