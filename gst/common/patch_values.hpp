// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What an observation's corners looked like, in a GstStructure: `patches` (GBytes), `patch-side`
// and `patch-origin`. The pixels are shared, never copied.
#pragma once

#include <memory>

#include <gst/gst.h>

#include "calvin/core/observation.hpp"

namespace calvin::gst {

void set_patches(GstStructure* structure, const std::shared_ptr<const CornerPatches>& patches);

// Of `corners` corners. None where there are none, or not of that many.
[[nodiscard]] std::shared_ptr<const CornerPatches> get_patches(const GstStructure* structure,
                                                               std::size_t corners);

// Of an image that is not the one of this structure any more.
void remove_patches(GstStructure* structure);

}  // namespace calvin::gst
