// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The properties of a pad, and its way to the source pad behind it.

#include "rig/rig_pad.hpp"

#include <algorithm>
#include <string>

#include <fmt/format.h>

#include "common/messages.hpp"
#include "common/property_kinds.hpp"

struct _GstCalibRigPad {
  GstPad parent;
  std::size_t camera;
  GstPad* source;
  calvin::gst::RigPadStream* stream;
  calvin::gst::RigCameraSettings* settings;  // object lock
};

G_DEFINE_FINAL_TYPE(GstCalibRigPad, gst_calib_rig_pad, GST_TYPE_PAD)

enum { PROP_INTRINSICS = 1, PROP_CAMERA, PROP_POINTS };

// Under the object lock.
static std::string& gst_calib_rig_pad_setting(GObject* object, guint id) {
  auto& settings = *GST_CALIB_RIG_PAD(object)->settings;
  if (id == PROP_CAMERA) return settings.name;
  return id == PROP_POINTS ? settings.points : settings.intrinsics;
}

static void gst_calib_rig_pad_set_property(GObject* object, guint id, const GValue* value,
                                           GParamSpec* spec) {
  g_autoptr(GstElement) rig = gst_pad_get_parent_element(GST_PAD(object));
  // A camera that comes later is told of with what is set until then.
  if (rig != nullptr && calvin::gst::stream_of(GST_PAD(object)).is_known) {
    calvin::gst::warn_if_late(rig, spec);
  }
  GST_OBJECT_LOCK(object);
  calvin::gst::read_value(value, gst_calib_rig_pad_setting(object, id));
  GST_OBJECT_UNLOCK(object);
}

static void gst_calib_rig_pad_get_property(GObject* object, guint id, GValue* value,
                                           GParamSpec* /*spec*/) {
  GST_OBJECT_LOCK(object);
  calvin::gst::write_value(gst_calib_rig_pad_setting(object, id), value);
  GST_OBJECT_UNLOCK(object);
}

static void gst_calib_rig_pad_finalize(GObject* object) {
  GstCalibRigPad* self = GST_CALIB_RIG_PAD(object);
  gst_object_unref(self->source);
  delete self->stream;
  delete self->settings;
  G_OBJECT_CLASS(gst_calib_rig_pad_parent_class)->finalize(object);
}

static void gst_calib_rig_pad_class_init(GstCalibRigPadClass* klass) {
  auto* object_class = G_OBJECT_CLASS(klass);
  object_class->set_property = gst_calib_rig_pad_set_property;
  object_class->get_property = gst_calib_rig_pad_get_property;
  object_class->finalize = gst_calib_rig_pad_finalize;
  using calvin::gst::kMutableReady;
  g_object_class_install_property(
      object_class, PROP_INTRINSICS,
      calvin::gst::new_spec({"intrinsics", "Intrinsics",
                             "The calibration of the camera (a file, or whatever calibundistort "
                             "takes); none: the one that comes from upstream",
                             kMutableReady},
                            std::string()));
  g_object_class_install_property(
      object_class, PROP_CAMERA,
      calvin::gst::new_spec(
          {"camera", "Camera", "Name of the camera in the rig; none: cam and the number of the pad",
           kMutableReady},
          std::string()));
  g_object_class_install_property(
      object_class, PROP_POINTS,
      calvin::gst::new_spec(
          {"points", "Points",
           "Points whose pixels are chosen by clicks in this camera's picture, in their order: a "
           "file of points, of which rows with u v are chosen already, or a board",
           kMutableReady},
          std::string()));
}

static void gst_calib_rig_pad_init(GstCalibRigPad* self) {
  self->stream = new calvin::gst::RigPadStream;
  gst_segment_init(&self->stream->segment, GST_FORMAT_TIME);
  self->settings = new calvin::gst::RigCameraSettings;
}

