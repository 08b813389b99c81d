// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The plugin: registers every element and the metas that travel between them.

#include <gst/gst.h>

#include "common/metas.hpp"
#include "elements.hpp"
#include "plugin_config.h"

static gboolean plugin_init(GstPlugin* plugin) {
  calvin::gst::register_metas();
  gboolean any = FALSE;
  any |= GST_ELEMENT_REGISTER(calibdetect, plugin);
  any |= GST_ELEMENT_REGISTER(caliboverlay, plugin);
  any |= GST_ELEMENT_REGISTER(calibsolve, plugin);
  any |= GST_ELEMENT_REGISTER(calibtestsrc, plugin);
  any |= GST_ELEMENT_REGISTER(calibundistort, plugin);
  any |= GST_ELEMENT_REGISTER(calibview, plugin);
  any |= GST_ELEMENT_REGISTER(calibrate, plugin);
  any |= GST_ELEMENT_REGISTER(calibrig, plugin);
  return any;
}

GST_PLUGIN_DEFINE(GST_VERSION_MAJOR, GST_VERSION_MINOR, calvin,
                  "Camera calibration: finds boards, solves cameras, undistorts video", plugin_init,
                  PACKAGE_VERSION, "LGPL", PACKAGE, PACKAGE_ORIGIN)
