// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Values in GstStructures: text, and lists (GST_TYPE_ARRAY) of plain numbers, strings or
// structures.
#pragma once

#include <span>
#include <string>
#include <vector>

#include <gst/gst.h>

#include "calvin/core/image.hpp"

namespace calvin::gst {

void set_doubles(GstStructure* structure, const char* field, std::span<const double> values);
void set_ints(GstStructure* structure, const char* field, std::span<const int> values);
void set_strings(GstStructure* structure, const char* field, std::span<const std::string> values);
// Points as u0 v0 u1 v1 ...
void set_pixels(GstStructure* structure, const char* field, std::span<const Pixel> values);
// Takes ownership of the structures.
void take_structures(GstStructure* structure, const char* field,
                     std::span<GstStructure* const> values);

// Fixates the frame rate of caps near `rate` frames per second; it is that where nobody downstream
// speaks of one, as before `interlace`.
void fixate_rate(GstStructure* caps, int rate);

// The inverse; empty where the field is missing or of another type.
[[nodiscard]] std::vector<double> get_doubles(const GstStructure* structure, const char* field);
[[nodiscard]] std::vector<int> get_ints(const GstStructure* structure, const char* field);
[[nodiscard]] std::vector<std::string> get_strings(const GstStructure* structure,
                                                   const char* field);
[[nodiscard]] std::vector<Pixel> get_pixels(const GstStructure* structure, const char* field);
// Borrowed from `structure`.
[[nodiscard]] std::vector<const GstStructure*> get_structures(const GstStructure* structure,
                                                              const char* field);

// The text as it may be shown, for names and paths may be any bytes: what is not UTF-8 in it, which
// GStreamer takes nowhere, is replaced.
[[nodiscard]] std::string displayed(const std::string& text);

[[nodiscard]] std::string get_string(const GstStructure* structure, const char* field);

}  // namespace calvin::gst