namespace calvin::gst {

namespace {

GObject* child_by_index(GstChildProxy* proxy, guint index) {
  GObject* child = nullptr;
  GST_OBJECT_LOCK(proxy);
  if (auto* pad = g_list_nth_data(GST_ELEMENT(proxy)->sinkpads, index)) {
    child = G_OBJECT(g_object_ref(G_OBJECT(pad)));
  }
  GST_OBJECT_UNLOCK(proxy);
  return child;
}

guint children_count(GstChildProxy* proxy) {
  GST_OBJECT_LOCK(proxy);
  const guint count = GST_ELEMENT(proxy)->numsinkpads;
  GST_OBJECT_UNLOCK(proxy);
  return count;
}

// What is asked of one side is asked of the other. A pad that nobody is linked to takes any caps.
gboolean query_sink(GstPad* pad, GstObject* parent, GstQuery* query) {
  GstPad* source = source_of(pad);
  if (!gst_pad_is_linked(source)) return gst_pad_query_default(pad, parent, query);
  return gst_pad_peer_query(source, query);
}

gboolean query_source(GstPad* pad, GstObject* /*parent*/, GstQuery* query) {
  GstPad* sink = sink_of(pad);
  return sink != nullptr && gst_pad_peer_query(sink, query);
}

GstIterator* internal_links(GstPad* pad, GstObject* /*parent*/) {
  GstPad* other = GST_PAD_IS_SINK(pad) ? source_of(pad) : sink_of(pad);
  if (other == nullptr) return nullptr;
  GValue value = G_VALUE_INIT;
  g_value_init(&value, GST_TYPE_PAD);
  g_value_set_object(&value, other);
  GstIterator* iterator = gst_iterator_new_single(GST_TYPE_PAD, &value);
  g_value_unset(&value);
  return iterator;
}

}  // namespace

GstPad* new_rig_pad(GstPadTemplate* templ, const char* name, std::size_t camera, GstPad* source) {
  auto* pad = GST_PAD(g_object_new(gst_calib_rig_pad_get_type(), "name", name, "direction",
                                   GST_PAD_SINK, "template", templ, nullptr));
  GST_CALIB_RIG_PAD(pad)->camera = camera;
  GST_CALIB_RIG_PAD(pad)->source = GST_PAD(gst_object_ref_sink(source));
  gst_pad_set_element_private(source, pad);
  gst_pad_set_query_function(pad, query_sink);
  gst_pad_set_query_function(source, query_source);
  gst_pad_set_iterate_internal_links_function(pad, internal_links);
  gst_pad_set_iterate_internal_links_function(source, internal_links);
  return pad;
}

std::size_t camera_of(GstPad* pad) { return GST_CALIB_RIG_PAD(pad)->camera; }

GstPad* source_of(GstPad* pad) { return GST_CALIB_RIG_PAD(pad)->source; }

GstPad* sink_of(GstPad* source) {
  return static_cast<GstPad*>(gst_pad_get_element_private(source));
}

RigCameraSettings settings_of(GstPad* pad) {
  GST_OBJECT_LOCK(pad);
  RigCameraSettings settings = *GST_CALIB_RIG_PAD(pad)->settings;
  GST_OBJECT_UNLOCK(pad);
  if (settings.name.empty()) settings.name = fmt::format("cam{}", camera_of(pad));
  return settings;
}

RigPadStream& stream_of(GstPad* pad) { return *GST_CALIB_RIG_PAD(pad)->stream; }

RigCameraSettings take_settings(GstPad* pad) {
  RigCameraSettings settings = settings_of(pad);
  RigPadStream& stream = stream_of(pad);
  stream.is_known = true;
  stream.has_own_intrinsics = !settings.intrinsics.empty();
  return settings;
}

std::vector<GstPad*> sink_pads_of(GstElement* rig) {
  std::vector<GstPad*> pads;
  GST_OBJECT_LOCK(rig);
  for (GList* l = rig->sinkpads; l != nullptr; l = l->next) {
    pads.push_back(GST_PAD(gst_object_ref(l->data)));
  }
  GST_OBJECT_UNLOCK(rig);
  std::ranges::sort(pads, {}, camera_of);
  return pads;
}

RigNames names_of(const std::vector<GstPad*>& pads) {
  RigNames names;
  for (GstPad* pad : pads) {
    names.pads.push_back(settings_of(pad).name);
    if (gst_pad_is_linked(pad)) names.cameras.push_back(names.pads.back());
  }
  return names;
}

void sink_pads_as_children(gpointer iface, gpointer /*data*/) {
  auto* child_proxy = static_cast<GstChildProxyInterface*>(iface);
  child_proxy->get_child_by_index = child_by_index;
  child_proxy->get_children_count = children_count;
}

}  // namespace calvin::gst
