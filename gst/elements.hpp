// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The elements of the plugin, each defined in a file of its own.
#pragma once

#include <gst/gst.h>

GST_ELEMENT_REGISTER_DECLARE(calibundistort)
