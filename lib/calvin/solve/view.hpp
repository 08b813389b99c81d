// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A view: the corners of one board in one frame, the measurement from which cameras are solved.
#pragma once

#include <span>

#include "calvin/core/export.hpp"
#include "calvin/core/image.hpp"
#include "calvin/core/observation.hpp"
#include "calvin/core/result.hpp"
#include "calvin/target/board.hpp"

namespace calvin {

// One board as seen in one frame. A corner counts by 1 / sigma^2; a sigma that is missing, less
// than 1e-6 px or more than 1e6 px counts as 1 px, and then only the ratios of the sigmas are
// believed. Where corners are worse than their sigmas say, a sigma that all of them have in common
// is added.
struct View {
  Observation observation;
  Board board;
};

// Whether the sigma of a corner, px, is believed. Beyond these limits no camera sees and no corner
// is worth anything: such sigmas are mistakes, whose squares have no place among numbers of double
// precision either.
[[nodiscard]] constexpr bool is_known_sigma(double sigma) noexcept {
  return sigma >= 1e-6 && sigma <= 1e6;
}

// kInvalidArgument for a size of less than 1 or more than 65536 px.
[[nodiscard]] CALVIN_API Status check_image_size(ImageSize size);

// Whether a view can be fed to solve(): ids within the board and none twice, as many corners as
// ids, all finite and within the image (5 % of its size beyond the border are tolerated), a
// velocity for each or for none. kInvalidArgument otherwise. Whether the corners are enough is not
// looked at.
[[nodiscard]] CALVIN_API Status check(const View& view, ImageSize image_size);

// ---- Internal, and not exported

// Whether the view says that its image is of another size than this one.
[[nodiscard]] bool is_off_size(const Observation& seen, ImageSize size) noexcept;

// kInvalidArgument where views were found and all of them are of images of another size.
[[nodiscard]] Status check_sizes(std::span<const View> views, ImageSize size);

// check(), of a view that is held against a camera whose images are of this size: kInvalidArgument
// too where the view is of images of another size.
[[nodiscard]] Status check_before_camera(const View& view, ImageSize of_camera);

// Whether what one camera sees of a board tells where it is: kUnsupported for a light, which is one
// point and has to be seen by several cameras at a time.
[[nodiscard]] Status check_has_pose(const Board& board);

}  // namespace calvin
