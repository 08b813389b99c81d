// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Parses the texts of boards with markers.

#include "calvin/target/text/marker_text.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "calvin/core/text.hpp"
#include "calvin/target/kinds.hpp"

namespace calvin {

namespace {

// What libapriltag alone has.
constexpr std::array<std::string_view, 5> kOfAprilTag3 = {
    "tagStandard41h12", "tagStandard52h13", "tagCustom48h12", "tagCircle21h7", "tagCircle49h12"};

// Why a build does not know what its libraries have.
std::optional<tl::unexpected<Error>> explain_missing_library(std::string_view name) {
  if (marker_dictionaries().empty()) {
    return refuse_text(
        "this build knows no dictionary of markers: it was made without OpenCV and libapriltag. "
        "Install libopencv-dev and libapriltag-dev and build it with -Dopencv=enabled "
        "-Dapriltag=enabled, or take a PuzzleBoard, which needs none");
  }
  if (name.starts_with("DICT_") && !has_opencv_dictionaries()) {
    return refuse_text(
        fmt::format("this build does not know '{}': it was made without OpenCV, and lacks boards "
                    "with OpenCV's dictionaries. Install libopencv-dev and build it with "
                    "-Dopencv=enabled, or take a PuzzleBoard, which needs none",
                    name));
  }
  const auto is_named = [name](std::string_view family) {
    return name == family || name == family.substr(3);
  };
  const bool is_april = std::ranges::any_of(kOfAprilTag3, is_named);
  if (!is_april || has_april_tag_3()) return std::nullopt;
  std::vector<std::string> boards;
  for (const std::string_view family : kOfAprilTag3) {
    boards.push_back(fmt::format("apriltag:{}:...", family));
  }
  return refuse_text(
      fmt::format("this build does not know '{}': it was made without libapriltag, and lacks the "
                  "boards {}. Install libapriltag-dev and build it with -Dapriltag=enabled",
                  name, join(boards, ", ")));
}

// But for capitals, and for what all names of a library begin with.
bool is_meant(std::string_view name, std::string_view known) {
  const auto small = [](unsigned char c) { return std::tolower(c); };
  const auto are_alike = [&](std::string_view a) {
    return std::ranges::equal(a, name, {}, small, small);
  };
  return are_alike(known) || std::ranges::any_of(std::array{"DICT_", "tag"}, [&](const char* all) {
           return known.starts_with(all) && are_alike(known.substr(std::strlen(all)));
         });
}

// As 5x7.
bool is_size(std::string_view text) {
  const auto is_part = [](char c) {
    return c == 'x' || std::isdigit(static_cast<unsigned char>(c));
  };
  return text.find('x') != std::string_view::npos && std::ranges::all_of(text, is_part);
}

Result<const MarkerDictionary*> parse_dictionary(std::string_view name) {
  if (const MarkerDictionary* dictionary = find_dictionary(name)) return dictionary;
  if (auto missing = explain_missing_library(name)) return *std::move(missing);
  std::vector<std::string> names;
  for (const MarkerDictionary& known : marker_dictionaries()) names.emplace_back(known.name);
  const auto meant = std::ranges::find_if(
      names, [name](const std::string& known) { return is_meant(name, known); });
  if (meant != names.end()) {
    return refuse_text(fmt::format("there is no dictionary '{}', but '{}'", name, *meant));
  }
  const std::string_view missing =
      is_size(name) ? "a dictionary or family is missing before" : "there is no dictionary";
  return refuse_text(fmt::format("{} '{}'; known are {}", missing, name, join(names, ", ")));
}

// The name of a dictionary, or of a family of AprilTags as they and Kalibr call it.
Result<const MarkerDictionary*> parse_family(std::string_view name) {
  if (const MarkerDictionary* dictionary = find_family(name)) return dictionary;
  return parse_dictionary(name);
}

// One of the fields behind the gap of an AprilGrid.
Status parse_april_option(std::string_view field, AprilGrid& board) {
  const auto pair = split(field, '=');
  const auto value = pair.size() == 2 ? parse_int(pair[1]) : std::nullopt;
  if (pair[0] == "border" || pair[0] == "first") {
    if (!value) return refuse_text(fmt::format("'{}' is no whole number", field));
    (pair[0] == "border" ? board.border : board.first) = *value;
    return {};
  }
  const auto dictionary = parse_family(field);
  if (!dictionary) return tl::unexpected(dictionary.error());
  board.dictionary = *dictionary;
  return {};
}

// The fields behind the measures of a grid of tags, or behind the places of a list, where every tag
// has its id: `first` is null then.
template <typename Kind>
Status parse_tag_options(std::span<const std::string_view> fields, Kind& board, int* first) {
  for (const std::string_view field : fields) {
    if (field == "inverted") {
      board.inverted = true;
      continue;
    }
    const auto pair = split(field, '=');
    int* const to = pair[0] == "border" ? &board.border : pair[0] == "first" ? first : nullptr;
    if (to == nullptr) {
      return refuse_text(fmt::format("'{}' is none of {}'border=' and 'inverted'", field,
                                     first != nullptr ? "'first=', " : ""));
    }
    const auto value = pair.size() == 2 ? parse_int(pair[1]) : std::nullopt;
    if (!value) return refuse_text(fmt::format("'{}' is no whole number", field));
    *to = *value;
  }
  return board.check();
}

// Of the fields of a grid of tags `name` is the dictionary's, those from `measures` on are the
// measures, those from `options` on the rest.
Result<Board> parse_tags(const Fields& fields, std::size_t name, std::size_t measures,
                         std::size_t options, TagGrid board) {
  if (fields.size() < options) {
    return refuse_text(
        "it needs a kind, a size in tags, the side of a tag, the gap between tags and a "
        "dictionary");
  }
  const auto sides = parse_sides(fields[measures], "tags", 1, 1);
  if (!sides) return tl::unexpected(sides.error());
  const auto tag = parse_side(fields[measures + 1], "tags");
  if (!tag) return tl::unexpected(tag.error());
  const auto gap = parse_side(fields[measures + 2], "gaps");
  if (!gap) return tl::unexpected(gap.error());
  const auto dictionary = board.april ? parse_family(fields[name]) : parse_dictionary(fields[name]);
  if (!dictionary) return tl::unexpected(dictionary.error());
  board.cols = sides->cols;
  board.rows = sides->rows;
  board.tag = *tag;
  board.gap = *gap;
  board.dictionary = *dictionary;
  const auto rest = std::span(fields).subspan(options);
  if (const Status status = parse_tag_options(rest, board, &board.first); !status) {
    return tl::unexpected(status.error());
  }
  return board;
}

// "0", "250mm", "-0.4m": a coordinate, m.
Result<double> parse_coordinate(std::string_view text) {
  constexpr double kFarthest = 1000;  // m
  if (parse_double(text) == 0) return 0;
  const bool is_negative = text.starts_with('-');
  const auto length = parse_length(is_negative ? text.substr(1) : text);
  if (!length) return length;
  if (*length > kFarthest) return refuse_text(fmt::format("'{}' is farther away than 1000m", text));
  const double rounded = std::round(*length * 1e9) / 1e9;  // to a nanometre, as texts have it
  return is_negative ? -rounded : rounded;
}

// "X,Y", "X,Y,TURN" or "X,Y,Z,RX,RY,RZ": where a tag has its middle and how it is turned.
Status parse_pose(std::string_view text, TagList::Tag& tag) {
  const auto numbers = split(text, ',');
  const std::size_t count = numbers.size();
  if (count != 2 && count != 3 && count != 6) {
    return refuse_text(fmt::format(
        "'{}' is none of X,Y and X,Y,TURN and X,Y,Z,RX,RY,RZ: lengths, and degrees", text));
  }
  const std::size_t lengths = count == 6 ? 3 : 2;
  for (std::size_t i = 0; i < lengths; ++i) {
    const auto x = parse_coordinate(numbers[i]);
    if (!x) return tl::unexpected(x.error());
    tag.middle[i] = *x;
  }
  for (std::size_t i = lengths; i < count; ++i) {
    const auto degrees = parse_double(numbers[i]);
    if (!degrees || std::abs(*degrees) > 360) {
      return refuse_text(fmt::format("'{}' is no angle of -360 to 360 degrees", numbers[i]));
    }
    tag.turn[count == 6 ? i - lengths : 2] = std::round(*degrees * 1e6) / 1e6;
  }
  return {};
}

// "3=0,0+7/120mm=250mm,0,90": the tags of a list, of `size` m where nothing is said.
Result<std::vector<TagList::Tag>> parse_placed_tags(std::string_view text, double size) {
  std::vector<TagList::Tag> tags;
  for (const std::string_view one : split(text, '+')) {
    const auto pair = split(one, '=');
    const auto name = split(pair[0], '/');
    const auto id = parse_int(name[0]);
    if (pair.size() != 2 || name.size() > 2 || !id) {
      return refuse_text(fmt::format("'{}' is not ID=X,Y, a tag and its place", one));
    }
    TagList::Tag tag{*id, size, {}, {}};
    if (name.size() == 2) {
      const auto own = parse_side(name[1], "tags");
      if (!own) return tl::unexpected(own.error());
      tag.size = *own;
    }
    if (const Status status = parse_pose(pair[1], tag); !status) {
      return tl::unexpected(status.error());
    }
    tags.push_back(tag);
  }
  std::ranges::sort(tags, {}, &TagList::Tag::id);
  return tags;
}

// As parse_tags(), of a list: its measures are the side of a tag and the tags with their places.
Result<Board> parse_tag_list(const Fields& fields, std::size_t name, std::size_t measures,
                             TagList board) {
  constexpr std::size_t kOptions = 3;
  if (fields.size() < kOptions) {
    return refuse_text(
        "it needs a kind, the side of a tag, tags with their places and a dictionary");
  }
  const auto side = parse_side(fields[measures], "tags");
  if (!side) return tl::unexpected(side.error());
  const auto dictionary = board.april ? parse_family(fields[name]) : parse_dictionary(fields[name]);
  if (!dictionary) return tl::unexpected(dictionary.error());
  auto tags = parse_placed_tags(fields[measures + 1], *side);
  if (!tags) return tl::unexpected(tags.error());
  board.size = *side;
  board.dictionary = *dictionary;
  board.tags = std::move(*tags);
  const auto rest = std::span(fields).subspan(kOptions);
  if (const Status status = parse_tag_options(rest, board, nullptr); !status) {
    return tl::unexpected(status.error());
  }
  return board;
}

// Whether the measures of tags are those of a list: it has no COLSxROWS.
bool is_list(const Fields& fields, std::size_t measures) {
  return fields.size() > measures && !is_size(fields[measures]);
}

}  // namespace

Result<Board> parse_charuco(const Fields& fields) {
  if (fields.size() < 4) {
    return refuse_text(
        "it needs a kind, a size in squares, the sides of a square and of a marker, and a "
        "dictionary");
  }
  const auto sides = parse_sides(fields[0], "squares", 3, 9);
  if (!sides) return tl::unexpected(sides.error());
  const auto square = parse_side(fields[1], "squares");
  if (!square) return tl::unexpected(square.error());
  const auto marker = parse_side(fields[2], "markers");
  if (!marker) return tl::unexpected(marker.error());
  const auto dictionary = parse_dictionary(fields[3]);
  if (!dictionary) return tl::unexpected(dictionary.error());
  CharucoBoard board{sides->cols, sides->rows, *square, *marker, *dictionary};
  for (std::size_t i = 4; i < fields.size(); ++i) {
    if (fields[i] == "legacy") {
      board.legacy = true;
    } else if (fields[i] == "inverted") {
      board.inverted = true;
    } else {
      return refuse_text(fmt::format("'{}' is neither 'legacy' nor 'inverted'", fields[i]));
    }
  }
  if (const Status status = board.check(); !status) return tl::unexpected(status.error());
  return board;
}

Result<Board> parse_april_grid(const Fields& fields) {
  if (fields.size() < 3) {
    return refuse_text(
        "it needs a kind, a size in tags, the side of a tag and the gap between tags as a part of "
        "it");
  }
  const auto sides = parse_sides(fields[0], "tags", 2, 4);
  if (!sides) return tl::unexpected(sides.error());
  const auto tag = parse_side(fields[1], "tags");
  if (!tag) return tl::unexpected(tag.error());
  const auto spacing = parse_double(fields[2]);
  if (!spacing)
    return refuse_text(fmt::format("'{}' is no gap, as 0.3 of a tag's side is", fields[2]));
  const auto family = parse_family(AprilGrid::kUsualFamily);
  if (!family) return tl::unexpected(family.error());
  AprilGrid board{sides->cols, sides->rows, *tag, *spacing, *family};
  for (std::size_t i = 3; i < fields.size(); ++i) {
    if (const Status status = parse_april_option(fields[i], board); !status) {
      return tl::unexpected(status.error());
    }
  }
  if (const Status status = board.check(); !status) return tl::unexpected(status.error());
  return board;
}

Result<Board> parse_aruco(const Fields& fields) {
  if (is_list(fields, 0)) return parse_tag_list(fields, 2, 0, {});
  return parse_tags(fields, 3, 0, 4, {});
}

Result<Board> parse_april_tags(const Fields& fields) {
  if (is_list(fields, 1)) {
    TagList list;
    list.april = true;
    return parse_tag_list(fields, 0, 1, std::move(list));
  }
  TagGrid board;
  board.april = true;
  return parse_tags(fields, 0, 1, 4, board);
}

}  // namespace calvin
