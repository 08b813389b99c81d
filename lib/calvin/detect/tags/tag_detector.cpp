// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The levels of a picture one after the other, until all boards are found, and the results.

#include "calvin/detect/tags/tag_detector.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <utility>
#include <vector>

#include "calvin/detect/pyramid.hpp"
#include "calvin/detect/sheet_list.hpp"
#include "calvin/detect/smoothing.hpp"
#include "calvin/detect/tags/quads.hpp"
#include "calvin/detect/tags/tag_search.hpp"
#include "calvin/target/kinds.hpp"

namespace calvin::detect {

namespace {

constexpr std::size_t kFewestCorners = 4;

class TagDetector final : public Detector {
 public:
  explicit TagDetector(std::span<const Board> boards);

  std::vector<Detection> detect_all(const ImageView& image,
                                    std::stop_token stop) noexcept override {
    list_.forget();
    return follow_all(image, kNoTimestamp, std::move(stop));
  }
  // The whole image is searched: a board of tags is found quickly where it is in view.
  std::vector<Detection> follow_all(const ImageView& image, std::uint64_t /*timestamp*/,
                                    std::stop_token stop) noexcept override {
    try {
      search(image, stop);
      return results(image.size());
    } catch (const std::exception&) {
      return {};  // no memory
    }
  }

 private:
  struct FoundSheet {
    std::size_t kind = 0;
    Observation observation;
    Point centre;
  };

  void search(const ImageView& image, const std::stop_token& stop);
  void read_level(int level, const std::stop_token& stop);
  [[nodiscard]] bool are_complete(ImageSize size);
  void observe(const std::stop_token& stop);
  [[nodiscard]] std::vector<Detection> results(ImageSize size);

  std::vector<Board> boards_;  // that differ
  std::vector<std::size_t> of_list_;
  SheetList list_{{}};
  std::vector<TagSearch> searches_;  // one for each style
  Pyramid pyramid_;
  QuadSearch quads_;
  std::vector<FoundSheet> found_;
};

TagDetector::TagDetector(std::span<const Board> boards) {
  for (const Board& board : boards) {
    const auto known = std::ranges::find(boards_, board);
    of_list_.push_back(static_cast<std::size_t>(known - boards_.begin()));
    if (known == boards_.end()) boards_.push_back(board);
  }
  list_ = SheetList(of_list_);
  std::vector<std::vector<WantedTags>> styles;
  for (std::size_t i = 0; i < boards_.size(); ++i) {
    const TagGrid& board = *boards_[i].as<TagGrid>();
    const auto style = std::ranges::find_if(styles, [&](const auto& wanted) {
      return TagStyle(wanted.front().board) == TagStyle(board);
    });
    (style == styles.end() ? styles.emplace_back() : *style).push_back({board, i});
  }
  searches_.reserve(styles.size());
  for (auto& wanted : styles) searches_.emplace_back(std::move(wanted));
}

void TagDetector::search(const ImageView& image, const std::stop_token& stop) {
  found_.clear();
  for (TagSearch& search : searches_) search.begin();
  pyramid_.build(image);
  for (int level = pyramid_.levels() - 1; level >= 0 && !stop.stop_requested(); --level) {
    read_level(level, stop);
    if (are_complete(image.size())) break;
  }
  observe(stop);
  if (stop.stop_requested()) found_.clear();
}

void TagDetector::read_level(int level, const std::stop_token& stop) {
  constexpr int kLeastContrast = 10;  // grey levels
  constexpr float kNoises = 6;        // what noise may look like, 1 sigma of it
  const ImageView& image = pyramid_.calm_level(level);
  const int contrast = std::max(kLeastContrast, static_cast<int>(kNoises * noise_of(image)));
  quads_.begin(image, contrast);
  for (const bool light : {false, true}) {
    const auto is_of_tone = [light](const TagSearch& s) { return s.style().inverted == light; };
    if (std::ranges::none_of(searches_, is_of_tone)) continue;
    const std::vector<Quad>& quads = quads_.find(light);
    for (TagSearch& search : searches_) {
      if (is_of_tone(search)) search.read(pyramid_, level, quads, stop);
    }
  }
  for (TagSearch& search : searches_) search.make_sheets(pyramid_, stop);
}

// Whether smaller pixels would show nothing more of the boards of the list.
bool TagDetector::are_complete(ImageSize size) {
  std::vector<SheetOf> complete;
  for (TagSearch& search : searches_) {
    for (const FoundTags& found : search.sheets()) {
      if (found.sheet.is_complete(size)) complete.push_back({found.kind, {}});
    }
  }
  return list_.is_satisfied(complete);
}

void TagDetector::observe(const std::stop_token& stop) {
  for (TagSearch& search : searches_) {
    for (FoundTags& found : search.sheets()) {
      if (stop.stop_requested()) return;
      found.sheet.refine(pyramid_.level(0), search.reader());
      FoundSheet sheet{found.kind, found.sheet.observe(), found.sheet.centre()};
      if (sheet.observation.ids.size() >= kFewestCorners) found_.push_back(std::move(sheet));
    }
  }
  std::ranges::stable_sort(found_, {}, [](const FoundSheet& s) { return s.centre.norm(); });
}

std::vector<Detection> TagDetector::results(ImageSize size) {
  std::vector<SheetOf> sheets;
  for (const FoundSheet& s : found_) sheets.push_back({s.kind, {s.centre.x(), s.centre.y()}});
  std::vector<Detection> all;
  for (const ListedSheet& listed : list_.assign(sheets)) {
    Detection& result = all.emplace_back();
    result.board = listed.board;
    if (listed.sheet) {
      result.observation = std::move(found_[*listed.sheet].observation);
      result.reason = Reason::kAccepted;
    }
    result.observation.board = boards_[of_list_[listed.board]].text();
    result.observation.image_size = size;
  }
  return all;
}

}  // namespace

bool has_tags(const Board& board) { return board.as<TagGrid>() != nullptr; }

std::unique_ptr<Detector> make_tag_detector(std::span<const Board> boards) {
  return std::make_unique<TagDetector>(boards);
}

}  // namespace calvin::detect
