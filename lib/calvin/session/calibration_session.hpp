// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// CalibrationSession: from the boards that a camera sees to the calibration that files hold.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "calvin/camera/camera.hpp"
#include "calvin/core/calibration.hpp"
#include "calvin/core/observation.hpp"
#include "calvin/core/reason.hpp"
#include "calvin/device/lens.hpp"
#include "calvin/session/files/session_files.hpp"
#include "calvin/session/frame_times.hpp"
#include "calvin/session/guidance/guided_capture.hpp"
#include "calvin/session/guidance/hint.hpp"
#include "calvin/session/guidance/parameter_groups.hpp"
#include "calvin/session/guidance/view_guide.hpp"
#include "calvin/session/points/expected_points.hpp"
#include "calvin/session/points/manual_points.hpp"
#include "calvin/session/progress.hpp"
#include "calvin/session/result_writes.hpp"
#include "calvin/session/session.hpp"
#include "calvin/session/session_jobs.hpp"
#include "calvin/session/session_settings.hpp"
#include "calvin/session/session_words.hpp"
#include "calvin/session/watch/lens_watch.hpp"
#include "calvin/session/watch/stream_watch.hpp"

namespace calvin {

// A view that the session keeps.
struct TakenView {
  FrameTimes times;
  Reason reason = Reason::kAccepted;  // or why the newest solve left it out
};

// What came of an observation that was offered.
struct Offered {
  bool report = false;  // it was kept, or is not kept for another reason than the one before
  Reason reason = Reason::kNotFound;
  std::optional<Error> complaint;  // it cannot be an observation, and nobody was told so yet
  std::string camera;
  Progress progress;
  std::string_view reached;  // the setting after whose view nothing more is captured, if any
};

// What came of a solve.
struct Published {
  bool better = false;       // than all before it: it goes downstream and to the files
  bool writing = false;      // files have yet to get a result
  std::string_view reached;  // the setting for which nothing more is captured from now on, if any
};

// What the end of the stream has to wait for.
enum class LastWork { kNone, kSolve, kWrite };

struct Verdict {
  Status status;              // whether there is a calibration, and whether its files have it
  bool files_wanted = false;  // then a failure is an error, else a warning
};

// Decides what calibsolve does. It has no thread, no clock and no file: it is told what happens,
// and after each call that may ask for work take_solve() and take_write() give what is to be done.
// A job that is taken takes the place of one that has not begun yet.
//
// Not thread-safe.
class CalibrationSession {
 public:
  // ---- Settings: session_update.cpp

  // A new run; `writable`: whether its files can be written now.
  void start(SessionPlan plan, bool writable);
  // Right after start(): what happens to the views goes to take_journal(), and those of an earlier
  // run, which it holds, are taken up once the frames have their size. `newest_light`: ns, of the
  // last light that it holds; one of an earlier time begins the journal anew, since times of two
  // runs say nothing of each other.
  void begin_journal(Session::Views earlier, std::uint64_t newest_light = kNoTimestamp);
  [[nodiscard]] bool is_up_to_date(const SessionSettings& now) const { return now == seen_; }
  // Settings that were set, to be read beside the session; absent where nothing has changed.
  [[nodiscard]] std::optional<SettingsUpdate> begin_update(const SessionSettings& now);
  // Brings them into force: what the user should hear. Absent where another update was quicker, and
  // this one is to begin anew. `now`: what is set by then.
  [[nodiscard]] std::optional<std::vector<Error>> end_update(const SettingsUpdate& update,
                                                             SettingsRead read,
                                                             const SessionSettings& now);

  // ---- Frames and views: calibration_session.cpp; what is said of them: session_guidance.cpp

  // Likewise: what is to be judged by the first views of a guided session.
  void judge_first(std::shared_ptr<const EarlierCalibration> earlier) {
    earlier_ = std::move(earlier);
  }

