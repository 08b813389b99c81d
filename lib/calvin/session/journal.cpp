// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Reads what a journal holds of earlier runs, and appends to it.

#include "calvin/session/journal.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "calvin/core/text.hpp"
#include "calvin/io/board_names.hpp"
#include "calvin/io/observations.hpp"
#include "calvin/target/board.hpp"

namespace calvin {

namespace {

// Whether nothing but the beginning of a header was written before the program ended.
bool holds_nothing(std::string_view content) {
  const std::string header = print_observation_header("");
  const std::string_view start = std::string_view(header).substr(0, header.find("\"\""));
  return content.find('\n') == std::string_view::npos &&
         (start.starts_with(content) || content.starts_with(start));
}

std::vector<Board> boards_of(std::string_view texts) {
  std::vector<Board> boards;
  for (const std::string_view text : split(texts, ';')) {
    if (auto board = parse_board(text)) boards.push_back(*std::move(board));
  }
  return boards;
}

bool is_among(const Board& board, const std::vector<Board>& boards) {
  return std::ranges::find(boards, board) != boards.end();
}

tl::unexpected<Error> of_another(const std::string& path, std::string_view what,
                                 const std::string& there, const std::string& here) {
  return make_error(ErrorCode::kInvalidArgument,
                    fmt::format("The journal '{}' is of the {} {}, and this session of {}: give it "
                                "a journal of its own.",
                                path, what, there, here));
}

std::string texts_of(const std::vector<Board>& boards) {
  std::vector<std::string> texts;
  for (const Board& board : boards) texts.push_back(board.text());
  return join(texts, ";");
}

}  // namespace

Journal::Journal(AppendFile file, const SessionSettings& settings)
    : file_(std::move(file)), camera_(settings.camera) {
  // A text that is no board says nothing here: the detector refuses it.
  if (auto boards = parse_boards(settings.board)) boards_ = *std::move(boards);
}

Result<std::unique_ptr<Journal>> Journal::open(const SessionSettings& settings) {
  const auto told = [](const Error& why) {
    return make_error(why.code, "The journal cannot be kept. " + why.message);
  };
  auto file = AppendFile::open(settings.journal);
  if (!file) return told(file.error());
  std::unique_ptr<Journal> journal(new Journal(*std::move(file), settings));
  if (const Status read = journal->read(settings); !read) return told(read.error());
  return journal;
}

Status Journal::read(const SessionSettings& settings) {
  const auto content = file_.read(kMaxObservationBytes);
  if (!content) return tl::unexpected<Error>(content.error());
  if (holds_nothing(*content)) {
    header_board_ = texts_of(boards_);
    return content->empty() ? Status() : file_.cut(0);
  }
  const auto observations = parse_observations(*content, file_.path());
  if (!observations) return tl::unexpected<Error>(observations.error());
  has_header_ = true;
  header_board_ = observations->board;
  if (const Status taken = take_up(settings, observations->observations); !taken) return taken;
  if (observations->whole_bytes == content->size()) return {};
  return file_.cut(observations->whole_bytes);
}

Status Journal::take_up(const SessionSettings& settings,
                        const std::vector<Observation>& observations) {
  std::vector<Board> held = boards_of(header_board_);
  std::map<std::string, std::optional<Board>> boards;
  for (const Observation& seen : observations) {
    if (!camera_.empty() && !seen.camera.empty() && seen.camera != camera_) {
      return of_another(file_.path(), "camera", seen.camera, camera_);
    }
    const auto [board, is_new] = boards.try_emplace(seen.board);
    if (is_new) {
      if (auto parsed = parse_board(seen.board)) board->second = *std::move(parsed);
      if (board->second && !is_among(*board->second, held)) held.push_back(*board->second);
    }
    if (!board->second || !seen.found() || !check({seen, *board->second}, seen.image_size)) {
      ++content_.unusable;
      continue;
    }
    content_.views.push_back(std::make_shared<const View>(View{seen, *board->second}));
  }
  const bool any =
      std::ranges::any_of(held, [this](const Board& b) { return is_among(b, boards_); });
  if (!boards_.empty() && !held.empty() && !any) {
    return of_another(file_.path(), "board", texts_of(held), settings.board);
  }
  for (const Board& board : held) {
    if (!is_among(board, boards_)) boards_.push_back(board);
  }
  return {};
}

void Journal::add(JournalEntry entry) {
  constexpr std::size_t kMostWaiting = 10'000;  // where a disk stays full for hours
  const std::lock_guard guard(waiting_lock_);
  if (closed_) return;
  if (entry.reset) waiting_.clear();
  if (waiting_.size() >= kMostWaiting) waiting_.pop_front();
  waiting_.push_back(std::move(entry));
}

bool Journal::admits(const JournalEntry& entry) const {
  return boards_.empty() || std::ranges::all_of(entry.views, [this](const auto& view) {
           return is_among(view->board, boards_);
         });
}

std::string Journal::print(const JournalEntry& entry) {
  std::string text;
  if (!has_header_) {
    if (header_board_.empty() && !entry.views.empty()) {
      header_board_ = entry.views.front()->observation.board;
    }
    text += print_observation_header(header_board_);
  }
  if (entry.reset) text += print_observation_reset(entry.views.size());
  for (const auto& view : entry.views) {
    if (camera_.empty()) {
      text += print_observation(view->observation, header_board_);
      continue;
    }
    Observation named = view->observation;
    named.camera = camera_;
    text += print_observation(named, header_board_);
  }
  return text;
}

bool Journal::is_waiting() {
  const std::lock_guard guard(waiting_lock_);
  return !waiting_.empty();
}

std::optional<JournalEntry> Journal::next() {
  const std::lock_guard guard(waiting_lock_);
  return waiting_.empty() ? std::nullopt : std::optional(waiting_.front());
}

void Journal::written(const JournalEntry& entry) {
  const std::lock_guard guard(waiting_lock_);
  // A reset that was added since has taken its place.
  if (waiting_.empty()) return;
  const JournalEntry& front = waiting_.front();
  if (front.reset == entry.reset && front.views == entry.views) waiting_.pop_front();
}

void Journal::close() {
  const std::lock_guard guard(waiting_lock_);
  closed_ = true;
  waiting_.clear();
}

void Journal::end() {
  close();
  file_.unlock();
}

Status Journal::write() {
  const std::lock_guard writing(writing_lock_);
  while (const auto entry = next()) {
    if (!admits(*entry)) {
      close();
      return of_another(file_.path(), "board", texts_of(boards_),
                        entry->views.front()->board.text());
    }
    if (const Status appended = file_.append(print(*entry)); !appended) {
      if (std::exchange(failed_, true)) return {};
      return make_error(appended.error().code,
                        fmt::format("The journal lacks views until it can be written again. {}",
                                    appended.error().message));
    }
    has_header_ = true;
    failed_ = false;
    written(*entry);
  }
  return {};
}

}  // namespace calvin
