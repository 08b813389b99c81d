// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What a calibration session decides, done in the name of calibsolve: takes observations on the
// streaming thread, solves on a worker, writes on another one and posts what happens.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <gst/gst.h>

#include "calvin/session/calibration_session.hpp"
#include "calvin/session/earlier_calibration.hpp"
#include "calvin/session/journal.hpp"
#include "common/calibration_event.hpp"
#include "common/messages.hpp"
#include "common/shared_settings.hpp"
#include "common/worker.hpp"
#include "solve/solve_events.hpp"

namespace calvin::gst {

// Every function may be called from any thread and returns at once, but for finish() and, where a
// journal is kept, for the system's write() of what it is to hold: a view is announced behind that.
// None holds a lock while it posts or notifies.
//
// Other settings take effect with the next frame, or with solve_now().
class CalibSolver : public SharedSettings<SessionSettings> {
 public:
  explicit CalibSolver(GstElement* element) : element_(element) {}

  // Whether the corners are to be refined with the camera for final results.
  [[nodiscard]] bool refines_with_camera();

  // An error for settings that cannot work and for a journal that cannot be kept; a file that
  // cannot be written now is only a warning on the bus.
  [[nodiscard]] Status start();
  void cancel();
  // A solve or a write that cancel() cut short is asked for again.
  void resume();
  void stop();

  // Brings settings that changed into force. Those that cannot work are a warning, and the ones
  // before them stay. Where a file may have to be waited for this is done beside, and they take
  // effect when it answers.
  void update();

  // A new size begins a new session, with the views that are there of such frames.
  void set_size(ImageSize size);
  void set_live(bool live);

  // A live camera that stops sending is told of, once. Also before the first frame, where it is
  // known by then that the source is live.
  void watch_stream(bool live);
  // ns from one frame to the next; 0: not known.
  void set_frame_duration(GstClockTime duration);
  // A frame, or an event that tells that there is none.
  void frame_came();

  // What was found on one frame, with the times of that frame; true when a view was taken.
  // `place` is that of the observation among those of its frame.
  bool offer(const Observation& observation, const FrameTimes& times, std::size_t place = 0);
  // An observation that cannot be one, and why: a WARNING, once per session.
  void complain(const Error& why);
  void hear_detector(const std::string& words, bool wrong_board);
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
  // Absent: the newest one.
  bool remove_view(std::optional<unsigned> wanted);
  void run_command(const SolveCommand& command);

  // Manual points: solver_points.cpp

  // Taken with the next frame, in which the corner next to it is looked for.
  void add_point(const PointChoice& choice);
  // Absent: the newest one. Whether there was one.
  bool remove_point(std::optional<unsigned> index);
  // On the streaming thread: whether a frame is to be looked at for points.
  [[nodiscard]] bool wants_points();
  // Those that wait for a frame, and some of those that are expected. `point_at`: what is in the
  // frame with these times within so many px of a pixel.
  using PointAt = std::function<std::optional<FoundPoint>(Pixel at, double reach)>;
  void take_points(const FrameTimes& times, const PointAt& point_at);

  // Native JSON of the newest solution, empty before the first one.
  [[nodiscard]] std::string calibration_json();
  // The solves of a final result, without the first one.
  [[nodiscard]] int refinements() { return settings().runs - 1; }
  void set_refinements(int count) {
    change_settings([count](SessionSettings& s) { s.runs = count + 1; });
  }
  [[nodiscard]] GstStructure* stats();

 private:
  [[nodiscard]] Status begin();
  // With the lock held, after whatever may have made the session ask for work: hands it to the
  // worker, to the writer and to the journal.
  void obey();

  // The journal: solver_journal.cpp
  [[nodiscard]] std::shared_ptr<Journal> journal();
  [[nodiscard]] Status open_journal(const SessionSettings& settings);
  // Without the lock: writes what obey() gave to the journal.
  void write_journal();
  void sync_later(const std::shared_ptr<Journal>& journal);
  void sync_journal(const std::shared_ptr<Journal>& journal, const std::stop_token& stop);

