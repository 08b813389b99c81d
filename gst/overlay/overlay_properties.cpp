// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The table of the properties of caliboverlay.

#include "elements.hpp"
#include "overlay/overlay_state.hpp"

namespace calvin::gst {

namespace {

constexpr Property<OverlayState> kRows[] = {
    {"mirror", "Mirror",
     "Turn the picture left to right, as a mirror shows whoever holds the board; for the last "
     "element before a window",
     kept_in<&OverlaySettings::mirror>},
    {"ghost", "Ghost", "Draw where the board is wanted next", kept_in<&OverlaySettings::ghost>},
    {"coverage", "Coverage", "Draw how much was seen so far, as bars and as a map of the picture",
     kept_in<&OverlaySettings::coverage>},
    {"caption", "Caption",
     "Write how accurately the camera is known, and what to do next, where the board is not",
     kept_in<&OverlaySettings::caption>},
};

}  // namespace

constinit const Properties<OverlayState> kOverlayProperties = kRows;

std::vector<GParamSpec*> new_caliboverlay_specs() { return new_specs(kOverlayProperties); }

}  // namespace calvin::gst
