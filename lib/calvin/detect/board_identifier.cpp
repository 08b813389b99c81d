// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Counts frames and looks, and says in words what was seen.

#include "calvin/detect/board_identifier.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "calvin/core/text.hpp"
#include "calvin/target/kinds.hpp"

namespace calvin {

namespace {

constexpr int kWhile = 10;  // frames without a board, until it is asked which one is in view
constexpr int kAgain = 30;  // frames, from then on
constexpr double kUsualSide = 0.025;  // m
constexpr std::string_view kAuto = "auto";

// How many markers of its dictionary a board has, or leaves out before them.
std::size_t markers_of(const CharucoBoard& board) {
  return static_cast<std::size_t>(board.marker_count());
}
template <typename Tags>
std::size_t markers_of(const Tags& board) {
  return static_cast<std::size_t>(board.first + board.cols * board.rows);
}

// The same board with the other one's dictionary, where that begins with the same markers.
template <typename Kind>
Board with_dictionary_of(const Board& seen, const Board& wanted) {
  const auto* board = seen.as<Kind>();
  const auto* like = wanted.as<Kind>();
  if (board == nullptr || like == nullptr) return seen;
  const std::size_t count = markers_of(*board);
  const auto& own = board->dictionary->codes;
  const auto& known = like->dictionary->codes;
  const bool same =
      board->dictionary->side == like->dictionary->side && known.size() >= count &&
      std::equal(own.begin(), own.begin() + static_cast<std::ptrdiff_t>(count), known.begin());
  if (!same) return seen;
  Kind renamed = *board;
  renamed.dictionary = like->dictionary;
  return renamed;
}

// Dictionaries may begin with the same markers: the name that a user knows is the better one.
Board named_like(const Board& seen, const Board& wanted) {
  if (seen.as<TagGrid>() != nullptr) return with_dictionary_of<TagGrid>(seen, wanted);
  if (seen.as<AprilGrid>() != nullptr) return with_dictionary_of<AprilGrid>(seen, wanted);
  return with_dictionary_of<CharucoBoard>(seen, wanted);
}

bool is_coded(const Board& board) {
  return board.as<PuzzleBoard>() != nullptr || board.as<CharucoBoard>() != nullptr ||
         board.as<AprilGrid>() != nullptr || board.as<TagGrid>() != nullptr ||
         board.as<MarkedCheckerboard>() != nullptr;
}

}  // namespace

std::optional<Result<AutoBoard>> parse_auto_board(std::string_view text) {
  auto fields = split(text, ':');
  AutoBoard any{kUsualSide, fields.size() > 1 && fields[0] == "puzzle" && fields[1] == kAuto};
  if (any.is_puzzle) fields.erase(fields.begin());
  if (fields.front() != kAuto) return std::nullopt;
  if (fields.size() == 1) return any;
  if (fields.size() == 2) {
    if (const auto side = parse_length(fields[1]); side && *side > 0) {
      any.side = *side;
      return any;
    }
  }
  return make_error(ErrorCode::kInvalidArgument,
                    fmt::format("The board text '{}' is wrong: after 'auto' it has the side of a "
                                "square, or nothing. A right text is '{}:25mm'.",
                                text.substr(0, 200), any.text()));
}

BoardIdentifier::BoardIdentifier(std::vector<Board> wanted)
    : wanted_(std::move(wanted)), side_(kUsualSide) {
  if (is_any()) return;
  const auto grid = wanted_.front().grid();
  if (grid && grid->pitch > 0) side_ = grid->pitch;
}

bool BoardIdentifier::is_due(bool found) {
  if (found) {
    without_ = 0;
    seen_.reset();
    alike_ = 0;
    return false;
  }
  if (is_any() && !taken_) return true;
  const auto is_light = [](const Board& board) { return board.as<PointLight>() != nullptr; };
  // Nobody who waves a light holds up the wrong board.
  if (!is_any() && std::ranges::all_of(wanted_, is_light)) return false;
  const bool due = ++without_ >= kWhile && (without_ - kWhile) % kAgain == 0;
  return due;
}

void BoardIdentifier::look(const ImageView& image, std::stop_token stop) {
  auto all = identify_boards(image, side_, std::move(stop));
  std::optional<IdentifiedBoard> now;
  if (!all.empty()) now = std::move(all.front());
  const bool same = now && seen_ && now->board == seen_->board && now->mirrored == seen_->mirrored;
  alike_ = same ? alike_ + 1 : 0;
  seen_ = std::move(now);
}

// Tiles and windows may look like a board once.
bool BoardIdentifier::is_sure() const { return sees_code() || (seen_ && alike_ > 0); }

bool BoardIdentifier::sees_code() const { return seen_ && is_coded(seen_->board); }

bool BoardIdentifier::will_do(const Board& board) const {
  return !any_.is_puzzle || board.as<PuzzleBoard>() != nullptr;
}

std::optional<Board> BoardIdentifier::certain() const {
  if (!is_any() || !seen_ || !seen_->whole || seen_->mirrored || !is_sure()) return std::nullopt;
  if (!will_do(seen_->board)) return std::nullopt;
  if (taken_ && taken_->looks_like(seen_->board)) return std::nullopt;
  return seen_->board;
}

void BoardIdentifier::take(const Board& board) {
  taken_ = board;
  without_ = 0;
}

std::string BoardIdentifier::hint() const {
  if (!seen_) return "";
  const Board* wanted = taken_ ? &*taken_ : is_any() ? nullptr : &wanted_.front();
  const std::string text =
      (wanted == nullptr ? seen_->board : named_like(seen_->board, *wanted)).text();
  if (seen_->mirrored) {
    return fmt::format("This is {} in a mirror: take the flip out of the video", text);
  }
  if (wanted == nullptr && !will_do(seen_->board)) {
    return is_sure() ? fmt::format("This is {}, I look for a PuzzleBoard", text) : "";
  }
  if (wanted == nullptr) {
    // Light that runs over edges makes tags smaller or larger, and no picture tells by how much.
    const bool has_gaps =
        seen_->board.as<TagGrid>() != nullptr || seen_->board.as<AprilGrid>() != nullptr;
    return fmt::format("This may be {}: show the whole board, once more{}", text,
                       has_gaps
                           ? ". Where it is whole, measure the gaps between its tags, and give "
                             "its text"
                           : "");
  }
  const bool is_wanted = std::ranges::any_of(
      wanted_, [&](const Board& board) { return board.looks_like(seen_->board); });
  if (is_wanted || wanted->looks_like(seen_->board) || !is_sure()) return "";
  return fmt::format("This is {}{}, I look for {}", seen_->whole ? "" : "a part of ", text,
                     wanted->text());
}

}  // namespace calvin
