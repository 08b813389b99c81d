// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The tag image-orientation: how the frames of a stream have to be turned to stand upright.
#pragma once

#include <optional>

#include <gst/gst.h>

#include "calvin/core/image.hpp"

namespace calvin::gst {

// Streaming thread.
class OrientationTags {
 public:
  void reset() { *this = {}; }
  // Takes in a STREAM_START or TAG event; false for any other one, also from another thread.
  bool take(GstEvent* event);
  // What the stream says beats what the medium says; upright where nobody says anything.
  [[nodiscard]] Orientation upright() const {
    return stream_.value_or(global_.value_or(Orientation{}));
  }

 private:
  std::optional<Orientation> stream_;
  std::optional<Orientation> global_;
};

}  // namespace calvin::gst
