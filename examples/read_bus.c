/* SPDX-License-Identifier: LGPL-2.1-or-later */

/* Calibrates a camera that does not exist and reads what the elements say: the observation meta of
 * every buffer in a pad probe, and the result message from the bus.
 *
 *   cc read_bus.c $(pkg-config --cflags --libs gstreamer-1.0) -o read-bus
 */

#include <gst/gst.h>

/* The n-th number of a GST_TYPE_ARRAY of doubles. */
static double number_at(const GValue* array, guint n) {
  return g_value_get_double(gst_value_array_get_value(array, n));
}

/* Prints the corners that calibdetect attached to the buffer. */
static GstPadProbeReturn read_corners(GstPad* pad, GstPadProbeInfo* info, gpointer data) {
  (void)pad;
  (void)data;
  GstBuffer* buffer = gst_pad_probe_info_get_buffer(info);
  GstCustomMeta* meta = gst_buffer_get_custom_meta(buffer, "calvin-observation");
  const GValue* boards = NULL;
  if (meta != NULL) {
    boards = gst_structure_get_value(gst_custom_meta_get_structure(meta), "observations");
  }
  for (guint i = 0; boards != NULL && i < gst_value_array_get_size(boards); i++) {
    const GstStructure* board = gst_value_get_structure(gst_value_array_get_value(boards, i));
    const GValue* ids = gst_structure_get_value(board, "ids");
    const GValue* uv = gst_structure_get_value(board, "uv"); /* u0, v0, u1, v1, ... px */
    gboolean found = FALSE;
    gst_structure_get_boolean(board, "found", &found);
    if (found) {
      g_print("%s: %u corners, corner %d at %.2f, %.2f\n", gst_structure_get_string(board, "board"),
              gst_value_array_get_size(ids), g_value_get_int(gst_value_array_get_value(ids, 0)),
              number_at(uv, 0), number_at(uv, 1));
    }
  }
  return GST_PAD_PROBE_OK;
}

/* Prints the final result; TRUE where this was it. */
static gboolean read_result(const GstStructure* result) {
  GstStructure* sigma = NULL;
  double fx = 0, fx_sigma = 0, rms = 0;
  int views = 0;
  if (!gst_structure_has_name(result, "calib-result") ||
      g_strcmp0(gst_structure_get_string(result, "state"), "final") != 0) {
    return FALSE;
  }
  gst_structure_get(result, "fx", G_TYPE_DOUBLE, &fx, "rms", G_TYPE_DOUBLE, &rms, "views",
                    G_TYPE_INT, &views, "sigma", GST_TYPE_STRUCTURE, &sigma, NULL);
  gst_structure_get_double(sigma, "fx", &fx_sigma);
  gst_structure_free(sigma);
  g_print("fx %.2f px, sigma %.2f, rms %.3f px from %d views\n", fx, fx_sigma, rms, views);
  return TRUE;
}

int main(int argc, char** argv) {
  GError* error = NULL;
  gboolean solved = FALSE, done = FALSE;
  gst_init(&argc, &argv);
  GstElement* pipeline =
      gst_parse_launch("calibtestsrc num-buffers=20 ! calibrate ! fakesink name=sink", &error);
  if (error != NULL) {
    g_printerr("%s\n", error->message);
    return 1;
  }
  GstElement* sink = gst_bin_get_by_name(GST_BIN(pipeline), "sink");
  GstPad* pad = gst_element_get_static_pad(sink, "sink");
  gst_pad_add_probe(pad, GST_PAD_PROBE_TYPE_BUFFER, read_corners, NULL, NULL);
  GstBus* bus = gst_element_get_bus(pipeline);
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  while (!done) {
    GstMessage* message = gst_bus_timed_pop_filtered(
        bus, GST_CLOCK_TIME_NONE, GST_MESSAGE_EOS | GST_MESSAGE_ERROR | GST_MESSAGE_ELEMENT);
    if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_ELEMENT) {
      solved = read_result(gst_message_get_structure(message)) || solved;
    } else {
      done = TRUE;
    }
    if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_ERROR) {
      gst_message_parse_error(message, &error, NULL);
      g_printerr("%s\n", error->message);
      g_clear_error(&error);
    }
    gst_message_unref(message);
  }
  gst_element_set_state(pipeline, GST_STATE_NULL);
  gst_object_unref(bus);
  gst_object_unref(pad);
  gst_object_unref(sink);
  gst_object_unref(pipeline);
  return solved ? 0 : 1;
}
