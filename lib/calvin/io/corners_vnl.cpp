// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// corners.vnl of mrcal and mrgingham <-> observations. A vnlog: a legend "# filename x y level",
// rows of fields between white space, '-' for no value (github.com/dkogan/vnlog).

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "calvin/core/text.hpp"
#include "calvin/core/utf8.hpp"
#include "calvin/io/file_text.hpp"
#include "calvin/io/observations.hpp"
#include "calvin/target/board.hpp"

namespace calvin {

namespace {

// No picture has more halves: 2^16 pixels become one.
constexpr int kLastLevel = 16;

// Weights from its inverse up to this one: sigmas in px that a corner may have.
constexpr double kMostWeight = 1e6;

// What mrcal takes for the two kinds of fourth column: the sigma in px, 0 for a corner that was not
// seen, absent where it is neither.
std::optional<double> sigma_of_level(std::string_view word) {
  if (word == "-") return 0;
  const auto level = parse_double(word);
  if (!level || *level != std::trunc(*level) || *level > kLastLevel) return std::nullopt;
  return *level < 0 ? 0 : std::exp2(*level);
}

std::optional<double> sigma_of_weight(std::string_view word) {
  if (word == "-") return 0;
  const auto weight = parse_double(word);
  if (!weight) return std::nullopt;
  if (*weight <= 0) return 0;
  if (*weight < 1 / kMostWeight || *weight > kMostWeight) return std::nullopt;
  return 1 / *weight;
}

std::string wrong_column(std::string_view word, bool weights) {
  const std::string shown = shortened(word, 40);
  if (!weights) {
    return fmt::format("has the level '{}', which is no whole number up to {}", shown, kLastLevel);
  }
  return fmt::format("has the weight '{}', which is not between {} and {}, or 0", shown,
                     1 / kMostWeight, kMostWeight);
}

// The pictures, row by row.
class VnlReader {
 public:
  VnlReader(const Board& board, ImageSize size)
      : text_(board.text()), ids_(board.ids()), size_(size) {}

  // Why the row is refused; empty where it is not.
  std::string row(const std::vector<std::string_view>& words, bool weights) {
    if (words.size() < 3) return "has no name, x and y";
    if (words.size() > 4) return "has more than a name, x, y and a level or weight";
    if (words[0] != picture_ || seen_.empty() || next_ == count()) {
      if (std::string why = finish_picture(); !why.empty()) return why;
      picture_ = words[0];
      next_ = 0;
      seen_.push_back({});
      seen_.back().board = text_;
      seen_.back().image_size = size_;
    }
    if (words[1] == "-" || words[2] == "-") {
      // A picture without a board has one such row; a missing corner stands in its place.
      empty_row_ = next_ == 0;
      ++next_;
      return "";
    }
    return corner(words, weights);
  }

  // Of the last one.
  std::string finish_picture() {
    if (seen_.empty() || next_ == count() || (next_ == 1 && empty_row_)) return "";
    return fmt::format("follows {} corners of the picture {}, where the board has {}", next_,
                       shortened(picture_, 60), count());
  }

  std::vector<Observation> take() { return std::move(seen_); }

 private:
  [[nodiscard]] int count() const { return static_cast<int>(ids_.size()); }

  std::string corner(const std::vector<std::string_view>& words, bool weights) {
    const auto u = parse_double(words[1]);
    const auto v = parse_double(words[2]);
    if (!u || !v) return "has an x or y that is not a number";
    const int id = ids_[static_cast<std::size_t>(next_++)];
    empty_row_ = false;
    double sigma = 1;
    if (words.size() > 3) {
      const auto known = weights ? sigma_of_weight(words[3]) : sigma_of_level(words[3]);
      if (!known) return wrong_column(words[3], weights);
      if (*known == 0) return "";
      sigma = *known;
    }
    Observation& seen = seen_.back();
    seen.ids.push_back(id);
    seen.uv.push_back({*u, *v});
    seen.sigma.push_back(sigma);
    return "";
  }

