// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// GObject properties: the flags and conversions that every element uses.
#pragma once

#include <string>

#include <gst/gst.h>

namespace calvin::gst {

inline constexpr auto kReadWrite =
    static_cast<GParamFlags>(G_PARAM_READWRITE | G_PARAM_STATIC_STRINGS);
inline constexpr auto kReadOnly =
    static_cast<GParamFlags>(G_PARAM_READABLE | G_PARAM_STATIC_STRINGS);
// Fixed once the element runs.
inline constexpr auto kMutableReady =
    static_cast<GParamFlags>(kReadWrite | GST_PARAM_MUTABLE_READY);
// May change at any time; takes effect at the next buffer.
inline constexpr auto kMutablePlaying =
    static_cast<GParamFlags>(kReadWrite | GST_PARAM_MUTABLE_PLAYING);

// A string property as text; NULL is "".
[[nodiscard]] inline std::string string_of(const GValue* value) {
  const char* text = g_value_get_string(value);
  return text != nullptr ? text : "";
}

// The inverse: "" is NULL.
inline void set_string(GValue* value, const std::string& text) {
  g_value_set_string(value, text.empty() ? nullptr : text.c_str());
}

}  // namespace calvin::gst
