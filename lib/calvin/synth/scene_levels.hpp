// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The grey levels of a scene. Internal.
#pragma once

namespace calvin::synth {

struct SceneLevels {
  double dark = 0;
  double light = 0;
  double background = 0;
};

}  // namespace calvin::synth