  // A new size begins a new session, with the views that are there of frames of that size: those
  // of the journal, and those of before the frames had yet another size. A word for the user, if
  // any. False where the size is the same.
  [[nodiscard]] bool set_size(ImageSize size, std::optional<Error>& warning);
  void set_live(bool live);
  // One board as it was found on one frame; `place`: which of the observations of that frame it is.
  [[nodiscard]] Offered offer(const Observation& observation, const FrameTimes& times,
                              std::size_t place = 0);
  // What keeps the detector from finding the board on the newest frame, in words: another board,
  // the dark. Empty: nothing that it knows of.
  void hear_detector(const std::string& words, bool wrong_board = false);
  // Whether nobody was told yet that what comes cannot be an observation.
  [[nodiscard]] bool first_complaint();

  // The next view is kept whatever else it is.
  void capture_view() {
    views_.capture_next();
    capture_unanswered_ = true;
  }
  // A final result of what is there, once the settings `now` are in force.
  [[nodiscard]] Status solve_now(const SessionSettings& now);
  void reset();
  [[nodiscard]] bool remove_view(std::size_t index);

  // ---- Manual points, which together are one view: session_points.cpp

  // Whether a click chooses a point: of a file always, of a board while it is not found.
  [[nodiscard]] bool clicks_choose() const;
  // `found`: what is next to the pixel in a frame with these times, if it was looked for.
  [[nodiscard]] PointAnswer add_point(const PointChoice& choice,
                                      const std::optional<FoundPoint>& found,
                                      const FrameTimes& times);
  // The newest one, or that of a number.
  [[nodiscard]] PointAnswer remove_point(std::optional<std::size_t> index);
  [[nodiscard]] bool has_points() const noexcept { return points_.count() > 0; }
  // How far from a click a corner or a disc is taken for it, px.
  [[nodiscard]] double point_reach() const { return snap_reach(size_); }
  // Whether take_expected_points() may have some.
  [[nodiscard]] bool expects_points() const noexcept { return expects_points_ && manual_view_; }
  // Points that nobody has chosen, where a known camera has them by those that were: to be looked
  // for in the frame at hand, at most so many. Each is given once, until something has changed.
  [[nodiscard]] std::vector<ExpectedPoint> take_expected_points(std::size_t most);
  // What was found of them.
  [[nodiscard]] PointAnswer add_found_points(
      const std::vector<std::pair<PointChoice, FoundPoint>>& points, const FrameTimes& times);
  // What came of the pixels in the file of `points`, once.
  [[nodiscard]] std::optional<PointAnswer> take_points_report();

  [[nodiscard]] const Session& views() const noexcept { return views_; }
  [[nodiscard]] Progress progress() const;
  // What to show next, and where to hold the board for it as camera() would see it there.
  [[nodiscard]] const Hint& hint() const noexcept { return hint_; }
  // The best camera by now: the newest solution, or `initial`, or nominal_camera().
  [[nodiscard]] std::optional<Camera> camera() const;
  // As the settings or else the newest observation name it.
  [[nodiscard]] std::string camera_name() const;
  [[nodiscard]] const SessionPlan& plan() const noexcept { return plan_; }

  // ---- The camera: session_watch.cpp. What the user should hear of it is a notice, see below.

  // Whose lens is to be read about once a second; empty: none.
  [[nodiscard]] const std::string& lens_node() const noexcept { return lens_.node(); }
  void see_lens(const Result<LensState>& read);
  // A second more has passed, and the lens does not answer.
  void wait_for_lens();
  // ns from one frame to the next; 0: not known.
  void set_frame_duration(std::uint64_t duration) { stream_.set_frame_duration(duration); }
  void frame_came() { stream_.frame_came(); }
  // A second more has passed. `frames_expected`: one could have come.
  void second_passed(bool frames_expected);

  // ---- Solves: session_solves.cpp

