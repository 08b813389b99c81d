// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Numbers of any type as pixels and places.

#include "common/points/point_values.hpp"

#include <cmath>
#include <limits>
#include <vector>

#include <gst/video/navigation.h>

#include "common/messages.hpp"
#include "common/values.hpp"

namespace calvin::gst {

namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

double number_of(const GValue* value) {
  GValue number = G_VALUE_INIT;
  g_value_init(&number, G_TYPE_DOUBLE);
  const bool is_number = value != nullptr && !G_VALUE_HOLDS_STRING(value) &&
                         g_value_transform(value, &number) != FALSE;
  const double result = is_number ? g_value_get_double(&number) : kNone;
  g_value_unset(&number);
  return result;
}

// `count` numbers, none of which is one where the field is no such array.
std::vector<double> numbers_of(const GstStructure* structure, const char* field, guint count) {
  std::vector<double> numbers(count, kNone);
  const GValue* array = gst_structure_get_value(structure, field);
  if (array == nullptr) return numbers;
  const bool is_array = GST_VALUE_HOLDS_ARRAY(array) && gst_value_array_get_size(array) == count;
  const bool is_list = GST_VALUE_HOLDS_LIST(array) && gst_value_list_get_size(array) == count;
  for (guint i = 0; i < count; ++i) {
    if (is_array) numbers[i] = number_of(gst_value_array_get_value(array, i));
    if (is_list) numbers[i] = number_of(gst_value_list_get_value(array, i));
  }
  return numbers;
}

}  // namespace

PointChoice read_point(const GstStructure* structure) {
  PointChoice choice;
  const std::vector<double> uv = numbers_of(structure, "uv", 2);
  choice.at = {uv[0], uv[1]};
  if (gst_structure_has_field(structure, "world")) {
    const std::vector<double> world = numbers_of(structure, "world", 3);
    choice.world = Eigen::Vector3d(world[0], world[1], world[2]);
  }
  if (const double sigma = number_of(gst_structure_get_value(structure, "sigma"));
      std::isfinite(sigma)) {
    choice.sigma = sigma;
  }
  return choice;
}

std::optional<unsigned> read_index(const GstStructure* structure) {
  if (!gst_structure_has_field(structure, "index")) return std::nullopt;
  guint index = 0;
  if (gst_structure_get_uint(structure, "index", &index)) return index;
  int number = 0;
  if (gst_structure_get_int(structure, "index", &number) && number >= 0) {
    return static_cast<unsigned>(number);
  }
  return G_MAXUINT;
}

std::optional<Click> read_click(GstEvent* event) {
  constexpr int kLeft = 1;
  constexpr int kRight = 3;
  if (GST_EVENT_TYPE(event) != GST_EVENT_NAVIGATION ||
      gst_navigation_event_get_type(event) != GST_NAVIGATION_EVENT_MOUSE_BUTTON_PRESS) {
    return std::nullopt;
  }
  int button = 0;
  Click click;
  if (!gst_navigation_event_parse_mouse_button_event(event, &button, &click.at.u, &click.at.v)) {
    return std::nullopt;
  }
  click.takes_out = button == kRight;
  return button == kLeft || button == kRight ? std::optional(click) : std::nullopt;
}

GstStructure* point_message(const FrameTimes& times, const std::string& camera,
                            const PointAnswer& answer) {
  GstStructure* s = new_message("calib-point", times, camera);
  gst_structure_set(s, "accepted", G_TYPE_BOOLEAN, answer.accepted(), "reason", G_TYPE_STRING,
                    std::string(to_string(answer.verdict)).c_str(), "snapped", G_TYPE_BOOLEAN,
                    answer.snapped.has_value(), "points", G_TYPE_INT,
                    static_cast<int>(answer.count), "hint", G_TYPE_STRING,
                    displayed(answer.hint).c_str(), nullptr);
  if (std::isfinite(answer.at.u) && std::isfinite(answer.at.v)) {
    gst_structure_set(s, "u", G_TYPE_DOUBLE, answer.at.u, "v", G_TYPE_DOUBLE, answer.at.v, nullptr);
  }
  if (answer.sigma) gst_structure_set(s, "sigma", G_TYPE_DOUBLE, *answer.sigma, nullptr);
  if (answer.id) gst_structure_set(s, "id", G_TYPE_INT, *answer.id, nullptr);
  if (answer.world && answer.world->allFinite()) {
    gst_structure_set(s, "x", G_TYPE_DOUBLE, answer.world->x(), "y", G_TYPE_DOUBLE,
                      answer.world->y(), "z", G_TYPE_DOUBLE, answer.world->z(), nullptr);
  }
  return s;
}

}  // namespace calvin::gst
