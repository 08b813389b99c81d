// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The thin prism model before a tilted sensor: k1 k2 p1 p2 k3 k4 k5 k6 s1 s2 s3 s4 taux tauy
// (OpenCV's CALIB_TILTED_MODEL).
#if defined(CALVIN_CAMERA_LENSES_TILTED14_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef CALVIN_CAMERA_LENSES_TILTED14_INL_HPP
#undef CALVIN_CAMERA_LENSES_TILTED14_INL_HPP
#else
#define CALVIN_CAMERA_LENSES_TILTED14_INL_HPP
#endif

#include "calvin/camera/lenses/brown-inl.hpp"

namespace calvin::lens::HWY_NAMESPACE {

struct Tilted14 : Brown<14> {
  static constexpr std::string_view kName = "tilted14";
  static constexpr bool kCandidate = false;
};

}  // namespace calvin::lens::HWY_NAMESPACE

#endif  // CALVIN_CAMERA_LENSES_TILTED14_INL_HPP
