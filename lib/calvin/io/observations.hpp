// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Files of observations: what was seen of a board, frame by frame. docs/formats.md.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "calvin/core/export.hpp"
#include "calvin/core/observation.hpp"
#include "calvin/core/result.hpp"

namespace calvin {

// What read_observations() takes at most.
inline constexpr std::size_t kMaxObservationBytes = std::size_t{256} << 20;

struct ObservationFile {
  std::string board;  // board text; several are separated by ';'
  std::vector<Observation> observations;

  // The length in bytes of what is whole: less than the content where its last line is torn, as by
  // a loss of power, or not all of the views follow that its last reset tells. Whoever appends cuts
  // the file there first.
  std::size_t whole_bytes = 0;
};

// JSON lines: a header, then a line for each view. {"reset":true} forgets the views before it, and
// {"reset":true,"views":3} does so once three more lines of views follow. A last line without an
// end is left out; a broken line that has one is kMalformed, and the message names `name` and the
// line. Views of a file with several boards tell theirs.
[[nodiscard]] CALVIN_API Result<ObservationFile> parse_observations(std::string_view content,
                                                                    std::string_view name = "");

// parse_observations() of a file of at most kMaxObservationBytes. kNotFound where there is none,
// kIo where the system refuses or the path is a folder, a device or a larger file.
[[nodiscard]] CALVIN_API Result<ObservationFile> read_observations(
    const std::filesystem::path& path);

// The header, a reset and the line of one view, each with its end: for a file that is appended to.
// `views`: how many follow that take the place of all before. Numbers read back as the same. A
// sigma that is missing or not positive is 1. kInvalidArgument for what could not be read back: an
// observation without an image size, with another number of places or velocities than ids, or with
// numbers that are not finite.
[[nodiscard]] CALVIN_API std::string print_observation_header(std::string_view board);
[[nodiscard]] CALVIN_API std::string print_observation_reset(std::size_t views = 0);
[[nodiscard]] CALVIN_API Result<std::string> print_observation(const Observation& observation,
                                                               std::string_view board_of_file);
[[nodiscard]] CALVIN_API Result<std::string> print_observations(const ObservationFile& file);

// corners.vnl of mrcal and mrgingham: a row for each corner of the board, in the order of ids, or
// one row "name - - -" for a picture without a board. The fourth column, if there is one, is a
// level of the image pyramid, a whole number up to 16 (sigma = 2^level px), or a weight from 1e-6
// to 1e6 (sigma = 1 / weight px) where the legend says "weight"; '-', a negative one and a weight
// of 0 mark a corner that was not seen. The file tells neither the board nor the size of the
// pictures: the caller does. The names of the pictures are not kept.
[[nodiscard]] CALVIN_API Result<std::vector<Observation>> parse_corners_vnl(
    std::string_view content, std::string_view board, ImageSize image_size,
    std::string_view name = "");

// With weights, those beyond the limits at the limits; the pictures are called frame-000000.png and
// so on. kInvalidArgument where a board text is wrong or an id is not on its board, where there are
// not as many places as ids, and for one that is not finite.
[[nodiscard]] CALVIN_API Result<std::string> print_corners_vnl(
    const std::vector<Observation>& observations);

}  // namespace calvin