  std::string text_;
  std::vector<int> ids_;  // of the board, in the order of the rows
  ImageSize size_;
  std::string picture_;
  int next_ = 0;  // of ids_, for the next corner
  bool empty_row_ = false;
  std::vector<Observation> seen_;
};

}  // namespace

Result<std::vector<Observation>> parse_corners_vnl(std::string_view content, std::string_view board,
                                                   ImageSize image_size, std::string_view name) {
  const auto parsed = parse_board(board);
  if (!parsed) return tl::unexpected(parsed.error());
  const auto refuse = [name](int line, std::string_view why) {
    return make_error(ErrorCode::kMalformed,
                      fmt::format("'{}' cannot be used as corners: line {} {}. Give a corners.vnl "
                                  "of mrcal or mrgingham, and the board that it was made with.",
                                  name, line, why));
  };
  VnlReader reader(*parsed, image_size);
  bool weights = false;
  bool legend = false;
  int number = 0;
  for (const std::string_view line : io::lines_of(content)) {
    ++number;
    if (line.empty() || line.starts_with("##") || line.starts_with("#!")) continue;
    auto words = words_of(line);
    if (line.starts_with('#')) {
      if (legend) continue;
      legend = true;
      words = words_of(line.substr(1));
      if (words.size() < 3 || words[0] != "filename" || words[1] != "x" || words[2] != "y") {
        return refuse(number, "does not say '# filename x y level'");
      }
      weights = words.size() > 3 && words[3] == "weight";
      if (words.size() > 3 && !weights && words[3] != "level") {
        return refuse(number, fmt::format("has a fourth column '{}', which is neither level nor "
                                          "weight",
                                          shortened(words[3], 40)));
      }
      continue;
    }
    if (!legend) return refuse(number, "comes before the legend '# filename x y level'");
    if (const std::string why = reader.row(words, weights); !why.empty()) {
      return refuse(number, why);
    }
  }
  if (!legend) return refuse(number, "ends the file, which has no legend '# filename x y level'");
  if (const std::string why = reader.finish_picture(); !why.empty()) return refuse(number + 1, why);
  return reader.take();
}

namespace {

Status check_places(const Observation& seen, std::size_t view) {
  const auto is_finite = [](const Pixel& p) { return std::isfinite(p.u) && std::isfinite(p.v); };
  if (seen.ids.size() == seen.uv.size() && std::ranges::all_of(seen.uv, is_finite)) return {};
  return make_error(ErrorCode::kInvalidArgument,
                    fmt::format("View {} has {} ids and {} places, or one that is no number: give "
                                "each id its place.",
                                view, seen.ids.size(), seen.uv.size()));
}

}  // namespace

Result<std::string> print_corners_vnl(const std::vector<Observation>& observations) {
  std::string text = "# filename x y weight\n";
  for (std::size_t k = 0; k < observations.size(); ++k) {
    const Observation& seen = observations[k];
    const std::string picture = fmt::format("frame-{:06}.png", k);
    const auto board = parse_board(seen.board);
    if (!board) return tl::unexpected(board.error());
    if (const Status good = check_places(seen, k); !good) return tl::unexpected(good.error());
    std::vector<std::string> rows(static_cast<std::size_t>(board->point_count()),
                                  picture + " - - -\n");
    for (std::size_t i = 0; i < seen.ids.size(); ++i) {
      const auto row = board->index_of(seen.ids[i]);
      if (!row) {
        return make_error(ErrorCode::kInvalidArgument,
                          fmt::format("The corner id {} of view {} is not on the board {}. Is this "
                                      "the board that was seen?",
                                      seen.ids[i], k, seen.board));
      }
      const double sigma = i < seen.sigma.size() && seen.sigma[i] > 0 ? seen.sigma[i] : 1;
      const double weight = std::clamp(1 / sigma, 1 / kMostWeight, kMostWeight);
      rows[*row] = fmt::format("{} {} {} {}\n", picture, format_double(seen.uv[i].u),
                               format_double(seen.uv[i].v), format_double(weight));
    }
    if (!seen.found()) rows.resize(1);
    for (const std::string& row : rows) text += row;
  }
  return text;
}

}  // namespace calvin
