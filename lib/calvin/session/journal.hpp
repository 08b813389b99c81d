// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The journal of a session: a file of observations that is written while they are made, so that
// whatever ends the program, the next run goes on with every view.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calvin/core/append_file.hpp"
#include "calvin/core/result.hpp"
#include "calvin/io/observations.hpp"
#include "calvin/session/session.hpp"
#include "calvin/session/session_jobs.hpp"
#include "calvin/session/session_settings.hpp"

namespace calvin {

// add(), write() and sync() may be called from any thread.
class Journal {
 public:
  // Opens or creates settings.journal, and cuts off what a crash left half written at its end. An
  // error where the file cannot be used: it is no file of observations, another program writes to
  // it, or its views are of another camera or of other boards alone than the settings name.
  [[nodiscard]] static Result<std::unique_ptr<Journal>> open(const SessionSettings& settings);

  // The views that it held when it was opened, once; `unusable` counts what cannot be a view of its
  // board.
  struct Content {
    Session::Views views;
    std::size_t unusable = 0;
    std::uint64_t newest_light = kNoTimestamp;  // ns, of the last light, which is no view
  };
  [[nodiscard]] Content take_content() { return std::exchange(content_, {}); }
  [[nodiscard]] const std::string& path() const noexcept { return file_.path(); }

  // To be written next. Waits for nothing.
  void add(JournalEntry entry);
  [[nodiscard]] bool is_waiting();
  // Writes what was added. What cannot be written stays for the next time, and the first of such
  // errors in a row is told. kInvalidArgument for a view of a board or a camera that the journal
  // is not of: nothing more is written then.
  [[nodiscard]] Status write();
  // Nothing more is taken, and another one may open the file.
  void end();
  // Takes as long as the disk does.
  [[nodiscard]] Status sync() const { return file_.sync(); }

 private:
  explicit Journal(AppendFile file) : file_(std::move(file)) {}
  [[nodiscard]] Status read(const SessionSettings& settings);
  void take_up(const std::vector<Observation>& observations);
  [[nodiscard]] Status check_is_of(const SessionSettings& settings,
                                   const std::vector<Board>& wanted) const;
  // Writes it anew where most of it was forgotten.
  [[nodiscard]] Status compact(const ObservationFile& held, std::size_t bytes);
  // What waits longest; absent where nothing does.
  [[nodiscard]] std::optional<JournalEntry> next();
  void written(const JournalEntry& entry);
  void close();
  // The lines of an entry, behind the header where the file has none yet.
  [[nodiscard]] Result<std::string> print(const JournalEntry& entry);
  // kInvalidArgument where it is of another board or camera.
  [[nodiscard]] Status check_admits(const JournalEntry& entry) const;

  AppendFile file_;
  Content content_;

  std::mutex waiting_lock_;
  std::deque<JournalEntry> waiting_;
  bool closed_ = false;  // it has ended, or a view of another board came

  std::mutex writing_lock_;    // before waiting_lock_
  std::string camera_;         // of the newest view; empty: not known
  std::vector<Board> boards_;  // of an earlier run; empty: any
  std::string header_board_;
  bool has_header_ = false;
  bool failed_ = false;  // and told
};

}  // namespace calvin
