// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Lengths with their units.

#include "calvin/target/board_name.hpp"

#include <array>
#include <cmath>
#include <string_view>

#include <fmt/format.h>

#include "calvin/core/text.hpp"
#include "calvin/target/board.hpp"

namespace calvin {

namespace {

struct Unit {
  std::string_view name;
  double metres;
};
constexpr std::array<Unit, 5> kUnits = {
    {{"mm", 1e-3}, {"cm", 1e-2}, {"um", 1e-6}, {"in", 0.0254}, {"m", 1}}};

}  // namespace

std::string length_text(double metres) {
  return fmt::format("{}mm", std::round(metres * 1e9) / 1e6);
}

Result<double> parse_length(std::string_view text) {
  for (const Unit& unit : kUnits) {
    if (!text.ends_with(unit.name)) continue;
    const auto number = parse_double(trim(text.substr(0, text.size() - unit.name.size())));
    if (!number) break;
    if (!(*number > 0)) {
      return make_error(ErrorCode::kInvalidArgument,
                        fmt::format("'{}' is not a positive length", text));
    }
    return *number * unit.metres;
  }
  return make_error(
      ErrorCode::kInvalidArgument,
      fmt::format("'{}' is not a length with a unit (mm, cm, m, in, um), like 25mm", text));
}

}  // namespace calvin