  [[nodiscard]] std::optional<SolveJob> take_solve();
  // What has happened to the views since it was asked last, in order; nothing without a journal.
  [[nodiscard]] std::vector<JournalEntry> take_journal() { return std::exchange(entries_, {}); }
  // Whether what the job was made of still is what the session has.
  [[nodiscard]] bool is_current(const JobOrigin& origin) const;
  // Absent where it is not current: the solution is thrown away. `errors`: parameter_errors() of
  // the solution, which are found beside the session, since they take a while.
  [[nodiscard]] std::optional<Published> solved(const SolveJob& job, const Solution& solution,
                                                std::vector<GroupError> errors = {});
  // What to tell the user, where somebody waits for that solve: it was asked for, as by a limit or
  // by other settings. Where a limit of views was why, more are taken, as those are not enough.
  [[nodiscard]] std::optional<Error> failed(const SolveJob& job, const Error& why);
  // The views that this solve left out and the one before did not; none where it is not current.
  [[nodiscard]] std::vector<TakenView> newly_rejected(const SolveJob& job,
                                                      const Solution& solution);
  // What was to be judged first is, and the hint tells it for a while. False where the job is not
  // current.
  [[nodiscard]] bool judged(const SolveJob& job, std::string words);
  // The result was posted; what was owed is paid.
  void reported(const SolveJob& job);

  // The guide that was made after the solve of that job; null where there is none.
  void guided(const SolveJob& job, std::shared_ptr<ViewGuide> guide);

  // The newest solution.
  // Whether the files have the best result so far.
  [[nodiscard]] bool is_written() const noexcept { return writes_.is_written(); }
  [[nodiscard]] const std::optional<Calibration>& calibration() const noexcept {
    return calibration_;
  }
  // The newest calibration that was better than those before it and that downstream has not got,
  // once.
  [[nodiscard]] std::optional<Calibration> take_announcement();

  // Work was cut short (a flush), and may go on: it is asked for again.
  void resume();
  // The end of the stream: asks for the last solve or, without one, for a write that failed before.
  [[nodiscard]] LastWork end_of_stream();
  [[nodiscard]] Verdict verdict() const;

  // ---- Writes: session_solves.cpp; what they have come to is in ResultWrites

  [[nodiscard]] std::optional<WriteJob> take_write();
  // False where the result is not to be written any more.
  [[nodiscard]] bool begin_write(const WriteJob& job);
  void end_write(const WriteJob& job, const SessionFiles::Outcome& outcome);
  // The files of that result have not answered for so long: a word for the user, once.
  [[nodiscard]] std::optional<Notice> files_are_late(std::chrono::seconds waited) {
    return writes_.late(waited);
  }
  // What is to be said of the writes that have ended, and what nobody could say when it came up; a
  // notice that is taken counts as said.
  void say_later(Notice notice) { writes_.say_later(std::move(notice)); }
  [[nodiscard]] bool has_notice() const noexcept { return writes_.has_notice(); }
  [[nodiscard]] std::optional<Notice> take_notice() { return writes_.take_notice(); }

