// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Reads what a journal holds of earlier runs, and appends to it.

#include "calvin/session/journal.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "calvin/core/file.hpp"
#include "calvin/core/text.hpp"
#include "calvin/io/board_names.hpp"
#include "calvin/io/observations.hpp"
#include "calvin/target/board.hpp"

namespace calvin {

namespace {

constexpr std::size_t kMostBytes = std::size_t{1} << 30;

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

Result<std::unique_ptr<Journal>> Journal::open(const SessionSettings& settings) {
  const auto told = [](const Error& why) {
    return make_error(why.code, "The journal cannot be kept. " + why.message);
  };
  auto file = AppendFile::open(settings.journal);
  if (!file) return told(file.error());
  std::unique_ptr<Journal> journal(new Journal(*std::move(file)));
  if (const Status read = journal->read(settings); !read) return told(read.error());
  return journal;
}

Status Journal::read(const SessionSettings& settings) {
  const auto content = file_.read(kMostBytes);
  if (!content) return tl::unexpected<Error>(content.error());
  // A text that is no board says nothing here: the detector refuses it.
  const std::vector<Board> wanted = parse_boards(settings.board).value_or(std::vector<Board>());
  if (holds_nothing(*content)) {
    header_board_ = texts_of(wanted);
    return content->empty() ? Status() : file_.cut(0);
  }
  const auto held = parse_observations(*content, file_.path());
  if (!held) return tl::unexpected<Error>(held.error());
  has_header_ = true;
  header_board_ = held->board;
  take_up(held->observations);
  if (const Status fits = check_is_of(settings, wanted); !fits) return fits;
  // Whoever names boards may name others while frames flow.
  if (!wanted.empty()) boards_.clear();
  if (held->whole_bytes != content->size()) {
    if (const Status cut = file_.cut(held->whole_bytes); !cut) return cut;
  }
  return compact(*held, content->size());
}

void Journal::take_up(const std::vector<Observation>& observations) {
  boards_ = boards_of(header_board_);
  std::map<std::string, std::optional<Board>> known;
  for (const Observation& seen : observations) {
    if (!seen.camera.empty()) camera_ = seen.camera;
    const auto [board, is_new] = known.try_emplace(seen.board);
    if (is_new) {
      if (auto parsed = parse_board(seen.board)) board->second = *std::move(parsed);
      if (board->second && !is_among(*board->second, boards_)) boards_.push_back(*board->second);
    }
    if (!board->second || !seen.found() || !check({seen, *board->second}, seen.image_size)) {
      ++content_.unusable;
      continue;
    }
    if (!check_has_pose(*board->second)) {
      content_.newest_light = seen.timestamp;
      continue;
    }
    content_.views.push_back(std::make_shared<const View>(View{seen, *board->second}));
  }
}

Status Journal::check_is_of(const SessionSettings& settings,
                            const std::vector<Board>& wanted) const {
  if (!settings.camera.empty() && !camera_.empty() && settings.camera != camera_) {
    return of_another(file_.path(), "camera", camera_, settings.camera);
  }
  const bool any =
      std::ranges::any_of(boards_, [&wanted](const Board& b) { return is_among(b, wanted); });
  if (!wanted.empty() && !boards_.empty() && !any) {
    return of_another(file_.path(), "board", texts_of(boards_), settings.board);
  }
  return {};
}

// Each view that was taken out has left a copy of all the others, and each session that was begun
// anew all of its views.
Status Journal::compact(const ObservationFile& held, std::size_t bytes) {
  constexpr std::size_t kWorthIt = std::size_t{1} << 20;
  if (bytes < kWorthIt) return {};
  const auto live = print_observations(held);
  if (!live || live->size() > bytes / 2 || !write_file(file_.path(), *live)) return {};
  // Where no other file can take its place it is the same one still.
  file_.unlock();
  auto file = AppendFile::open(file_.path());
  if (!file) return tl::unexpected<Error>(file.error());
  file_ = *std::move(file);
  return {};
}

void Journal::add(JournalEntry entry) {
  constexpr std::size_t kMostWaiting = 10'000;  // where a disk stays full for hours
  const std::lock_guard guard(waiting_lock_);
  if (closed_) return;
  if (entry.reset) waiting_.clear();
  // What was to be forgotten stays forgotten.
  if (waiting_.size() >= kMostWaiting) waiting_.erase(waiting_.begin() + waiting_.front().reset);
  waiting_.push_back(std::move(entry));
}

Status Journal::check_admits(const JournalEntry& entry) const {
  for (const auto& view : entry.views) {
    if (!boards_.empty() && !is_among(view->board, boards_)) {
      return of_another(file_.path(), "board", texts_of(boards_), view->board.text());
    }
    const std::string& camera = view->observation.camera;
    if (entry.camera.empty() && !camera_.empty() && !camera.empty() && camera != camera_) {
      return of_another(file_.path(), "camera", camera_, camera);
    }
  }
  return {};
}

Result<std::string> Journal::print(const JournalEntry& entry) {
  std::string text;
  if (!has_header_) {
    if (header_board_.empty() && !entry.views.empty()) {
      header_board_ = entry.views.front()->observation.board;
    }
    text += print_observation_header(header_board_);
  }
  if (entry.reset) text += print_observation_reset(entry.views.size());
  for (const auto& view : entry.views) {
    Observation named = view->observation;
    if (!entry.camera.empty()) named.camera = entry.camera;
    if (!named.camera.empty()) camera_ = named.camera;
    const auto line = print_observation(named, header_board_);
    if (!line) return line;
    text += *line;
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
  // Whoever writes just now keeps the file to the end of that.
  if (const std::unique_lock writing(writing_lock_, std::try_to_lock); writing) file_.unlock();
}

Status Journal::write() {
  const std::lock_guard writing(writing_lock_);
  while (const auto entry = next()) {
    if (const Status admitted = check_admits(*entry); !admitted) {
      close();
      return admitted;
    }
    const auto text = print(*entry);
    if (!text) {
      close();
      return tl::unexpected<Error>(text.error());
    }
    if (const Status appended = file_.append(*text); !appended) {
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
