// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The levels of a picture one after the other, until all boards are found, and the results. The
// tags of a list are grids of one tag each, whose corners are put together.

#include "calvin/detect/tags/search/tag_detector.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <optional>
#include <utility>
#include <vector>

#include "calvin/detect/pyramid.hpp"
#include "calvin/detect/search_again.hpp"
#include "calvin/detect/sheet_list.hpp"
#include "calvin/detect/smoothing.hpp"
#include "calvin/detect/tags/quads.hpp"
#include "calvin/detect/tags/search/tag_search.hpp"
#include "calvin/detect/tags/search/tag_tracker.hpp"
#include "calvin/target/kinds.hpp"

namespace calvin::detect {

namespace {

constexpr std::size_t kFewestCorners = 4;

// A grid of tags that is looked for: a board, or a tag of one that is a list.
struct PartOfBoard {
  TagGrid grid;
  std::size_t kind = 0;    // which of the boards that differ
  std::optional<int> tag;  // of a list
};

// Adds the grids that a board consists of.
void add_parts(const Board& board, std::size_t kind, std::vector<PartOfBoard>& parts) {
  if (const auto* grid = board.as<TagGrid>()) parts.push_back({*grid, kind, std::nullopt});
  const auto* list = board.as<TagList>();
  if (list == nullptr) return;
  for (const TagList::Tag& tag : list->tags) parts.push_back({list->grid_of(tag), kind, tag.id});
}

// The corners of a grid of one tag, in rows, with the names that they have in a list.
void name_in_list(int tag, Observation& seen) {
  constexpr std::array<int, 4> kClockwise = {0, 1, 3, 2};
  for (int& id : seen.ids) id = 4 * tag + kClockwise[static_cast<std::size_t>(id)];
}

// Adds what is seen of another tag, in the order of their names; one that was seen already is left
// out.
void add_tag(const Observation& tag, Observation& all) {
  for (std::size_t i = 0; i < tag.ids.size(); ++i) {
    const auto at = std::ranges::lower_bound(all.ids, tag.ids[i]) - all.ids.begin();
    if (at < std::ssize(all.ids) && all.ids[static_cast<std::size_t>(at)] == tag.ids[i]) continue;
    all.ids.insert(all.ids.begin() + at, tag.ids[i]);
    all.uv.insert(all.uv.begin() + at, tag.uv[i]);
    all.sigma.insert(all.sigma.begin() + at, tag.sigma[i]);
  }
}

Point middle_of(const Observation& seen) {
  Point sum = Point::Zero();
  for (const Pixel& p : seen.uv) sum += Point(p.u, p.v);
  return sum / static_cast<double>(std::max<std::size_t>(seen.uv.size(), 1));
}

class TagDetector final : public Detector {
 public:
  explicit TagDetector(std::span<const Board> boards);

