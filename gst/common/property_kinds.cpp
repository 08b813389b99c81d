// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The GParamSpec of each type that a property may have.

#include "common/property_kinds.hpp"

#include <limits>

namespace calvin::gst {

namespace {

// Called by one thread at a time: GObject holds a lock while it makes a class.
GType enum_type(const Choices& choices) {
  GType type = g_type_from_name(choices.type_name);
  if (type == 0) type = g_enum_register_static(choices.type_name, choices.values);
  gst_type_mark_as_plugin_api(type, static_cast<GstPluginAPIFlags>(0));
  return type;
}

template <typename T>
T least(const SpecText& text) {
  return text.range ? static_cast<T>(text.range->least) : std::numeric_limits<T>::lowest();
}

template <typename T>
T most(const SpecText& text) {
  return text.range ? static_cast<T>(text.range->most) : std::numeric_limits<T>::max();
}

}  // namespace

GParamSpec* new_spec(const SpecText& text, const std::string& by_default) {
  return g_param_spec_string(text.name, text.nick, text.blurb,
                             by_default.empty() ? nullptr : by_default.c_str(), text.flags);
}

GParamSpec* new_spec(const SpecText& text, bool by_default) {
  return g_param_spec_boolean(text.name, text.nick, text.blurb, by_default, text.flags);
}

GParamSpec* new_spec(const SpecText& text, int by_default) {
  return g_param_spec_int(text.name, text.nick, text.blurb, least<int>(text), most<int>(text),
                          by_default, text.flags);
}

GParamSpec* new_spec(const SpecText& text, double by_default) {
  return g_param_spec_double(text.name, text.nick, text.blurb, least<double>(text),
                             most<double>(text), by_default, text.flags);
}

GParamSpec* new_spec(const SpecText& text, guint64 by_default) {
  return g_param_spec_uint64(text.name, text.nick, text.blurb, least<guint64>(text),
                             most<guint64>(text), by_default, text.flags);
}

GParamSpec* new_spec(const SpecText& text, const GstStructure* /*none*/) {
  return g_param_spec_boxed(text.name, text.nick, text.blurb, GST_TYPE_STRUCTURE, text.flags);
}

GParamSpec* new_enum_spec(const SpecText& text, int by_default) {
  return g_param_spec_enum(text.name, text.nick, text.blurb, enum_type(text.choices), by_default,
                           text.flags);
}

}  // namespace calvin::gst
