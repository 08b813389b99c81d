// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Brown's model with a rational radial term: k1 k2 p1 p2 k3 k4 k5 k6 (OpenCV's
// CALIB_RATIONAL_MODEL, "rational_polynomial" of ROS, FULL_OPENCV of COLMAP).
#if defined(CALVIN_CAMERA_LENSES_RATIONAL8_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef CALVIN_CAMERA_LENSES_RATIONAL8_INL_HPP
#undef CALVIN_CAMERA_LENSES_RATIONAL8_INL_HPP
#else
#define CALVIN_CAMERA_LENSES_RATIONAL8_INL_HPP
#endif

#include "calvin/camera/lenses/brown-inl.hpp"

namespace calvin::lens::HWY_NAMESPACE {

struct Rational8 : Brown<8> {
  static constexpr std::string_view kName = "rational8";
  static constexpr bool kCandidate = true;
};

}  // namespace calvin::lens::HWY_NAMESPACE

#endif  // CALVIN_CAMERA_LENSES_RATIONAL8_INL_HPP
