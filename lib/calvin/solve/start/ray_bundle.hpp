// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What linear solutions for points and their rays do to the rays. Internal.
#pragma once

#include <vector>

#include <Eigen/Core>

namespace calvin {

// The linear map that takes a narrow bundle of rays to a wide one about z. It conditions the linear
// solution: in a narrow bundle, the same ray for all points fits nearly as well as the truth.
[[nodiscard]] Eigen::Matrix3d widening(const std::vector<Eigen::Vector3d>& rays);

// Replaces the weights of rays by Cauchy's of the angles by which the solution misses them, with
// the median angle as its scale; false, and no change, where no ray is far off the others. `angles`
// are small ones in rad, or what grows with them. A ray that is zero, one per point that is not
// seen, does not count; there is one at least that is not.
[[nodiscard]] bool reweight_far_off(const std::vector<Eigen::Vector3d>& rays,
                                    const std::vector<double>& angles,
                                    std::vector<double>& weights);

}  // namespace calvin
