// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The session behind calibsolve: takes observations on the streaming thread, solves on a worker,
// writes the files and posts what happens in the name of the element.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <gst/gst.h>

#include "calvin/core/calibration.hpp"
#include "calvin/session/files/session_files.hpp"
#include "calvin/session/session.hpp"
#include "calvin/session/session_settings.hpp"
#include "calvin/solve/solve.hpp"
#include "common/calibration_event.hpp"
#include "common/messages.hpp"
#include "common/metas.hpp"
#include "common/shared_settings.hpp"
#include "common/worker.hpp"

namespace calvin::gst {

// Every function may be called from any thread and returns at once, but for finish().
// None holds a lock while it posts or notifies.
//
// Other settings take effect with the next frame, or with solve_now().
class CalibSolver : public SharedSettings<SessionSettings> {
 public:
  explicit CalibSolver(GstElement* element) : element_(element) {}

  // Whether the corners are to be refined with the camera for final results.
  [[nodiscard]] bool refines_with_camera();

  // An error for settings that cannot work; a file that cannot be written now is only a warning
  // on the bus.
  [[nodiscard]] Status start();
  void cancel() {
    worker_.cancel();
    writer_.cancel();
    updater_.cancel();
  }
  // A solve or a write that cancel() cut short is asked for again.
  void resume();
  void stop() {
    worker_.stop();
    writer_.stop();
    updater_.stop();
  }

  // Brings settings that changed into force. Those that cannot work are a warning, and the ones
  // before them stay. Where a file may have to be waited for this is done beside, and they take
  // effect when it answers.
  void update();

  // A new size begins a new session.
  void set_size(ImageSize size);
  void set_live(bool live);

  // What was found on one frame, with the times of that frame; true when a view was taken.
  bool offer(const Observation& observation, const FrameTimes& times);
  // An observation that cannot be one, and why: a WARNING, once per session.
  void complain(const Error& why);
  [[nodiscard]] Progress progress();

  // The newest calibration that has not been announced downstream.
  [[nodiscard]] std::optional<CalibrationEvent> take_event();

  // The end of the stream: solves all views, waits for it, posts the final result or what is
  // missing. Returns early when cancelled.
  void finish();

  void capture_view();
  // With what was set before, as soon as that is in force.
  void solve_now();
  // From when it returns nothing of the session before is begun to be written, posted or announced;
  // what another thread has begun by then, one message or file at the most, it ends.
  void reset();
  bool remove_view(unsigned index);

  // Native JSON of the newest solution, empty before the first one.
  [[nodiscard]] std::string calibration_json();
  [[nodiscard]] GstStructure* stats();

 private:
  struct Job;
  struct Write;
  struct Update;
  struct TakenView {
    FrameTimes times;
    Reason reason = Reason::kAccepted;  // or why the newest solve left it out
  };

