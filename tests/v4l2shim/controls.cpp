// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Answers the ioctls of controls as a UVC camera does: a position is inactive while autofocus is
// on, and stays what it was.

#include "controls.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <string_view>

#include "calvin/core/text.hpp"

namespace calvin::v4l2 {

namespace {

struct Control {
  std::uint32_t id;
  std::uint32_t type;
  const char* name;
  __s32 least;
  __s32 most;
  __s32 usual;
  std::uint32_t master;  // active only while that control has the value `manual`; 0: always
  __s32 manual;
};

constexpr __s32 kSharpFocus = 30;
constexpr __s32 kUsualZoom = 100;
constexpr __s32 kUsualExposure = 250;

// By id, as they are enumerated; names and ranges of a common webcam.
constexpr std::array<Control, 5> kControls = {{
    {V4L2_CID_EXPOSURE_AUTO, V4L2_CTRL_TYPE_MENU, "Auto Exposure", 0, 3, V4L2_EXPOSURE_MANUAL, 0,
     0},
    {V4L2_CID_EXPOSURE_ABSOLUTE, V4L2_CTRL_TYPE_INTEGER, "Exposure Time, Absolute", 3, 2047,
     kUsualExposure, V4L2_CID_EXPOSURE_AUTO, V4L2_EXPOSURE_MANUAL},
    {V4L2_CID_FOCUS_ABSOLUTE, V4L2_CTRL_TYPE_INTEGER, "Focus, Absolute", 0, 250, kSharpFocus,
     V4L2_CID_FOCUS_AUTO, 0},
    {V4L2_CID_FOCUS_AUTO, V4L2_CTRL_TYPE_BOOLEAN, "Focus, Automatic Continuous", 0, 1, 1, 0, 0},
    {V4L2_CID_ZOOM_ABSOLUTE, V4L2_CTRL_TYPE_INTEGER, "Zoom, Absolute", 100, 500, kUsualZoom, 0, 0},
}};
constexpr std::array<const char*, 4> kExposures = {nullptr, "Manual Mode", nullptr,
                                                   "Aperture Priority Mode"};

const Control* find(std::uint32_t id) {
  const auto* const found = std::find_if(kControls.begin(), kControls.end(),
                                         [id](const Control& control) { return control.id == id; });
  return found == kControls.end() ? nullptr : found;
}

// "Focus, Absolute" is "focus_absolute" for v4l2-ctl and in extra-controls.
std::string normalised(std::string_view name) {
  std::string text;
  for (const char c : name) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0) {
      text += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    } else if (!text.empty() && text.back() != '_') {
      text += '_';
    }
  }
  return text;
}

template <typename T>
T& as(void* argument) {
  return *static_cast<T*>(argument);
}

}  // namespace

Controls& Controls::of(const std::string& path) {
  // Never destroyed: devices are closed at exit too.
  static std::mutex& lock = *new std::mutex;
  static auto& all = *new std::map<std::string, Controls*>;
  const std::lock_guard guard(lock);
  Controls*& controls = all[path];
  if (controls == nullptr) controls = new Controls;
  return *controls;
}

Controls::Controls() {
  for (const Control& control : kControls) values_[control.id] = control.usual;
  set_from_environment();
}

void Controls::set_from_environment() {
  const char* text = std::getenv("CALVIN_V4L2_CONTROLS");
  if (text == nullptr) return;
  if (std::string_view(text) == "none") values_.clear();
  for (const std::string_view setting : split(text, ',')) {
    const auto equals = setting.find('=');
    if (equals == std::string_view::npos) continue;
    for (const Control& control : kControls) {
      if (normalised(control.name) != setting.substr(0, equals)) continue;
      values_[control.id] = parse_int(setting.substr(equals + 1)).value_or(control.usual);
    }
  }
}

bool Controls::is_active(std::uint32_t id) const {
  const Control& control = *find(id);
  return control.master == 0 || values_.at(control.master) == control.manual;
}

int Controls::query(v4l2_queryctrl& query) {
  const std::lock_guard guard(mutex_);
  const bool next = (query.id & V4L2_CTRL_FLAG_NEXT_CTRL) != 0;
  const std::uint32_t id = query.id & V4L2_CTRL_ID_MASK;
  // There are no compound ones.
  const bool compound = (query.id & V4L2_CTRL_FLAG_NEXT_COMPOUND) != 0 && !next;
  const auto found = compound ? values_.end() : next ? values_.upper_bound(id) : values_.find(id);
  if (found == values_.end()) return -EINVAL;
  const Control& control = *find(found->first);
  query = {};
  query.id = control.id;
  query.type = control.type;
  std::strncpy(reinterpret_cast<char*>(query.name), control.name, sizeof(query.name) - 1);
  query.minimum = control.least;
  query.maximum = control.most;
  query.step = 1;
  query.default_value = control.usual;
  query.flags = is_active(control.id) ? 0 : V4L2_CTRL_FLAG_INACTIVE;
  return 0;
}

