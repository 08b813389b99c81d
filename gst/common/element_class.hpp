// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The virtual functions that the elements have in common, for class_init. Each hands on to the
// object behind the element, which `kStateOf` finds: State& (*)(GObject*). No class is derived from
// ours, so that the parent of an element's class is GStreamer's.
#pragma once

#include <gst/base/gstbasetransform.h>

#include "common/messages.hpp"

namespace calvin::gst {

// Frees the object behind the element.
template <auto kStateOf>
void install_finalize(GObjectClass* object_class) {
  object_class->finalize = [](GObject* object) {
    delete &kStateOf(object);
    G_OBJECT_CLASS(g_type_class_peek_parent(G_OBJECT_GET_CLASS(object)))->finalize(object);
  };
}

// Stops the workers before the element goes: no job begins to post in its name any more.
template <auto kStateOf>
void install_dispose(GObjectClass* object_class) {
  object_class->dispose = [](GObject* object) {
    kStateOf(object).stop();
    G_OBJECT_CLASS(g_type_class_peek_parent(G_OBJECT_GET_CLASS(object)))->dispose(object);
  };
}

// State::start() between READY and PAUSED, whose error is posted, and State::stop() on the way
// back. State::cancel() comes before the pads are deactivated: that waits for the streaming thread,
// which may be waiting for a worker.
template <auto kStateOf>
void install_start_and_stop(GstBaseTransformClass* trans_class) {
  trans_class->start = [](GstBaseTransform* trans) -> gboolean {
    const Status started = kStateOf(G_OBJECT(trans)).start();
    if (!started) post_error(GST_ELEMENT(trans), started.error());
    return started.has_value();
  };
  trans_class->stop = [](GstBaseTransform* trans) -> gboolean {
    kStateOf(G_OBJECT(trans)).stop();
    return TRUE;
  };
  GST_ELEMENT_CLASS(trans_class)->change_state = [](GstElement* element, GstStateChange change) {
    if (change == GST_STATE_CHANGE_PAUSED_TO_READY) kStateOf(G_OBJECT(element)).cancel();
    auto* parent = GST_ELEMENT_CLASS(g_type_class_peek_parent(G_OBJECT_GET_CLASS(element)));
    return parent->change_state(element, change);
  };
}

}  // namespace calvin::gst
