// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The types that a property may have. Each has a GParamSpec, a way out of a GValue and one into it.
#pragma once

#include <concepts>
#include <optional>
#include <string>
#include <type_traits>

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
// The same, and a GstControlBinding may drive it.
inline constexpr auto kAnimated =
    static_cast<GParamFlags>(kMutablePlaying | GST_PARAM_CONTROLLABLE);

// What a number may be.
struct Range {
  double least = 0;
  double most = 0;
};

// What an enumeration may be: the name of its GType, and values that end with kNoMoreChoices.
struct Choices {
  const char* type_name = nullptr;
  const GEnumValue* values = nullptr;
};
template <typename E>
constexpr GEnumValue choice(E value, const char* nick, const char* description) {
  return {static_cast<int>(value), description, nick};
}
inline constexpr GEnumValue kNoMoreChoices = {0, nullptr, nullptr};

// What a GParamSpec says beside its type and its default.
struct SpecText {
  const char* name;
  const char* nick;
  const char* blurb;
  GParamFlags flags;
  std::optional<Range> range = {};  // absent: all that the type holds
  Choices choices = {};
};

// A new, floating GParamSpec of the type of its default. The string "" stands for NULL.
[[nodiscard]] GParamSpec* new_spec(const SpecText& text, const std::string& by_default);
[[nodiscard]] GParamSpec* new_spec(const SpecText& text, bool by_default);
[[nodiscard]] GParamSpec* new_spec(const SpecText& text, int by_default);
[[nodiscard]] GParamSpec* new_spec(const SpecText& text, double by_default);
[[nodiscard]] GParamSpec* new_spec(const SpecText& text, guint64 by_default);
[[nodiscard]] GParamSpec* new_spec(const SpecText& text, const GstStructure* none);
[[nodiscard]] GParamSpec* new_enum_spec(const SpecText& text, int by_default);
template <typename E>
requires std::is_enum_v<E>
[[nodiscard]] GParamSpec* new_spec(const SpecText& text, E by_default) {
  return new_enum_spec(text, static_cast<int>(by_default));
}

inline void read_value(const GValue* from, std::string& to) {
  const char* text = g_value_get_string(from);
  to = text != nullptr ? text : "";
}
inline void read_value(const GValue* from, bool& to) { to = g_value_get_boolean(from) != FALSE; }
inline void read_value(const GValue* from, int& to) { to = g_value_get_int(from); }
inline void read_value(const GValue* from, double& to) { to = g_value_get_double(from); }
inline void read_value(const GValue* from, guint64& to) { to = g_value_get_uint64(from); }
template <typename E>
requires std::is_enum_v<E>
void read_value(const GValue* from, E& to) { to = static_cast<E>(g_value_get_enum(from)); }

inline void write_value(const std::string& from, GValue* to) {
  g_value_set_string(to, from.empty() ? nullptr : from.c_str());
}
inline void write_value(bool from, GValue* to) { g_value_set_boolean(to, from); }
inline void write_value(int from, GValue* to) { g_value_set_int(to, from); }
inline void write_value(double from, GValue* to) { g_value_set_double(to, from); }
inline void write_value(guint64 from, GValue* to) { g_value_set_uint64(to, from); }
// Takes the structure.
inline void write_value(GstStructure* from, GValue* to) { g_value_take_boxed(to, from); }
template <typename E>
requires std::is_enum_v<E>
void write_value(E from, GValue* to) { g_value_set_enum(to, static_cast<int>(from)); }

}  // namespace calvin::gst