 private:
  // Of a known camera one view tells where it is.
  [[nodiscard]] int least_views() const;
  [[nodiscard]] bool enough_views() const;
  [[nodiscard]] Error too_few() const;
  [[nodiscard]] Result<Board> board_of(const std::string& text);
  [[nodiscard]] JobOrigin origin() const { return {session_, generation_, revision_}; }
  [[nodiscard]] std::string_view consider();
  // Captures nothing more where limit_reached() names a setting, and returns it; what is there is
  // to be solved for the final result.
  std::string_view end_at_limit(bool solve = true);
  [[nodiscard]] SessionOptions capture_options() const;
  void capture_beyond_limit();
  [[nodiscard]] std::string hint_text() const;
  [[nodiscard]] std::string first_hint() const;
  [[nodiscard]] bool is_blurred() const;
  void solve_with_readout();
  [[nodiscard]] Offered note_light(const Observation& observation, const Board& board);
  // Whether what came of an observation is news, and with what it is told.
  void report(Offered& offered, std::size_t place);
  void note_twin_boards(const Board& seen, const Observation& observation, std::size_t place);
  void notify(std::string words);  // in place of the hint, for as long as one reads
  // The newest of views_ is one that has been taken.
  void note_taken(const FrameTimes& times);
  void begin_session();
  // Keeps the views of frames of another size, and takes up those of `size`.
  void change_views(ImageSize size);
  // At the end: the size with the most views that were kept goes on, where these suffice and had no
  // final result.
  void take_up_others();
  [[nodiscard]] std::optional<Calibration> calibration_of(ImageSize size);
  // After other options, or other points: what they ask for.
  void weigh_points();
  void forget_points();
  // Anew: with the pixels of the file.
  void begin_points();
  // Whether there was one.
  bool drop_manual_view();
  void renew_manual_view(const FrameTimes& times);
  void look_for_points();
  // The answer with how well the points agree, which is what the hint tells from here on.
  [[nodiscard]] PointAnswer told(PointAnswer answer);
  // Whether the method takes the manual points and no other view.
  [[nodiscard]] bool is_of_points_alone() const;
  // A view was taken out or exchanged: what is solved and written has it.
  void views_changed();
  void write_down(bool reset, Session::Views views) {
    if (journaling_) entries_.push_back({reset, std::move(views), plan_.settings.camera});
  }
  void write_down_all();
  // Those of frames of another size, too.
  [[nodiscard]] Session::Views all_views() const;
  void write_down_newest();
  // Whether a view beyond max-views may take the place of one that tells less.
  [[nodiscard]] bool exchanges_views() const;
  // Whether a view tells enough, of what the hint asks for, to be kept.
  [[nodiscard]] ViewWorth worth(const View& view);
  void change_hint(Hint next);  // and notes since when it is another one
  // The board is seen there: from there the hint leads to the outline, if there is one.
  void guide_from(const View& view);
  // A view was taken: whether something else is to be asked for now.
  void note_answer();
  void miss_target();
  // Asks for something else where a board that is brought to the target is lost on the way, or is
  // held where it tells little.
  void leave_stale_target(std::uint64_t now);
  // After whatever may have changed the newest solution or what is asked of it.
  void compare_with_target();
  // The setting that ends the capture with what is there, or nothing.
  [[nodiscard]] std::string_view limit_reached() const;
  // What is solved and written is not what the session wants any more.
  void outdate_results();
  // Whether board_ becomes the one that was seen.
  [[nodiscard]] bool choose_board(const Board& seen, const FrameTimes& times);
  // After whatever may have changed views, board or camera.
  void renew_hint();
  void ask(bool final);
  [[nodiscard]] std::optional<Error> adopt(SessionPlan plan, bool writable);
  void solve_when_up_to_date(const SessionSettings& now);

  // The settings in force.
  SessionSettings seen_;  // those that plan_ was made of, and what was refused
  SessionPlan plan_;
  std::uint64_t plan_serial_ = 0;       // of seen_ and plan_
  std::optional<Calibration> initial_;  // plan_.initial, for frames of size_
  bool live_ = false;

