// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What the cameras of a rig have seen, and the pictures that were taken at the same time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "calvin/core/calibration.hpp"
#include "calvin/core/export.hpp"
#include "calvin/core/image.hpp"
#include "calvin/core/rig.hpp"
#include "calvin/solve/view.hpp"

namespace calvin {

// A camera whose intrinsics are known, and every board that it has seen.
struct RigCameraViews {
  Calibration calibration;  // its `camera` is the camera's name
  std::vector<View> views;  // with timestamps of a clock that all cameras share
};

// What the cameras of a rig have seen, as the rig lists them and with its intrinsics; those of
// which `seen` has nothing have no views.
[[nodiscard]] CALVIN_API std::vector<RigCameraViews> views_of_rig(
    const Rig& rig, const std::vector<RigCameraViews>& seen);

// A view by its camera and its place in that camera's list.
struct RigView {
  std::size_t camera = 0;
  std::size_t view = 0;
};

// Pictures of one time: of each board at most one of a camera.
struct Instant {
  std::uint64_t timestamp = 0;  // ns, of the first one
  std::vector<RigView> views;   // by camera, then as the camera lists them
};

// Which instants tell something of a rig: those in which two cameras or more have seen a board;
// where boards are fixed to each other, two boards or more were seen by whatever cameras; where
// intrinsics are not known, all.
enum class InstantsOf { kTwoCameras, kTwoViews, kAny };

struct Instants {
  std::vector<Instant> instants;
  std::uint64_t farthest = 0;  // ns, between two pictures of one instant, at the most
};

// Pictures that are at most `tolerance` ns apart are of one instant; where a camera has several,
// the first one. A picture belongs to one instant. Views without a timestamp are left out.
[[nodiscard]] CALVIN_API Instants pair_instants(const std::vector<RigCameraViews>& cameras,
                                                std::uint64_t tolerance,
                                                InstantsOf of = InstantsOf::kTwoCameras);

// ---- Internal, and not exported

// When each view of a camera was taken, ns, as its camera lists them; kNoTimestamp for one that
// does not count.
using ViewTimes = std::vector<std::uint64_t>;

// pair_instants() of the times alone.
[[nodiscard]] Instants pair_instants(const std::vector<ViewTimes>& cameras, std::uint64_t tolerance,
                                     InstantsOf of = InstantsOf::kTwoCameras);

// What moves farther between two pictures of one instant, px, is of no use: nobody knows how.
inline constexpr double kFarthestWay = 5;

// A point that moves, some time before it was seen, or after it.
struct EarlierPoint {
  Pixel uv;
  double sigma = 0;  // px, what may be wrong with the way in between
};

// `velocity` in px/s, by `seconds` earlier.
[[nodiscard]] EarlierPoint earlier_point(Pixel uv, Pixel velocity, double seconds);

// Two cameras, and how many views hold them together.
struct CameraPair {
  std::size_t a = 0;
  std::size_t b = 0;
  std::size_t views = 0;
};

// The pair of a list by which the tree of the best pairs (R. C. Prim, Bell System Technical Journal
// 36, 1957) hangs most loosely, by its place in the list; absent for an empty list.
[[nodiscard]] std::optional<std::size_t> weakest_pair(const std::vector<CameraPair>& pairs);

}  // namespace calvin
