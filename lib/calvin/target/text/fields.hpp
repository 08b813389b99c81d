// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The fields of a board's text, and what many of them hold. Internal.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "calvin/core/result.hpp"

namespace calvin {

// The fields of a text, after its kind.
using Fields = std::vector<std::string_view>;

// `why` is a phrase: see wrong_board_text() in target/board_name.hpp.
[[nodiscard]] tl::unexpected<Error> refuse_text(std::string why);

struct Sides {
  int cols = 0;
  int rows = 0;
};

// `what` has as many columns and rows, `least` of them along each side and `least_count` in all.
[[nodiscard]] Result<Sides> parse_sides(std::string_view text, std::string_view what, int least,
                                        int least_count);

// Whether a field is a size, as COLSxROWS is; a length has no x.
[[nodiscard]] bool is_size(std::string_view field);

// A length, m, that a square, a tag or a distance may have.
[[nodiscard]] Result<double> parse_side(std::string_view text, std::string_view what);

}  // namespace calvin