  // What was seen.
  Session views_{SessionOptions{}};
  std::vector<TakenView> taken_;    // the views of views_
  Session::Views set_aside_;        // of frames of other sizes than size_
  bool taken_up_ = false;           // and a solve of them waits for the mode
  bool waits_for_readout_ = false;  // for a solve of them that has it
  bool journaling_ = false;
  std::vector<JournalEntry> entries_;  // for take_journal()
  ImageSize size_;
  std::string camera_;                          // as the newest observation names it
  FrameTimes times_;                            // of the newest frame with a board
  std::vector<Reason> last_reasons_;            // by place
  std::uint64_t blurred_since_ = kNoTimestamp;  // timestamp, of the first board of each frame
  bool capture_unanswered_ = false;             // and no frame has come since
  Refusals refused_;
  std::shared_ptr<const EarlierCalibration> earlier_;  // not judged yet
  std::string notice_;                                 // what is told for a while, once
  std::uint64_t notice_until_ = kNoTimestamp;          // timestamp
  bool notice_is_new_ = false;                         // and a report of it is owed
  std::uint64_t newest_ = kNoTimestamp;                // of the newest frame, with a board or not
  std::string obstacle_;                               // on the newest frame, as the detector says
  bool wrong_board_ = false;
  std::string told_obstacle_;
  std::string last_obstacle_;                  // since a board was found
  std::uint64_t newest_light_ = kNoTimestamp;  // ns, of the last light in the journal
  std::optional<Error> useless_board_;  // why nothing can be made of the board that was seen last
  bool complained_ = false;             // of broken observations
  bool is_detector_heard_ = false;      // in this session or before
  std::optional<Board> board_;    // whose place the hint tells: of several one, while it is seen
  int frames_without_board_ = 0;  // that showed others, since it was seen
  std::uint64_t guided_board_at_ = kNoTimestamp;  // timestamp, of board_
  bool twins_told_ = false;                       // that two of board_ were in one picture
  Hint hint_;
  std::shared_ptr<ViewGuide> guide_;       // after the newest solve
  std::uint64_t asked_at_ = kNoTimestamp;  // timestamp since which its target is asked for
  bool answered_ = false;                  // a view was taken of it, or for want of it
  double share_ = 0;                       // ViewGuide::share() of the newest observation
  ViewGuide::Views missed_;                // the newest views that were asked for in vain
  GuidedCapture capture_;
  std::uint64_t accepted_at_ = kNoTimestamp;  // timestamp of the newest view
  std::uint64_t hint_since_ = kNoTimestamp;   // of the frame at which the hint last changed
  bool leads_ = false;                   // the hint: from where the board is seen to the outline
  std::map<std::string, Board> boards_;  // by their texts, of the newest frames

  // The camera.
  LensWatch lens_;
  StreamWatch stream_;

  // What a user has chosen.
  ManualPoints points_;
  std::shared_ptr<const View> manual_view_;  // of them, among those of views_; or null
  bool points_suffice_ = false;              // to be solved without another view
  std::string point_words_;                  // of the newest answer
  std::set<int> taken_out_;                  // ids that the user wants no pixel of
  std::set<int> looked_for_;                 // likewise, that no more is expected of
  bool expects_points_ = false;              // there may be some to look for
  std::optional<PointAnswer> points_report_;
  bool board_in_view_ = false;  // a board was found on the newest frame

  // What is solved.
  std::uint64_t session_ = 0;
  std::uint64_t generation_ = 0;                 // a solve of an older one is thrown away
  std::uint64_t revision_ = 0;                   // of the views kept and of what is made of them
  std::optional<std::uint64_t> final_revision_;  // the one whose final result was posted
  std::size_t accepted_ = 0;                     // number of views, those that had to go too
  std::size_t next_solve_ = 0;                   // likewise
  bool finished_ = false;                        // good enough: nothing more is captured
  bool asked_ = false;                           // take_solve() has something to give
  bool final_owed_ = false;                      // somebody waits for a final result
  bool aside_owed_ = false;                      // likewise, of views that were set aside
  bool answer_owed_ = false;                     // likewise, or why there is none
  int views_beyond_ = 0;                         // of max_views, as that many do not suffice
  bool solve_waits_ = false;                     // for settings to come into force

  // What came of it.
  std::optional<Calibration> calibration_;       // newest solution
  bool is_accurate_ = false;                     // of it: is_accurate(), which takes a while
  bool is_good_enough_ = false;                  // likewise: is_good_enough()
  std::vector<GroupError> parameter_errors_;     // of it
  Misfit::Cause misfit_ = Misfit::Cause::kNone;  // likewise
  std::string solve_error_;
  bool published_ = false;  // a calibration of what is set and kept was good enough for the files
  std::optional<double> published_error_;    // its compared_error(), px
  std::optional<Calibration> announcement_;  // was published, and downstream has not got it
  std::vector<Calibration> of_other_sizes_;  // published of frames of other sizes than size_
  ResultWrites writes_;
};

}  // namespace calvin