int Controls::query(v4l2_query_ext_ctrl& query) {
  v4l2_queryctrl plain{};
  plain.id = query.id;
  if (const int status = this->query(plain); status != 0) return status;
  query = {};
  query.id = plain.id;
  query.type = plain.type;
  std::memcpy(query.name, plain.name, sizeof(query.name));
  query.minimum = plain.minimum;
  query.maximum = plain.maximum;
  query.step = 1;
  query.default_value = plain.default_value;
  query.flags = plain.flags;
  query.elem_size = sizeof(__s32);
  query.elems = 1;
  return 0;
}

int Controls::query_menu(v4l2_querymenu& menu) {
  const bool known = menu.id == V4L2_CID_EXPOSURE_AUTO && menu.index < kExposures.size();
  if (!known || kExposures.at(menu.index) == nullptr) return -EINVAL;
  std::strncpy(reinterpret_cast<char*>(menu.name), kExposures.at(menu.index),
               sizeof(menu.name) - 1);
  return 0;
}

int Controls::get(std::uint32_t id, __s32& value) {
  const std::lock_guard guard(mutex_);
  const auto found = values_.find(id);
  if (found == values_.end()) return -EINVAL;
  value = found->second;
  return 0;
}

// A number beyond the range is brought into it, as the kernel does.
int Controls::set(std::uint32_t id, __s32& value) {
  const std::lock_guard guard(mutex_);
  const auto found = values_.find(id);
  if (found == values_.end()) return -EINVAL;
  if (!is_active(id)) return -EACCES;
  const Control& control = *find(id);
  const __s32 wanted = std::clamp(value, control.least, control.most);
  if (id == V4L2_CID_EXPOSURE_AUTO && kExposures.at(static_cast<std::size_t>(wanted)) == nullptr) {
    return -ERANGE;
  }
  found->second = value = wanted;
  return 0;
}

int Controls::each(std::uint32_t request, v4l2_ext_controls& all) {
  for (std::uint32_t i = 0; i < all.count; ++i) {
    v4l2_ext_control& one = all.controls[i];
    const bool reads = request == VIDIOC_G_EXT_CTRLS;
    __s32 value = one.value;  // which is packed
    const int status = reads ? get(one.id, value) : set(one.id, value);
    one.value = value;
    if (status == 0) continue;
    all.error_idx = i;
    return status;
  }
  return 0;
}

int Controls::control(std::uint32_t request, void* argument) {
  switch (request) {
    case VIDIOC_QUERYCTRL:
      return query(as<v4l2_queryctrl>(argument));
    case VIDIOC_QUERY_EXT_CTRL:
      return query(as<v4l2_query_ext_ctrl>(argument));
    case VIDIOC_QUERYMENU:
      return query_menu(as<v4l2_querymenu>(argument));
    case VIDIOC_G_CTRL:
      return get(as<v4l2_control>(argument).id, as<v4l2_control>(argument).value);
    case VIDIOC_S_CTRL:
      return set(as<v4l2_control>(argument).id, as<v4l2_control>(argument).value);
    case VIDIOC_G_EXT_CTRLS:
    case VIDIOC_S_EXT_CTRLS:
      return each(request, as<v4l2_ext_controls>(argument));
    default:
      return -ENOTTY;
  }
}

Look Controls::look() {
  constexpr double kBlurPerStep = 0.02;  // px
  const std::lock_guard guard(mutex_);
  Look look;
  if (values_.empty()) return look;
  look.zoom = static_cast<double>(values_[V4L2_CID_ZOOM_ABSOLUTE]) / kUsualZoom;
  if (is_active(V4L2_CID_FOCUS_ABSOLUTE)) {
    look.blur += kBlurPerStep * std::abs(values_[V4L2_CID_FOCUS_ABSOLUTE] - kSharpFocus);
  }
  if (is_active(V4L2_CID_EXPOSURE_ABSOLUTE)) {
    look.exposure = static_cast<double>(values_[V4L2_CID_EXPOSURE_ABSOLUTE]) / kUsualExposure;
  }
  return look;
}

}  // namespace calvin::v4l2
