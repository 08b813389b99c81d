// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Boards from the command line: draw one to true scale, give it a name, list the names of a file,
// measure the sheet that a name stands for, tell which board a picture shows.
#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "calvin/core/file.hpp"
#include "calvin/core/text.hpp"
#include "calvin/draw/board_drawing.hpp"
#include "calvin/io/board_names.hpp"
#include "calvin/session/files/calibration_files.hpp"

#include "board_identify.hpp"
#include "board_measure.hpp"
#include "tool_main.hpp"

namespace {

constexpr int kFailed = 1;
constexpr int kWrongUsage = 2;

constexpr std::string_view kUsage = R"(Usage:
  calvin-board draw BOARD FILE.(pdf|svg|png) [--paper PAPER | --tiled PAPER] [--dpi DPI]
  calvin-board add FILE.json NAME BOARD
  calvin-board list FILE.json
  calvin-board measure FILE.json#NAME [--model MODEL] FOLDER|OBSERVATIONS...
  calvin-board identify PICTURE... [--side SIDE]

BOARD is a text like checkerboard:9x6:25mm or puzzle:14x9:20mm (inner corners, side of a square),
checkerboard:9x6:25mm:circles (with three circles in its middle, or :circles=1.1+2.1+1.2),
charuco:5x7:40mm:20mm:DICT_6X6_250 (squares, their side, that of a marker, its dictionary),
aprilgrid:6x6:88mm:0.3 (tags, their side, the gap between them as a part of it),
aruco:5x7:40mm:10mm:DICT_6X6_250 or apriltag:tag36h11:5x7:40mm:10mm (tags, their side, the gap between
them, their dictionary or family, without squares between their corners; families are AprilTag's, such
as tagStandard41h12, whose gaps hold bits),
apriltag:tag36h11:80mm:3=0,0+7=250mm,0,90 (tags of that side at these places, the second one turned),
circles:7x5:30mm, acircles:4x11:20mm or dots:14x10:7mm:rings=2.2+12.2+2.8 (circles, their distance,
which of them are rings; big=0.0 for larger ones), dots:1mm or lines:1mm (200 of them along each side,
of which any part is enough), or FILE.json#NAME. Of dot, a moving light, there is
nothing to draw.
PAPER is {}, auto (the smallest of A4 to A0) or fit (as large as the board needs).
With --tiled the board goes over as many sheets of PAPER as it needs, to be cut at their marks and glued
edge to edge: pages of a PDF, or FILE-1.png, FILE-2.png, ... row by row.
DPI is the resolution of a PNG, {} if not given.
FOLDER has pictures of the board by one camera, OBSERVATIONS is a file of them; MODEL is the lens of
these cameras, brown5 if not given.
SIDE is what a square, a tag or the distance of circles measures, which no picture tells; 25mm if
not given.
)";

std::string usage() {
  return fmt::format(fmt::runtime(kUsage), calvin::join(calvin::paper_names(), ", "),
                     calvin::kDefaultDpi);
}

int failed(const calvin::Error& error) {
  fmt::print(stderr, "calvin-board: {}\n", error.message);
  return kFailed;
}

int wrong_usage(std::string_view why) {
  fmt::print(stderr, "calvin-board: {}\n{}", why, usage());
  return kWrongUsage;
}

// The name of one of several files: "board-2.png".
std::string numbered(const std::string& file, std::size_t number) {
  const auto dot = file.rfind('.');
  return fmt::format("{}-{}{}", file.substr(0, dot), number, file.substr(dot));
}

int draw_tiled(const calvin::Board& board, const std::string& file,
               const calvin::DrawingOptions& options) {
  const auto files = calvin::draw_tiles(board, options);
  if (!files) return failed(files.error());
  for (std::size_t i = 0; i < files->size(); ++i) {
    const std::string name = files->size() == 1 ? file : numbered(file, i + 1);
    if (const auto written = calvin::write_file(name, (*files)[i]); !written) {
      return failed(written.error());
    }
  }
  const auto tiles = calvin::lay_out_tiles(board, options.paper);
  const calvin::BoardTile& last = tiles->back();
  fmt::print("{}: {} on {} sheets of {:.1f} x {:.1f} mm, {} columns and {} rows\n",
             files->size() == 1 ? file : numbered(file, 1) + " ...", board.text(), tiles->size(),
             last.page.width * 1e3, last.page.height * 1e3, last.cols, last.rows);
  return 0;
}

int draw_on_one_page(const calvin::Board& board, const std::string& file,
                     const calvin::DrawingOptions& options) {
  const auto bytes = calvin::draw_board(board, options);
  if (!bytes) return failed(bytes.error());
  if (const auto written = calvin::write_file(file, *bytes); !written) {
    return failed(written.error());
  }
  const auto page = calvin::lay_out_board(board, options.paper);
  fmt::print("{}: {} on a page of {:.1f} x {:.1f} mm\n", file, board.text(), page->width * 1e3,
             page->height * 1e3);
  return 0;
}

