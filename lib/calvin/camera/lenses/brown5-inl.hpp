// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Brown's model with three radial terms: k1 k2 p1 p2 k3 (OpenCV's default, "plumb_bob" of ROS).
#if defined(CALVIN_CAMERA_LENSES_BROWN5_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef CALVIN_CAMERA_LENSES_BROWN5_INL_HPP
#undef CALVIN_CAMERA_LENSES_BROWN5_INL_HPP
#else
#define CALVIN_CAMERA_LENSES_BROWN5_INL_HPP
#endif

#include "calvin/camera/lenses/brown-inl.hpp"

namespace calvin::lens::HWY_NAMESPACE {

struct Brown5 : Brown<5> {
  static constexpr std::string_view kName = "brown5";
  static constexpr bool kCandidate = true;
};

}  // namespace calvin::lens::HWY_NAMESPACE

#endif  // CALVIN_CAMERA_LENSES_BROWN5_INL_HPP
