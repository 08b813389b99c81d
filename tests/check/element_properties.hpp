// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Any property of any element: what it may be set to, by its specification alone.
// Include it before gstcheck.h, which defines the macro `fail`.
#pragma once

#include <algorithm>
#include <functional>

#include <gst/gst.h>

namespace calvin::check {

inline void for_each_property(GstElement* element, const std::function<void(GParamSpec*)>& f) {
  guint count = 0;
  g_autofree GParamSpec** specs =
      g_object_class_list_properties(G_OBJECT_GET_CLASS(element), &count);
  for (guint i = 0; i < count; ++i) f(specs[i]);
}

inline void get_all_properties(GstElement* element) {
  for_each_property(element, [element](GParamSpec* spec) {
    if ((spec->flags & G_PARAM_READABLE) == 0) return;
    g_auto(GValue) value = G_VALUE_INIT;
    g_value_init(&value, spec->value_type);
    g_object_get_property(G_OBJECT(element), spec->name, &value);
  });
}

// The properties that may be set by anybody, those of GStreamer's base classes included.
inline void for_each_setting(GstElement* element, const std::function<void(GParamSpec*)>& f) {
  for_each_property(element, [&f](GParamSpec* spec) {
    if ((spec->flags & G_PARAM_WRITABLE) == 0 || (spec->flags & G_PARAM_CONSTRUCT_ONLY) != 0)
      return;
    if ((spec->flags & G_PARAM_DEPRECATED) != 0 || spec->owner_type == GST_TYPE_OBJECT ||
        spec->owner_type == GST_TYPE_BIN) {
      return;
    }
    f(spec);
  });
}

enum class Choice { kLeast, kMost, kDefault };
inline constexpr Choice kLimits[] = {Choice::kLeast, Choice::kMost, Choice::kDefault};

// The least or the greatest value of numbers and enums; both are the default for anything else.
// False where there is none, as for objects.
inline bool choose(GParamSpec* spec, Choice choice, GValue* value) {
  g_value_init(value, spec->value_type);
  g_param_value_set_default(spec, value);
  const bool most = choice == Choice::kMost;
  if (choice == Choice::kDefault) return true;
  if (G_IS_PARAM_SPEC_ENUM(spec)) {
    const GEnumClass* all = G_PARAM_SPEC_ENUM(spec)->enum_class;
    g_value_set_enum(value, most ? all->maximum : all->minimum);
  } else if (G_IS_PARAM_SPEC_BOOLEAN(spec)) {
    g_value_set_boolean(value, most);
  } else if (G_IS_PARAM_SPEC_INT(spec)) {
    const auto* s = G_PARAM_SPEC_INT(spec);
    g_value_set_int(value, most ? s->maximum : s->minimum);
  } else if (G_IS_PARAM_SPEC_UINT(spec)) {
    const auto* s = G_PARAM_SPEC_UINT(spec);
    g_value_set_uint(value, most ? s->maximum : s->minimum);
  } else if (G_IS_PARAM_SPEC_UINT64(spec)) {
    const auto* s = G_PARAM_SPEC_UINT64(spec);
    g_value_set_uint64(value, most ? s->maximum : s->minimum);
  } else if (G_IS_PARAM_SPEC_DOUBLE(spec)) {
    const auto* s = G_PARAM_SPEC_DOUBLE(spec);
    g_value_set_double(value, most ? s->maximum : s->minimum);
  } else if (G_IS_PARAM_SPEC_STRING(spec)) {
    g_value_set_string(value, most ? "" : G_PARAM_SPEC_STRING(spec)->default_value);
  } else {
    return !G_IS_PARAM_SPEC_OBJECT(spec) && !G_IS_PARAM_SPEC_BOXED(spec);
  }
  return true;
}

}  // namespace calvin::check