int draw(std::span<char*> arguments) {
  if (arguments.size() < 2 || arguments.size() % 2 != 0) {
    return wrong_usage("draw needs a board and a file.");
  }
  calvin::DrawingOptions options;
  bool is_tiled = false;
  bool has_paper = false;
  for (std::size_t i = 2; i < arguments.size(); i += 2) {
    const std::string_view name = arguments[i];
    const std::string_view value = arguments[i + 1];
    const auto number = calvin::parse_double(value);
    if (name == "--paper" || name == "--tiled") {
      if (std::exchange(has_paper, true)) {
        return wrong_usage("a drawing has either one --paper or is --tiled over several.");
      }
      options.paper = value;
      is_tiled = name == "--tiled";
    } else if (name == "--dpi" && number) {
      options.dpi = *number;
    } else {
      return wrong_usage(fmt::format("'{} {}' is not an option.", name, value));
    }
  }
  const std::string file = arguments[1];
  const auto boards = calvin::parse_boards(arguments[0]);
  if (!boards) return failed(boards.error());
  if (boards->size() != 1) return wrong_usage("one drawing holds one board.");
  const auto format = calvin::drawing_format(file);
  if (!format) return failed(format.error());
  options.format = *format;
  return is_tiled ? draw_tiled(boards->front(), file, options)
                  : draw_on_one_page(boards->front(), file, options);
}

// How many views have measured the board that has this name in a file, where another one is to have
// it: what they told is then of no board any more.
std::size_t lost_views(const std::string& file, std::string_view name, std::string_view text) {
  const auto boards = calvin::list_boards(file);
  const auto next = calvin::parse_board(text);
  if (!boards || !next) return 0;
  const auto known = std::ranges::find(*boards, name, &calvin::NamedBoard::name);
  if (known == boards->end()) return 0;
  const auto before = calvin::parse_board(known->text);
  return before && *before == *next ? 0 : known->measured_by;
}

int add(std::span<char*> arguments) {
  if (arguments.size() != 3) return wrong_usage("add needs a file, a name and a board.");
  const std::string file = arguments[0];
  const std::size_t lost = lost_views(file, arguments[1], arguments[2]);
  if (lost > 0) {
    if (const auto kept = calvin::keep_copy(file); !kept) return failed(kept.error());
  }
  const auto added = calvin::add_board(file, arguments[1], arguments[2]);
  if (!added) return failed(added.error());
  if (lost > 0) {
    fmt::print(
        "What {} views had measured of '{}' was of another board: the file as it was is {}\n", lost,
        arguments[1], calvin::copy_of(file));
  }
  fmt::print("Use it as board={}#{}\n", file, arguments[1]);
  return 0;
}

int list(std::span<char*> arguments) {
  if (arguments.size() != 1) {
    return wrong_usage(fmt::format("list takes one file, and {} are given.", arguments.size()));
  }
  const auto boards = calvin::list_boards(arguments[0]);
  if (!boards) return failed(boards.error());
  int status = 0;
  for (const calvin::NamedBoard& board : *boards) {
    const std::string measured =
        board.measured_by > 0 ? fmt::format("\tmeasured by {} views", board.measured_by) : "";
    fmt::print("{}\t{}{}\n", board.name, board.text, measured);
    if (const auto right = calvin::parse_board(board.text); !right) status = failed(right.error());
  }
  return status;
}

int measure(std::span<char*> arguments) {
  std::string model = "brown5";
  std::vector<std::string> words;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    if (std::string_view(arguments[i]) == "--model" && i + 1 < arguments.size()) {
      model = arguments[++i];
    } else {
      words.emplace_back(arguments[i]);
    }
  }
  if (words.size() < 2) return wrong_usage("measure needs a named board, and pictures of it.");
  const std::string named = words.front();
  words.erase(words.begin());
  const auto learnt = board_measure::measure(named, model, words);
  if (!learnt) return failed(learnt.error());
  if (!*learnt) {
    fmt::print(stderr, "calvin-board: nothing new was learnt of {}.\n", named);
    return kFailed;
  }
  fmt::print("Use it as board={}\n", named);
  return 0;
}

int identify(std::span<char*> arguments) {
  double side = 0.025;  // m
  std::vector<std::string> pictures;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    if (std::string_view(arguments[i]) != "--side" || i + 1 == arguments.size()) {
      pictures.emplace_back(arguments[i]);
      continue;
    }
    const auto length = calvin::parse_length(arguments[++i]);
    if (!length || !(*length > 0)) return wrong_usage("a side is a length like 25mm.");
    side = *length;
  }
  if (pictures.empty()) return wrong_usage("identify needs a picture.");
  int status = 0;
  for (const std::string& picture : pictures) {
    const auto seen = board_identify::identify(picture, side);
    if (!seen) status = failed(seen.error());
    if (seen && !*seen) status = kFailed;
  }
  return status;
}

int run_tool(int argc, char** argv) {
  const std::span<char*> arguments(argv, static_cast<std::size_t>(argc));
  if (arguments.size() < 2) return wrong_usage("what shall it do?");
  const std::string_view command = arguments[1];
  if (command == "draw") return draw(arguments.subspan(2));
  if (command == "add") return add(arguments.subspan(2));
  if (command == "list") return list(arguments.subspan(2));
  if (command == "measure") return measure(arguments.subspan(2));
  if (command == "identify") return identify(arguments.subspan(2));
  if (command == "--help") {
    fmt::print("{}", usage());
    return 0;
  }
  return wrong_usage(fmt::format("there is no command '{}'.", command));
}

}  // namespace

int main(int argc, char** argv) { return calvin_tools::run("calvin-board", run_tool, argc, argv); }
