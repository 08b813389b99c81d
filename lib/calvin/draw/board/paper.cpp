// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The papers by their names, and what a board needs of them.

#include "calvin/draw/board/paper.hpp"

#include <algorithm>
#include <array>
#include <vector>

#include <fmt/format.h>

#include "calvin/core/text.hpp"
#include "calvin/draw/board/layout.hpp"
#include "calvin/target/kinds.hpp"

namespace calvin {

namespace {

constexpr std::array<Paper, 8> kPapers = {{
    {"letter", 0.2159, 0.2794, false},
    {"a4", 0.210, 0.297, true},
    {"legal", 0.2159, 0.3556, false},
    {"tabloid", 0.2794, 0.4318, false},
    {"a3", 0.297, 0.420, true},
    {"a2", 0.420, 0.594, true},
    {"a1", 0.594, 0.841, true},
    {"a0", 0.841, 1.189, true},
}};

}  // namespace

std::span<const Paper> papers() noexcept { return kPapers; }

std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return result;
}

std::vector<std::string> paper_names() {
  std::vector<std::string> names;
  for (const Paper& paper : kPapers) names.emplace_back(paper.name);
  return names;
}

tl::unexpected<Error> no_such_paper(std::string_view name, std::string_view others) {
  return make_error(ErrorCode::kInvalidArgument,
                    fmt::format("There is no paper called '{}'; use {}one of {}.", name, others,
                                join(paper_names(), ", ")));
}

double white_border(const Board& board) {
  return std::max(board.cell_size(board.ids().front()) / 2, kSmallestBorder);
}

Status check_printable(const Board& board) {
  if (board.as<PointLight>() != nullptr) {
    return make_error(
        ErrorCode::kInvalidArgument,
        fmt::format("The board {} is a light: there is nothing to print. Move an LED, "
                    "the spot of a laser pointer or a wand of LEDs before the cameras.",
                    board.text()));
  }
  if (const auto* points = board.as<PointBoard>()) {
    const auto is_dot = [](const PointBoard::Dot& dot) { return dot.diameter > 0; };
    if (!points->is_flat() || std::ranges::none_of(points->dots(), is_dot)) {
      return make_error(
          ErrorCode::kInvalidArgument,
          fmt::format("The points of {} are {}: there is nothing to print. Round dots in the plane "
                      "z = 0 are printed, each with a diameter in the file.",
                      board.text(), points->is_flat() ? "without a size" : "not on a sheet"));
    }
  }
  const auto* list = board.as<TagList>();
  if (list != nullptr && !list->is_flat()) {
    return make_error(ErrorCode::kInvalidArgument,
                      "The tags of this board lie in space, not on a sheet. Draw each by itself, "
                      "such as apriltag:tag36h11:80mm:3=0,0.");
  }
  return {};
}

}  // namespace calvin
