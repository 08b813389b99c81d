// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What stands in the place of the tables of markers in a build without OpenCV and
// libapriltag.

#include "calvin/target/marker_dictionary.hpp"

namespace calvin {

std::span<const MarkerDictionary> marker_dictionaries() noexcept { return {}; }

}  // namespace calvin
