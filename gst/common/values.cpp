// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Values in GstStructures.

#include "common/values.hpp"

namespace calvin::gst {

namespace {

// An array value under construction; the elements are written by `fill(GValue*, i)`.
template <typename Fill>
void set_array(GstStructure* structure, const char* field, GType type, std::size_t n, Fill fill) {
  GValue array = G_VALUE_INIT;
  g_value_init(&array, GST_TYPE_ARRAY);
  for (std::size_t i = 0; i < n; ++i) {
    GValue value = G_VALUE_INIT;
    g_value_init(&value, type);
    fill(&value, i);
    gst_value_array_append_and_take_value(&array, &value);
  }
  gst_structure_take_value(structure, field, &array);
}

// The elements of an array field that have the wanted type, through `read(const GValue*)`.
template <typename T, typename Read>
std::vector<T> get_array(const GstStructure* structure, const char* field, GType type, Read read) {
  std::vector<T> values;
  const GValue* array = gst_structure_get_value(structure, field);
  if (array == nullptr || !GST_VALUE_HOLDS_ARRAY(array)) return values;
  const guint n = gst_value_array_get_size(array);
  for (guint i = 0; i < n; ++i) {
    const GValue* value = gst_value_array_get_value(array, i);
    if (G_VALUE_HOLDS(value, type)) values.push_back(read(value));
  }
  return values;
}

}  // namespace

void set_doubles(GstStructure* structure, const char* field, std::span<const double> values) {
  set_array(structure, field, G_TYPE_DOUBLE, values.size(),
            [&](GValue* v, std::size_t i) { g_value_set_double(v, values[i]); });
}

void set_ints(GstStructure* structure, const char* field, std::span<const int> values) {
  set_array(structure, field, G_TYPE_INT, values.size(),
            [&](GValue* v, std::size_t i) { g_value_set_int(v, values[i]); });
}

void set_strings(GstStructure* structure, const char* field, std::span<const std::string> values) {
  set_array(structure, field, G_TYPE_STRING, values.size(),
            [&](GValue* v, std::size_t i) { g_value_set_string(v, values[i].c_str()); });
}

void set_pixels(GstStructure* structure, const char* field, std::span<const Pixel> values) {
  set_array(structure, field, G_TYPE_DOUBLE, 2 * values.size(), [&](GValue* v, std::size_t i) {
    g_value_set_double(v, i % 2 == 0 ? values[i / 2].u : values[i / 2].v);
  });
}

void take_structures(GstStructure* structure, const char* field,
                     std::span<GstStructure* const> values) {
  set_array(structure, field, GST_TYPE_STRUCTURE, values.size(),
            [&](GValue* v, std::size_t i) { g_value_take_boxed(v, values[i]); });
}

std::vector<double> get_doubles(const GstStructure* structure, const char* field) {
  return get_array<double>(structure, field, G_TYPE_DOUBLE, g_value_get_double);
}

std::vector<int> get_ints(const GstStructure* structure, const char* field) {
  return get_array<int>(structure, field, G_TYPE_INT, g_value_get_int);
}

std::vector<std::string> get_strings(const GstStructure* structure, const char* field) {
  return get_array<std::string>(structure, field, G_TYPE_STRING, [](const GValue* v) {
    const char* text = g_value_get_string(v);
    return std::string(text != nullptr ? text : "");
  });
}

std::vector<Pixel> get_pixels(const GstStructure* structure, const char* field) {
  const std::vector<double> flat = get_doubles(structure, field);
  std::vector<Pixel> pixels;
  for (std::size_t i = 0; i + 1 < flat.size(); i += 2) pixels.push_back({flat[i], flat[i + 1]});
  return pixels;
}

std::vector<const GstStructure*> get_structures(const GstStructure* structure, const char* field) {
  return get_array<const GstStructure*>(structure, field, GST_TYPE_STRUCTURE,
                                        gst_value_get_structure);
}

std::string displayed(const std::string& text) {
  g_autofree char* valid = g_utf8_make_valid(text.data(), static_cast<gssize>(text.size()));
  return valid;
}

std::string get_string(const GstStructure* structure, const char* field) {
  const char* text = gst_structure_get_string(structure, field);
  return text != nullptr ? text : "";
}

void fixate_rate(GstStructure* caps, int rate) {
  if (gst_structure_has_field(caps, "framerate")) {
    gst_structure_fixate_field_nearest_fraction(caps, "framerate", rate, 1);
  } else {
    gst_structure_set(caps, "framerate", GST_TYPE_FRACTION, rate, 1, nullptr);
  }
}

}  // namespace calvin::gst