  // What messages and the property `calibration` tell of the session.
  struct Told {
    std::size_t views = 0;
    bool calibrated = false;
  };
  [[nodiscard]] Told told() const;
  // Without the lock: tells what has changed since.
  void tell_of_change(const Told& before);
  // The same from another thread: whoever gives a command may hold a lock that a handler takes.
  void tell_beside(const Told& before);

  // update(), however long that takes; false when it was cancelled.
  [[nodiscard]] bool update_and_wait();
  [[nodiscard]] bool is_up_to_date();
  // Absent where nothing has changed.
  [[nodiscard]] std::optional<SettingsUpdate> begin_update();
  [[nodiscard]] bool clicks_choose() {
    const std::lock_guard guard(lock_);
    return session_.clicks_choose();
  }
  [[nodiscard]] bool has_points() {
    const std::lock_guard guard(lock_);
    return session_.has_points() || !waiting_points_.empty();
  }
  void take_expected_points(const FrameTimes& times, const PointAt& point_at);
  // Without the lock.
  void post_point(const FrameTimes& times, const PointAnswer& answer);
  void post_points_report();
  // What the user should hear; absent where another thread was quicker, and it is to begin anew.
  [[nodiscard]] std::optional<std::vector<Error>> try_update(const SettingsUpdate& update);
  // On the updater.
  void update_beside(const std::stop_token& stop);

  // Whether all that was asked for is solved and written, however long that takes; false when it
  // was cancelled.
  [[nodiscard]] bool drain();
  void post_solve_progress(GstProgressType type, const std::string& text);

  // On the worker.
  void judge_earlier(const SolveJob& job, const std::stop_token& stop);
  void run_solve(const SolveJob& job, const std::stop_token& stop);
  void publish(const SolveJob& job, const Solution& solution, const std::stop_token& stop);
  void complain_of_late_files(const SolveJob& job, const std::stop_token& stop);
  void announce(const SolveJob& job, const Solution& solution, bool better,
                const std::stop_token& stop);
  void post_rejected(const SolveJob& job, const Solution& solution, const Progress& now,
                     const std::stop_token& stop);
  // nullptr where the session has gone on without what that job was made of; `is_result`: the
  // result itself is reported.
  [[nodiscard]] std::unique_ptr<Worker::Report> begin_report(const SolveJob& job,
                                                             const std::stop_token& stop,
                                                             bool is_result = false);

  // On the writer.
  void run_write(const WriteJob& job, const std::stop_token& stop);
  [[nodiscard]] bool begin_write(const WriteJob& job);

  // The camera: solver_watch.cpp
  [[nodiscard]] Status begin_watch();
  void watch_on();
  void expect_no_frame();
  // On the watcher: once a second, for as long as the element runs.
  void begin_second();
  void end_second(const std::stop_token& stop);
  void look_at_lens();
  // On the reader of the lens.
  void read_lens(const std::string& node, const std::stop_token& stop);

  // In a job of that worker.
  void post_notices(Worker& worker, const std::stop_token& stop);
  // On the streaming thread: what the writer was kept from saying.
  void post_notices();

  [[nodiscard]] std::array<Worker*, 6> workers() {
    return {&worker_, &writer_, &updater_, &syncer_, &watcher_, &lens_reader_};
  }

  GstElement* element_;
  CalibrationSession session_;        // lock_
  SessionFiles files_;                // on the writer
  std::shared_ptr<Journal> journal_;  // lock_; null where none is kept
  // lock_: what was commanded between two runs, for the journal of the next one.
  std::vector<JournalEntry> between_runs_;
  std::string journal_path_;                 // lock_; of the last run that kept one
  std::vector<PointChoice> waiting_points_;  // lock_: for a frame
  std::optional<Told> untold_;               // lock_: what was told before a command changed it
  bool watching_ = false;                    // lock_: the watcher is at work
  bool is_live_ = false;                     // lock_
  bool stream_runs_ = false;                 // lock_: it has not ended, and is not flushed

  Worker syncer_;  // of the journal
  Worker writer_;
  Worker worker_;   // goes before it: what it solves is written
  Worker updater_;  // goes before: what it brings into force is solved
  Worker lens_reader_;
  Worker watcher_;  // goes before it: what it asks for is read
};

}  // namespace calvin::gst
