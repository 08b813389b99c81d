// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The elements of the plugin, each defined in a file of its own.
#pragma once

#include <vector>

#include <gst/gst.h>

GST_ELEMENT_REGISTER_DECLARE(calibdetect)
GST_ELEMENT_REGISTER_DECLARE(caliboverlay)
GST_ELEMENT_REGISTER_DECLARE(calibrate)
GST_ELEMENT_REGISTER_DECLARE(calibrig)
GST_ELEMENT_REGISTER_DECLARE(calibsolve)
GST_ELEMENT_REGISTER_DECLARE(calibtestsrc)
GST_ELEMENT_REGISTER_DECLARE(calibundistort)
GST_ELEMENT_REGISTER_DECLARE(calibview)

namespace calvin::gst {

// New, floating GParamSpecs of the properties of these elements, in the order of their tables, for
// a bin that has the same properties.
[[nodiscard]] std::vector<GParamSpec*> new_calibdetect_specs();
[[nodiscard]] std::vector<GParamSpec*> new_calibsolve_specs();
[[nodiscard]] std::vector<GParamSpec*> new_caliboverlay_specs();

}  // namespace calvin::gst
