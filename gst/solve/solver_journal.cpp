// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The journal of calibsolve: a view is in it before anybody hears that it was taken, and on the
// disk soon after.

#include <memory>
#include <utility>

#include <fmt/format.h>

#include "solve/calib_solver.hpp"

GST_DEBUG_CATEGORY_EXTERN(calibsolve_debug);
#define GST_CAT_DEFAULT calibsolve_debug

namespace calvin::gst {

Status CalibSolver::open_journal(const SessionSettings& settings) {
  if (Status started = syncer_.start(); !started) return started;
  auto opened = Journal::open(settings);
  if (!opened) return tl::unexpected<Error>(opened.error());
  const std::shared_ptr<Journal> journal = *std::move(opened);
  Journal::Content content = journal->take_content();
  GST_INFO_OBJECT(element_, "the journal holds %" G_GSIZE_FORMAT " views", content.views.size());
  if (content.unusable > 0) {
    post_warning(element_,
                 {ErrorCode::kMalformed,
                  fmt::format("{} of the lines of the journal '{}' are left out, for they cannot "
                              "be views of their boards. Those that can are used.",
                              content.unusable, journal->path())});
  }
  {
    const std::lock_guard guard(lock_);
    journal_ = journal;
    if (std::exchange(journal_path_, journal->path()) != journal->path()) between_runs_.clear();
    for (JournalEntry& entry : std::exchange(between_runs_, {})) {
      content.views = entry.views;  // each of them says what is left
      journal->add(std::move(entry));
    }
    session_.begin_journal(std::move(content.views), content.newest_light);
  }
  write_journal();
  return {};
}

std::shared_ptr<Journal> CalibSolver::journal() {
  const std::lock_guard guard(lock_);
  return journal_;
}

void CalibSolver::write_journal() {
  const std::shared_ptr<Journal> journal = this->journal();
  if (!journal || !journal->is_waiting()) return;
  const Status written = journal->write();
  if (written) {
    sync_later(journal);
  } else if (written.error().code == ErrorCode::kInvalidArgument) {
    post_error(element_, written.error());
  } else {
    post_warning(element_, written.error());
  }
}

void CalibSolver::sync_later(const std::shared_ptr<Journal>& journal) {
  if (!journal) return;
  syncer_.offer([this, journal](const std::stop_token& stop) { sync_journal(journal, stop); });
}

void CalibSolver::sync_journal(const std::shared_ptr<Journal>& journal,
                               const std::stop_token& stop) {
  const Status synced = journal->sync();
  if (synced) return;
  GST_WARNING_OBJECT(element_, "%s", synced.error().message.c_str());
  if (const auto report = syncer_.begin_report(stop, element_)) {
    post_warning(element_, synced.error());
  }
}

}  // namespace calvin::gst
