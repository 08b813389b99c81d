// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Sheets that are followed from frame to frame, the search for all others, and the results of both.

#include "calvin/detect/checkerboard/sheets/checkerboard_detector.hpp"

#include <algorithm>
#include <exception>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calvin/detect/checkerboard/sheets/sheet_places.hpp"
#include "calvin/detect/checkerboard/sheets/sheet_search.hpp"
#include "calvin/detect/checkerboard/sheets/tracker.hpp"

namespace calvin::detect {

namespace {

// The boards of a list that differ, how often each is there, and which of them each is.
struct WantedBoards {
  explicit WantedBoards(std::span<const Board> list) {
    for (const Board& board : list) {
      const auto known = std::ranges::find_if(
          boards, [&](const WantedBoard& w) { return w.pattern.board == board; });
      of_list.push_back(static_cast<std::size_t>(known - boards.begin()));
      if (known == boards.end()) {
        boards.push_back({Pattern(board), 1});
      } else {
        ++known->sheets;
      }
    }
  }
  std::vector<WantedBoard> boards;
  std::vector<std::size_t> of_list;
};

class CheckerboardDetector final : public Detector {
 public:
  explicit CheckerboardDetector(const WantedBoards& wanted)
      : of_list_(wanted.of_list), search_(wanted.boards), places_(of_list_) {}

  std::vector<Detection> detect_all(const ImageView& image,
                                    std::stop_token stop) noexcept override {
    try {
      SheetPlaces places(of_list_);
      search_.begin(image);
      const bool ended = search_.run(false, stop);
      if (ended) places.assign(search_.sheets());
      return results(places, image.size(), ended);
    } catch (const std::exception&) {
      return {};  // no memory
    }
  }

  std::vector<Detection> follow_all(const ImageView& image, std::uint64_t timestamp,
                                    std::stop_token stop) noexcept override {
    try {
      places_.begin();
      search_.begin(image);
      const bool ended = follow_or_search(image.size(), timestamp, stop);
      if (ended) places_.assign(search_.sheets());
      remember(image.size(), timestamp);
      return results(places_, image.size(), ended);
    } catch (const std::exception&) {
      return {};
    }
  }

 private:
  // False where it was stopped.
  [[nodiscard]] bool follow_or_search(ImageSize size, std::uint64_t timestamp,
                                      const std::stop_token& stop);
  // Whether further sheets are to be looked for in one level more: once a second.
  [[nodiscard]] bool is_thorough(std::uint64_t timestamp);
  // What the next frame has to know of this one.
  void remember(ImageSize size, std::uint64_t timestamp);
  [[nodiscard]] std::vector<Detection> results(SheetPlaces& places, ImageSize size, bool ended);

  std::vector<std::size_t> of_list_;
  SheetSearch search_;
  SheetPlaces places_;
  std::optional<std::uint64_t> thorough_at_;  // ns, when the last thorough search was
  int since_thorough_ = 0;                    // searches, where frames have no time
};

bool CheckerboardDetector::follow_or_search(ImageSize size, std::uint64_t timestamp,
                                            const std::stop_token& stop) {
  bool all_followed = true;
  for (SheetPlace& place : places_.all()) {
    const bool followed = !stop.stop_requested() && place.tracker &&
                          place.tracker->predict(size, timestamp, search_.prediction()) &&
                          search_.confirm_prediction(place.wanted, place.tracker->fits());
    if (followed) place.sheet = search_.sheets().size() - 1;
    all_followed = all_followed && followed;
  }
  return all_followed || search_.run(is_thorough(timestamp), stop);
}

bool CheckerboardDetector::is_thorough(std::uint64_t timestamp) {
  ++since_thorough_;
  if (thorough_at_) {
    const bool timed = timestamp != kNoTimestamp && *thorough_at_ != kNoTimestamp;
    if (timed ? timestamp >= *thorough_at_ && timestamp - *thorough_at_ < kSearchAgain
              : since_thorough_ < kSearchAgainFrames) {
      return false;
    }
  }
  thorough_at_ = timestamp;
  since_thorough_ = 0;
  return true;
}

void CheckerboardDetector::remember(ImageSize size, std::uint64_t timestamp) {
  for (SheetPlace& place : places_.all()) {
    const Sheet* sheet = place.sheet ? &search_.sheets()[*place.sheet] : nullptr;
    if (sheet == nullptr || !sheet->whole) {
      if (place.tracker) place.tracker->forget();
      continue;
    }
    if (!place.tracker) {
      place.tracker = std::make_shared<Tracker>(search_.wanted()[place.wanted].pattern.grid);
    }
    place.tracker->remember(sheet->lattice, sheet->fits, sheet->alignment, size, timestamp,
                            sheet->searched);
  }
}

std::vector<Detection> CheckerboardDetector::results(SheetPlaces& places, ImageSize size,
                                                     bool ended) {
  std::vector<Detection> all;
  const std::optional<OtherBoard> other = ended ? search_.other() : std::nullopt;
  for (const SheetPlace& place : places.all()) {
    Detection& result = all.emplace_back();
    result.board = place.board;
    if (place.sheet && ended) {
      result.observation = std::move(search_.sheets()[*place.sheet].observation);
      result.reason = Reason::kAccepted;
    } else if (other) {
      result.reason = Reason::kWrongBoard;
      result.seen_cols = other->cols;
      result.seen_rows = other->rows;
      result.seen_all = other->certain;
      result.seen_board = other->text;
    }
    result.observation.board = search_.wanted()[place.wanted].pattern.board.text();
    result.observation.image_size = size;
  }
  return all;
}

}  // namespace

std::unique_ptr<Detector> make_checkerboard_detector(std::span<const Board> boards) {
  return std::make_unique<CheckerboardDetector>(WantedBoards(boards));
}

}  // namespace calvin::detect