  std::vector<Detection> detect_all(const ImageView& image,
                                    std::stop_token stop) noexcept override {
    list_.forget();
    followed_.clear();
    return follow_all(image, kNoTimestamp, std::move(stop));
  }
  std::vector<Detection> follow_all(const ImageView& image, std::uint64_t timestamp,
                                    std::stop_token stop) noexcept override {
    try {
      begin(image);
      const bool was_followed = !is_search_due(timestamp) && follow(image.size(), timestamp);
      if (!was_followed) search(image, stop);
      observe(stop);
      if (stop.stop_requested()) found_.clear();
      remember(image.size(), timestamp, was_followed);
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

  // A sheet of the last frame.
  struct FollowedSheet {
    std::size_t search = 0;
    std::size_t part = 0;
    TagTracker tracker;
  };

  void begin(const ImageView& image);
  [[nodiscard]] bool is_search_due(std::uint64_t timestamp);
  [[nodiscard]] bool follow(ImageSize size, std::uint64_t timestamp);
  void remember(ImageSize size, std::uint64_t timestamp, bool was_followed);
  void search(const ImageView& image, const std::stop_token& stop);
  void read_level(int level, const std::stop_token& stop);
  [[nodiscard]] bool are_complete(ImageSize size);
  void observe(const std::stop_token& stop);
  void add_to_list(std::size_t kind, const Observation& tag);
  [[nodiscard]] std::vector<Detection> results(ImageSize size);

  std::vector<Board> boards_;       // that differ
  std::vector<PartOfBoard> parts_;  // of them
  std::vector<std::size_t> of_list_;
  SheetList list_{{}};
  std::vector<TagSearch> searches_;  // one for each style
  Pyramid pyramid_;
  QuadSearch quads_;
  std::vector<FoundSheet> found_;
  std::vector<FollowedSheet> followed_;
  int since_search_ = 0;  // frames
  std::uint64_t searched_ = kNoTimestamp;
};

TagDetector::TagDetector(std::span<const Board> boards) {
  for (const Board& board : boards) {
    const auto known = std::ranges::find(boards_, board);
    of_list_.push_back(static_cast<std::size_t>(known - boards_.begin()));
    if (known == boards_.end()) boards_.push_back(board);
  }
  list_ = SheetList(of_list_);
  for (std::size_t i = 0; i < boards_.size(); ++i) add_parts(boards_[i], i, parts_);
  std::vector<std::vector<WantedTags>> styles;
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    const PartOfBoard& part = parts_[i];
    const auto style = std::ranges::find_if(styles, [&](const auto& wanted) {
      return TagStyle(wanted.front().board) == TagStyle(part.grid);
    });
    const auto grids =
        static_cast<std::size_t>(std::ranges::count(parts_, part.kind, &PartOfBoard::kind));
    (style == styles.end() ? styles.emplace_back() : *style).push_back({part.grid, i, grids - 1});
  }
  searches_.reserve(styles.size());
  for (auto& wanted : styles) searches_.emplace_back(std::move(wanted));
}

void TagDetector::begin(const ImageView& image) {
  found_.clear();
  for (TagSearch& search : searches_) search.begin();
  pyramid_.build(image, 1);  // what is followed needs no more
}

// Further sheets come into view: the whole image is searched once a second.
bool TagDetector::is_search_due(std::uint64_t timestamp) {
  ++since_search_;
  if (timestamp == kNoTimestamp || searched_ == kNoTimestamp) {
    return since_search_ >= kSearchAgainFrames;
  }
  return timestamp < searched_ || timestamp - searched_ >= kSearchAgain;
}

// Looks for the tags of the last frame where they are going. False where one is not there, or a
// board of the list is missing; of a list of tags one is enough.
bool TagDetector::follow(ImageSize size, std::uint64_t timestamp) {
  std::vector<SheetOf> seen;
  std::vector<bool> has_list(boards_.size(), false);
  for (const FollowedSheet& followed : followed_) {
    const auto expected = followed.tracker.predict(size, timestamp);
    TagSearch& search = searches_[followed.search];
    if (!search.follow(pyramid_.level(0), followed.part, expected)) {
      for (TagSearch& all : searches_) all.begin();
      return false;
    }
    const PartOfBoard& part = parts_[followed.part];
    if (part.tag && has_list[part.kind]) continue;
    has_list[part.kind] = true;
    seen.push_back({part.kind, {}});
  }
  return !followed_.empty() && list_.is_satisfied(seen);
}

void TagDetector::remember(ImageSize size, std::uint64_t timestamp, bool was_followed) {
  if (!was_followed) {
    followed_.clear();
    since_search_ = 0;
    searched_ = timestamp;
    for (std::size_t i = 0; i < searches_.size(); ++i) {
      for (const FoundTags& found : searches_[i].sheets()) {
        followed_.push_back({i, found.kind, TagTracker()});
      }
    }
  }
  // Each search has its sheets in the order in which they were followed.
  std::vector<std::size_t> next(searches_.size(), 0);
  for (FollowedSheet& followed : followed_) {
    const auto& sheets = searches_[followed.search].sheets();
    followed.tracker.remember(sheets[next[followed.search]++].sheet.tags(), size, timestamp);
  }
}

void TagDetector::search(const ImageView& image, const std::stop_token& stop) {
  pyramid_.build(image);
  for (int level = pyramid_.levels() - 1; level >= 0 && !stop.stop_requested(); --level) {
    read_level(level, stop);
    if (are_complete(image.size())) break;
  }
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
  std::vector<bool> seen(parts_.size(), false);
  for (TagSearch& search : searches_) {
    for (const FoundTags& found : search.sheets()) {
      const PartOfBoard& part = parts_[found.kind];
      if (part.tag) seen[found.kind] = true;
      if (!part.tag && found.sheet.is_complete(size)) complete.push_back({part.kind, {}});
    }
  }
  for (std::size_t kind = 0; kind < boards_.size(); ++kind) {
    const auto* list = boards_[kind].as<TagList>();
    if (list == nullptr) continue;
    std::size_t tags = 0;
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      tags += parts_[i].kind == kind && seen[i] ? 1 : 0;
    }
    if (tags == list->tags.size()) complete.push_back({kind, {}});
  }
  return list_.is_satisfied(complete);
}

void TagDetector::observe(const std::stop_token& stop) {
  for (TagSearch& search : searches_) {
    for (FoundTags& found : search.sheets()) {
      if (stop.stop_requested()) return;
      const PartOfBoard& part = parts_[found.kind];
      found.sheet.refine(pyramid_.level(0), search.reader());
      FoundSheet sheet{part.kind, found.sheet.observe(), found.sheet.centre()};
      if (sheet.observation.ids.size() < kFewestCorners) continue;
      if (part.tag) {
        name_in_list(*part.tag, sheet.observation);
        add_to_list(part.kind, sheet.observation);
      } else {
        found_.push_back(std::move(sheet));
      }
    }
  }
  std::ranges::stable_sort(found_, {}, [](const FoundSheet& s) { return s.centre.norm(); });
}

// There is one sheet of a list, which all of its tags are on.
void TagDetector::add_to_list(std::size_t kind, const Observation& tag) {
  auto sheet = std::ranges::find(found_, kind, &FoundSheet::kind);
  if (sheet == found_.end()) {
    found_.push_back({kind, {}, {}});
    sheet = found_.end() - 1;
    sheet->observation.blur = tag.blur;
  }
  add_tag(tag, sheet->observation);
  sheet->centre = middle_of(sheet->observation);
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

bool has_tags(const Board& board) {
  return board.as<TagGrid>() != nullptr || board.as<TagList>() != nullptr;
}

std::unique_ptr<Detector> make_tag_detector(std::span<const Board> boards) {
  return std::make_unique<TagDetector>(boards);
}

}  // namespace calvin::detect
