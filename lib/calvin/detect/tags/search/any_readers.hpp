// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Readers of all tags that this build knows, for whoever does not know which ones are in view.
#pragma once

#include <vector>

#include "calvin/detect/tags/tag_reader.hpp"

namespace calvin::detect {

// Styles whose tags are read by the same places of a quad.
struct Readers {
  std::vector<TagReader> all;
  [[nodiscard]] const TagStyle& shape() const { return all.front().style(); }
};

// Of the largest dictionary of each family, with borders of all widths and colours. They take no
// code with wrong bits.
[[nodiscard]] const std::vector<Readers>& any_readers();

// The smallest dictionary that has these tags.
[[nodiscard]] const MarkerDictionary* smallest_with(const MarkerDictionary& family, int last_id);

}  // namespace calvin::detect
