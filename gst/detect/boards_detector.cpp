// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Detectors out of the text of boards, and words for whoever holds up another one.

#include "detect/boards_detector.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "calvin/io/board_names.hpp"
#include "calvin/target/kinds.hpp"

namespace calvin::gst {

namespace {

// What a user should hear who holds up another board: of a checkerboard the sizes, which are what
// differs.
std::string wrong_board_hint(const Detection& detection, const Board& board) {
  if (!detection.seen_board.empty()) {
    return fmt::format("This is {}, I look for {}", detection.seen_board, board.text());
  }
  const auto* checkerboard = board.as<Checkerboard>();
  return fmt::format(
      "This is a {}x{} board, I look for {}", detection.seen_cols, detection.seen_rows,
      checkerboard != nullptr ? fmt::format("{}x{}", checkerboard->cols, checkerboard->rows)
                              : board.text());
}

}  // namespace

Result<SharedDetector> BoardsDetector::make(const std::string& text) {
  auto made = std::make_shared<BoardsDetector>();
  if (const auto any = parse_auto_board(text)) {
    if (!*any) return tl::unexpected<Error>(any->error());
    made->any_ = (*any)->text();
    made->identifier_ = std::make_shared<BoardIdentifier>(**any);
    return made;
  }
  auto boards = parse_boards(text);
  if (!boards) return tl::unexpected<Error>(boards.error());
  // Points of a file are chosen by hand, behind this element: there is nothing to look for.
  if (std::ranges::all_of(*boards, [](const Board& b) { return b.as<PointBoard>() != nullptr; })) {
    made->boards_ = *std::move(boards);
    return made;
  }
  auto detector = make_detector(*boards);
  if (!detector) return tl::unexpected<Error>(detector.error());
  made->identifier_ = std::make_shared<BoardIdentifier>(*boards);
  made->boards_ = *std::move(boards);
  made->detector_ = *std::move(detector);
  return made;
}

std::vector<Detection> BoardsDetector::follow(const ImageView& image, std::uint64_t timestamp,
                                              const std::stop_token& stop) const {
  if (detector_) return detector_->follow_all(image, timestamp, stop);
  std::vector<Detection> none(std::max<std::size_t>(1, boards_.size()));
  for (std::size_t i = 0; i < none.size(); ++i) {
    none[i].board = i;
    none[i].observation.board = i < boards_.size() ? boards_[i].text() : any_;
    none[i].observation.image_size = image.size();
  }
  return none;
}

SharedDetector BoardsDetector::identify(const ImageView& image,
                                        const std::vector<Detection>& detections,
                                        const std::stop_token& stop) const {
  const bool found =
      std::ranges::any_of(detections, [](const Detection& d) { return d.observation.found(); });
  if (!identifier_ || !identifier_->is_due(found)) return nullptr;
  identifier_->look(image, stop);
  const auto board = identifier_->certain();
  if (!board || stop.stop_requested()) return nullptr;
  auto detector = make_detector(*board);
  if (!detector) return nullptr;
  identifier_->take(*board);
  auto taken = std::make_shared<BoardsDetector>();
  taken->boards_ = {*board};
  taken->detector_ = *std::move(detector);
  taken->identifier_ = identifier_;
  return taken;
}

DetectorHint BoardsDetector::hint_of(const Detection& detection, bool dark) const {
  const Board* board = board_of(detection);
  if (detection.observation.found()) return {};
  if (!detection.obstacle.empty()) return {detection.obstacle, false};
  // A dark room is right for a light.
  if (board != nullptr && board->as<PointLight>() != nullptr) dark = false;
  // The size of a sheet says less than its code.
  if (!identifier_) return {};
  const bool is_named =
      !detection.seen_board.empty() || (detection.seen_all && !identifier_->sees_code());
  if (board != nullptr && is_named) return {wrong_board_hint(detection, *board), true};
  if (std::string hint = identifier_->hint(); !hint.empty()) return {std::move(hint), true};
  return {dark ? "The picture is too dark: more light, or a longer exposure" : "", false};
}

}  // namespace calvin::gst