  // Whether the settings in force are those that were set last.
  [[nodiscard]] bool is_up_to_date();
  // update(), however long that takes; false when it was cancelled.
  [[nodiscard]] bool update_and_wait();
  // Absent where nothing has changed.
  [[nodiscard]] std::optional<Update> begin_update();
  // What the user should hear; absent where another thread was quicker, and it is to begin anew.
  [[nodiscard]] std::optional<std::vector<Error>> try_update(const Update& update);
  // These with the lock held; `writable`: its files. A word for the user, if any.
  std::optional<Error> adopt(SessionPlan plan, bool writable);
  void solve_when_up_to_date();
  void forget();
  [[nodiscard]] bool enough_views() const;
  [[nodiscard]] std::string camera_name() const;
  [[nodiscard]] Error too_few_views() const;
  [[nodiscard]] Result<Board> board_of(const std::string& text);
  void consider();
  // The views that this solve left out and the one before did not.
  [[nodiscard]] std::vector<TakenView> newly_rejected(const Solution& solution);
  [[nodiscard]] std::shared_ptr<Job> make_job() const;
  void request(bool final);
  // Of unwritten_, on the writer. The newest one replaces one that waits, and is final if that was.
  void request_write(const std::vector<CalibrationFile>& files, bool final);
  void forget_unwritten() {
    unwritten_.reset();
    final_waits_ = false;
  }
  // Whether all that was asked for is solved and written, however long that takes; false when it
  // was cancelled.
  [[nodiscard]] bool drain() { return worker_.drain() && writer_.drain(); }
  [[nodiscard]] Status verdict() const;
  void post_solve_progress(GstProgressType type, const std::string& text);
  // On the updater.
  void update_beside(const std::stop_token& stop);
  // The rest on the worker.
  void run(const Job& job, const std::stop_token& stop);
  void publish(const Job& job, const Solution& solution, const std::stop_token& stop);
  void complain_of_late_files(const Job& job, const std::stop_token& stop);
  void announce(const Job& job, const Solution& solution, const Progress& now,
                const std::stop_token& stop);
  // nullptr where the session has gone on without what that job was made of; `is_result`: the
  // result itself is reported, and what the job owed is paid.
  [[nodiscard]] std::unique_ptr<Worker::Report> begin_report(const Job& job,
                                                             const std::stop_token& stop,
                                                             bool is_result = false);
  // On the writer.
  void write(const Write& write, const std::stop_token& stop);
  [[nodiscard]] bool begin_write(const Write& write);
  // What the user should hear; nothing where the session has gone on without what was written.
  [[nodiscard]] std::vector<Error> end_write(const Write& write,
                                             const SessionFiles::Outcome& outcome, bool& held);
  [[nodiscard]] std::unique_ptr<Worker::Report> begin_report(const Write& write,
                                                             const std::stop_token& stop);

  GstElement* element_;

  // Under lock_, down to files_.
  SessionSettings seen_;                // those that plan_ was made of, and what was refused
  SessionPlan plan_;                    // the settings in force
  std::uint64_t plan_serial_ = 0;       // of seen_ and plan_
  std::optional<Calibration> initial_;  // plan_.initial, for frames of size_
  bool live_ = false;
  Session session_{SessionOptions{}};
  std::vector<TakenView> taken_;  // the views of session_
  ImageSize size_;
  std::string camera_;                      // as the newest observation names it
  std::optional<Calibration> calibration_;  // newest solution
  bool published_ = false;                  // a calibration was good enough for the files
  std::optional<double> published_error_;   // its expected error
  bool announce_ = false;                   // calibration_ waits to be announced
  bool complained_ = false;                 // of broken observations
  std::string solve_error_;
  Status written_;
  std::optional<Calibration> unwritten_;        // for the files, which do not all have it
  bool final_waits_ = false;                    // unwritten_ is final, or replaced one that was
  std::vector<CalibrationFile> being_written_;  // by the write that began last
  std::uint64_t writes_ = 0;                    // asked for so far
  bool write_failed_ = false;                   // and that was reported
  bool write_late_ = false;                     // likewise, that a write does not end
  bool kept_reported_ = false;                  // that another session's file stays
  Reason last_reason_ = Reason::kAccepted;
  FrameTimes times_;                             // of the newest frame with a board
  std::size_t next_solve_ = 0;                   // number of views
  bool finished_ = false;                        // good enough: nothing more is captured
  bool final_owed_ = false;                      // somebody waits for a final result
  bool solve_waits_ = false;                     // for settings to come into force
  std::uint64_t revision_ = 0;                   // of the views kept and of what is made of them
  std::optional<std::uint64_t> final_revision_;  // the one whose final result was posted
  std::uint64_t session_number_ = 0;             // whose files they are
  std::uint64_t generation_ = 0;  // of what is solved: a solve of an older one is thrown away
  std::map<std::string, Board> boards_;  // by their texts, of the newest frames

  SessionFiles files_;  // on the writer

  Worker writer_;
  Worker worker_;   // goes before it: what it solves is written
  Worker updater_;  // goes first: what it brings into force is solved
};

}  // namespace calvin::gst
