// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Reads sizes and lengths of a board's text.

#include "calvin/target/text/fields.hpp"

#include <utility>

#include <fmt/format.h>

#include "calvin/core/text.hpp"
#include "calvin/target/board.hpp"

namespace calvin {

namespace {

constexpr int kMaxSide = 200;

}  // namespace

tl::unexpected<Error> refuse_text(std::string why) {
  return make_error(ErrorCode::kInvalidArgument, std::move(why));
}

Result<Sides> parse_sides(std::string_view text, std::string_view what, int least,
                          int least_count) {
  const auto sides = split(text, 'x');
  const auto cols = parse_int(sides.front());
  const auto rows = parse_int(sides.back());
  if (sides.size() != 2 || !cols || !rows)
    return refuse_text(fmt::format("'{}' is not COLSxROWS", text));
  if (*cols < least || *rows < least || *cols > kMaxSide || *rows > kMaxSide ||
      *cols * *rows < least_count) {
    const int longer = least_count / least;
    return refuse_text(fmt::format("{}x{} {} is out of range ({}x{} to {}x{})", *cols, *rows, what,
                                   longer, least, kMaxSide, kMaxSide));
  }
  return Sides{*cols, *rows};
}

Result<double> parse_side(std::string_view text, std::string_view what) {
  const auto size = parse_length(text);
  if (!size) return size;
  if (*size < 1e-6 || *size > 1000) {
    return refuse_text(fmt::format("{} of {} are out of range (1um to 1000m)", what, text));
  }
  return size;
}

bool is_size(std::string_view field) { return split(field, 'x').size() > 1; }

}  // namespace calvin
