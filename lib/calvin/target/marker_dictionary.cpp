// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The dictionary of a name.

#include "calvin/target/marker_dictionary.hpp"

namespace calvin {

const MarkerDictionary* find_dictionary(std::string_view name) noexcept {
  for (const MarkerDictionary& dictionary : marker_dictionaries()) {
    if (dictionary.name == name) return &dictionary;
  }
  return nullptr;
}

}  // namespace calvin
