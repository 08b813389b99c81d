// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Remarks: sentences on what is weak in a result, and what to do.

#include "calvin/solve/judge/remarks.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "calvin/camera/monotone.hpp"
#include "calvin/solve/judge/projection_error.hpp"

namespace calvin {

namespace {

// A solve with a larger sigma than these gets a remark.
constexpr double kWeakFocalSigma = 0.02;   // of the focal length
constexpr double kWeakCenterSigma = 0.02;  // of the image width

// Where the picture is much worse than the part of it that corners covered.
std::optional<std::string> uncovered(const Calibration& calibration) {
  constexpr double kMuchWorse = 3;
  constexpr double kWorthAView = 0.5;  // px
  const auto& worst = calibration.worst_place;
  const double anywhere = calibration.expected_error_anywhere.value_or(0);
  const double covered = calibration.expected_error.value_or(0);
  if (!worst || anywhere < std::max(kMuchWorse * covered, kWorthAView)) return std::nullopt;
  return fmt::format(
      "No corner was seen in the {}, where the picture is accurate to {:.3g} px only, against "
      "{:.3g} px among the corners: show the board there.",
      part_of_picture(*worst, calibration.image_size), 2 * anywhere, 2 * covered);
}

// The advice on a cause; where it was estimated, that the promise knows of it.
std::string told(const Misfit& misfit) {
  const std::string what = advice(misfit.noticed);
  return misfit.found() ? what : what + " The expected error has it already.";
}

}  // namespace

void add_remarks(Solution& solution, const Eigen::MatrixXd& c, const Camera& camera,
                 const Parameterization& parameterization) {
  const ImageSize size = camera.image_size();
  auto& remarks = solution.calibration.remarks;
  const auto variances = [&c](ParameterRange range) {
    return c.diagonal().segment(range.first, range.count);
  };
  const double center = std::sqrt(variances(parameterization.table.center(0)).maxCoeff());
  if (center > kWeakCenterSigma * size.width) {
    remarks.push_back(fmt::format(
        "The principal point is weak (+- {:.1f} px): all views are tilted much the same way. Tilt "
        "the board to the other side too.",
        center));
  }
  const ParameterRange range = parameterization.table.focal(0);
  double focal = 0;
  for (int i = range.first; i < range.end(); ++i) {
    const double value = solution.calibration.parameters[static_cast<std::size_t>(i)].value;
    focal = std::max(focal, std::sqrt(c(i, i)) / value);
  }
  if (focal > kWeakFocalSigma) {
    remarks.push_back(fmt::format(
        "The focal length is weak (+- {:.1f} %): tilt the board more, 30 to 45 degrees.",
        100 * focal));
  }
  if (solution.misfit.noticed != Misfit::Cause::kNone) {
    remarks.push_back(told(solution.misfit));
  }
  if (auto where = uncovered(solution.calibration)) remarks.push_back(std::move(*where));
  // The picture of a lens that sees past 90 degrees may end before the image does.
  if (!parameterization.lens.perspective) return;
  if (const Status one = check_monotone(camera); !one) {
    remarks.push_back(one.error().message);
  }
}

}  // namespace calvin
