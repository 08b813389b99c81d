// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

#include "calvin/solve/freedom.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace calvin {

int Freedom::pinhole_directions() const {
  return static_cast<int>(std::count(estimated.begin(), estimated.begin() + 4, true)) -
         (aspect ? 1 : 0);
}

Result<Freedom> make_freedom(std::span<const std::string_view> names,
                             std::span<const std::string> fix) {
  Freedom freedom;
  freedom.estimated.assign(names.size(), true);
  for (const std::string& word : fix) {
    const auto at = std::find(names.begin(), names.end(), word);
    if (word == "aspect") {
      freedom.aspect = true;
    } else if (word == "center") {
      freedom.center_x = freedom.center_y = true;
    } else if (word == "cx") {
      freedom.center_x = true;
    } else if (word == "cy") {
      freedom.center_y = true;
    } else if (at != names.end() && at - names.begin() >= 4) {
      freedom.estimated[static_cast<std::size_t>(at - names.begin())] = false;
    } else {
      return make_error(
          ErrorCode::kInvalidArgument,
          fmt::format("'{}' cannot be fixed. What can: aspect, center, cx, cy{}{}.", word,
                      names.size() > 4 ? ", " : "", fmt::join(names.subspan(4), ", ")));
    }
  }
  freedom.estimated[2] = !freedom.center_x;
  freedom.estimated[3] = !freedom.center_y;

  const auto rows = static_cast<Eigen::Index>(names.size());
  freedom.basis = Eigen::MatrixXd::Zero(rows, rows);
  Eigen::Index column = 0;
  for (Eigen::Index row = 0; row < rows; ++row) {
    if (!freedom.estimated[static_cast<std::size_t>(row)]) continue;
    if (row == 1 && freedom.aspect) {
      freedom.basis(1, 0) = 1;
    } else {
      freedom.basis(row, column++) = 1;
    }
  }
  freedom.basis.conservativeResize(Eigen::NoChange, column);
  return freedom;
}

}  // namespace calvin
