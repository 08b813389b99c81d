// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The dictionary of a name.

#include "calvin/target/marker_dictionary.hpp"

namespace calvin {

namespace {

constexpr std::string_view kAprilTags = "DICT_APRILTAG_";
constexpr std::string_view kAprilTags3 = "tag";

}  // namespace

const MarkerDictionary* find_dictionary(std::string_view name) noexcept {
  for (const MarkerDictionary& dictionary : marker_dictionaries()) {
    if (dictionary.name == name) return &dictionary;
  }
  return nullptr;
}

std::string family_name(std::string_view dictionary) {
  if (!dictionary.starts_with(kAprilTags)) return std::string(dictionary);
  return "tag" + std::string(dictionary.substr(kAprilTags.size()));
}

const MarkerDictionary* find_family(std::string_view name) noexcept {
  for (const std::string_view prefix : {"tag", "t", ""}) {
    if (!name.starts_with(prefix)) continue;
    const std::string_view family = name.substr(prefix.size());
    for (const MarkerDictionary& dictionary : marker_dictionaries()) {
      for (const std::string_view known : {kAprilTags, kAprilTags3}) {
        if (dictionary.name.starts_with(known) && dictionary.name.substr(known.size()) == family) {
          return &dictionary;
        }
      }
    }
  }
  return find_dictionary(name);
}

bool has_opencv_dictionaries() noexcept { return find_dictionary("DICT_4X4_50") != nullptr; }
bool has_april_tag_3() noexcept { return find_dictionary("tagStandard41h12") != nullptr; }

}  // namespace calvin
