/* SPDX-License-Identifier: LGPL-2.1-or-later
 * SPDX-FileCopyrightText: 2026 The gst-calvin authors
 *
 * A program that holds the plugin itself, as on an embedded system without loadable plugins. Built
 * by tests/pipelines/install.sh with what pkg-config says of gstcalvin. */
#include <gst/gst.h>

GST_PLUGIN_STATIC_DECLARE(calvin);

static const char* const kElements[] = {"calibdetect", "caliboverlay", "calibrate",
                                        "calibsolve",  "calibtestsrc", "calibundistort"};

/* Whether an element can be made, and comes from the program rather than from a file. */
static gboolean is_built_in(const char* name) {
  GstElement* element = gst_element_factory_make(name, NULL);
  if (element == NULL) return FALSE;
  GstPlugin* plugin =
      gst_plugin_feature_get_plugin(GST_PLUGIN_FEATURE(gst_element_get_factory(element)));
  const gboolean built_in = plugin != NULL && gst_plugin_get_filename(plugin) == NULL;
  g_clear_object(&plugin);
  gst_object_unref(element);
  return built_in;
}

/* Whether a camera is calibrated and its video undistorted, up to the end of the stream. */
static gboolean calibrates(void) {
  GError* error = NULL;
  GstElement* pipeline = gst_parse_launch(
      "calibtestsrc num-buffers=12 ! calibrate ! calibundistort ! fakesink", &error);
  if (pipeline == NULL) {
    g_printerr("%s\n", error->message);
    g_clear_error(&error);
    return FALSE;
  }
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  GstBus* bus = gst_element_get_bus(pipeline);
  gboolean solved = FALSE;
  gboolean ended = FALSE;
  while (!ended) {
    GstMessage* message = gst_bus_timed_pop_filtered(
        bus, 120 * GST_SECOND, GST_MESSAGE_EOS | GST_MESSAGE_ERROR | GST_MESSAGE_ELEMENT);
    if (message == NULL || GST_MESSAGE_TYPE(message) == GST_MESSAGE_ERROR) {
      g_printerr("the pipeline %s\n", message == NULL ? "does not end" : "fails");
      g_clear_pointer(&message, gst_message_unref);
      break;
    }
    ended = GST_MESSAGE_TYPE(message) == GST_MESSAGE_EOS;
    solved = solved || gst_message_has_name(message, "calib-result");
    gst_message_unref(message);
  }
  gst_object_unref(bus);
  gst_element_set_state(pipeline, GST_STATE_NULL);
  gst_object_unref(pipeline);
  return solved && ended;
}

int main(int argc, char** argv) {
  gst_init(&argc, &argv);
  GST_PLUGIN_STATIC_REGISTER(calvin);
  for (gsize i = 0; i < G_N_ELEMENTS(kElements); ++i) {
    if (is_built_in(kElements[i])) continue;
    g_printerr("%s is not in this program\n", kElements[i]);
    return 1;
  }
  if (!calibrates()) {
    g_printerr("no calibration came\n");
    return 1;
  }
  return 0;
}
