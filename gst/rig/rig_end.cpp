// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Looks at all pads for whether the session is over.

#include "rig/rig_end.hpp"

#include "rig/rig_pad.hpp"

namespace calvin::gst {

namespace {

// Under the object lock. Where no camera has come to its end, none has run.
bool take_end(GstElement* rig, RigEnd& end) {
  bool any = false;
  bool all = true;
  for (GList* l = rig->sinkpads; l != nullptr; l = l->next) {
    GstPad* pad = GST_PAD(l->data);
    const bool at_end = stream_of(pad).at_end;
    any = any || at_end;
    all = all && (at_end || !gst_pad_is_linked(pad));
  }
  if (!any || !all || end.is_over) return false;
  end.is_over = true;
  return true;
}

}  // namespace

void camera_runs(GstElement* rig, RigEnd& end, GstPad* pad) {
  GST_OBJECT_LOCK(rig);
  stream_of(pad).at_end = false;
  end.is_over = false;
  GST_OBJECT_UNLOCK(rig);
}

bool camera_ends(GstElement* rig, RigEnd& end, GstPad* pad, GstEvent* eos) {
  GST_OBJECT_LOCK(rig);
  stream_of(pad).at_end = true;
  end.seqnum = gst_event_get_seqnum(eos);
  const bool is_over = take_end(rig, end);
  GST_OBJECT_UNLOCK(rig);
  return is_over;
}

bool camera_goes(GstElement* rig, RigEnd& end) {
  GST_OBJECT_LOCK(rig);
  const bool is_over = take_end(rig, end);
  GST_OBJECT_UNLOCK(rig);
  return is_over;
}

bool is_last(GstElement* rig) {
  bool is_linked = false;
  GST_OBJECT_LOCK(rig);
  for (GList* l = rig->srcpads; l != nullptr; l = l->next) {
    is_linked = is_linked || gst_pad_is_linked(GST_PAD(l->data));
  }
  GST_OBJECT_UNLOCK(rig);
  return !is_linked;
}

}  // namespace calvin::gst
