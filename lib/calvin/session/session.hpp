// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Session: which views to keep, what to show next, when it is enough.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "calvin/core/observation.hpp"
#include "calvin/core/reason.hpp"
#include "calvin/session/guidance/guided_capture.hpp"
#include "calvin/session/guidance/hint.hpp"
#include "calvin/session/guidance/view_coverage.hpp"
#include "calvin/session/progress.hpp"
#include "calvin/session/views/sighting.hpp"
#include "calvin/session/views/view_spacing.hpp"
#include "calvin/solve/solve.hpp"

namespace calvin {

enum class CaptureMode {
  kAll,     // every usable view
  kAuto,    // usable views that are nearly still, large enough and new
  kManual,  // the next usable view after each capture_next()
};

struct SessionOptions {
  CaptureMode mode = CaptureMode::kAuto;
  int min_views = 10;  // fewer are never complete
  int max_views = 0;   // no more are kept; 0: no limit
  // s, from the first row of a frame to the last, negative where the last one comes first; 0: not
  // known, and at most a frame's time.
  double readout = 0;
};

// Not thread-safe.
//
// A view is usable with at least 6 corners that check() accepts, of the image size of the views
// kept so far. In kAuto it must also
//   - be still, or move so that it is known how: the corners shared with the observation of its
//     sheet in the frame before it move by no more than 0.1 px (RMS, what their sigmas explain
//     taken off) while a frame is read out, or would move so once their velocities, which the two
//     frames before tell, are taken off. The first one after a gap is never kept. Several
//     observations of a board with the same timestamp are sheets that are equal: the one of the
//     frame before whose centre lies nearest, by less than half the board's size, is the same
//     sheet. A frame's time is the lower quartile of those between the newest frames;
//   - be sharp: its edges are blurred by no more than 0.15 % of the image diagonal, or 2 px if that
//     is more (1 sigma);
//   - be large: the corners' hull covers at least 1 % of the image;
//   - be new, compared with every kept view of the same board: its centre lies at least 8 % of the
//     image diagonal away, or the corners have moved about their centre by at least 2.5 % of the
//     board's size in the image on average (nearer, farther, turned, tilted).
// A view whose velocities are known is kept with them; what they may be wrong by is in its sigmas.
// An observation that comes again with its timestamp is of a copy of the frame: it tells nothing
// new. Nor does one that a view of an earlier run was made of, where a recording is played again.
class Session {
 public:
  explicit Session(SessionOptions options = {}) : options_(options) {}

  // Keeps the view when it returns kAccepted. kTooSimilar also for a view beyond max_views, in
  // kManual for one that was not asked for, in kAuto for one that is not worth it, and where there
  // are so many views that the one that is most like another has to go, for that one. Beyond
  // max_views one is kept in place of the view that `worth` names, if that is still there.
  Reason offer(const View& view, ViewWorth worth = {});

  // Takes up a view that was kept before, as it is: one of an earlier run, or of before the frames
  // had another size. kTooSimilar only where there are so many that it has to go again.
  Reason restore(const std::shared_ptr<const View>& view);

  // Keeps a view as it is, in every mode: one of points that a user has chosen. Likewise.
  Reason add(const std::shared_ptr<const View>& view);

  [[nodiscard]] bool has_restored() const noexcept { return restored_ > 0; }

  // A frame that may have shown the board, but nothing of it is offered: there is a gap.
  void pass(const Observation& seen);

  // Takes effect with the next view; those kept stay.
  void set_options(const SessionOptions& options) { options_ = options; }
  [[nodiscard]] const SessionOptions& options() const noexcept { return options_; }

  // The next usable view is kept whatever else it is, in every mode.
  void capture_next() { asked_ = true; }
  void forget_capture() { asked_ = false; }

  // Forgets all views; the next one may have another image size.
  void reset();

  // False where there is no such view.
  bool remove_view(std::size_t index);

  // Shared: whoever solves them elsewhere keeps them without a copy.
  using Views = std::vector<std::shared_ptr<const View>>;
  [[nodiscard]] const Views& views() const noexcept { return views_; }
  // Which view the newest one took the place of, by its number until then.
  [[nodiscard]] const std::optional<std::size_t>& replaced() const noexcept { return replaced_; }
  // Whether it did because it tells more, and not because there were too many.
  [[nodiscard]] bool exchanged() const noexcept { return exchanged_; }
  // Whether max_views are kept.
  [[nodiscard]] bool full() const noexcept;
  // Of the views alone: a session knows no calibration and no frame.
  [[nodiscard]] Progress progress() const;
  [[nodiscard]] Hint hint() const { return coverage_.hint(); }
  [[nodiscard]] const ViewCoverage& coverage() const noexcept { return coverage_; }
  // The board of that text where it was seen last, in the newest frame or the one before; else
  // null.
  [[nodiscard]] const Observation* newest(std::string_view board) const;
  // What solve() is to take for the readout of the views; absent where nobody knows frames' times.
  [[nodiscard]] std::optional<ReadoutTime> readout() const;
  // What speaks against the readout that was given, for a user; absent where nothing does.
  [[nodiscard]] std::optional<std::string> readout_doubt() const;

  // At least min_views, and max_views reached or, in kAuto, the ranges of Progress spanned; without
  // guidance (kAll, kManual) min_views is enough.
  [[nodiscard]] bool complete() const;

 private:
  [[nodiscard]] Reason usable(const View& view) const;
  // How a board moves: so little that it stands still for a readout, so evenly that its velocities
  // tell where it was, or in a way that nobody knows.
  enum class Pace { kStill, kSteady, kUnknown };
  [[nodiscard]] Pace pace_of(const Observation& seen, const Observation* before,
                             const std::optional<CornerVelocities>& velocities) const;
  [[nodiscard]] Reason worth_keeping(const View& view, Pace pace, bool worth_it,
                                     const View* in_place_of) const;
  // Compared with all that are kept but `in_place_of`.
  [[nodiscard]] bool is_new(const View& view, const View* in_place_of) const;
  [[nodiscard]] std::optional<std::size_t> place_of(const View* view) const;
  // Beyond so many views each new one takes the place of another. A stream may go on for ever.
  [[nodiscard]] std::size_t most_views(const View& like) const noexcept;
  // Notes that another frame begins where it does, and forgets what is older than the one before.
  void begin_frame(const Observation& seen);
  [[nodiscard]] std::optional<Sighting> take_previous(const Observation& now);
  // Whether one of the first `count` views was made of it.
  [[nodiscard]] bool is_kept(const Observation& seen, std::size_t count) const;
  void erase_view(std::size_t index);
  [[nodiscard]] Reason keep(const std::shared_ptr<const View>& view,
                            std::optional<std::size_t> in_place_of = std::nullopt);
  void time_frame(std::uint64_t timestamp);
  [[nodiscard]] double frame_time() const;       // s; 0: not known
  [[nodiscard]] double longest_readout() const;  // s; 0: not known
  // The part of the time between two observations that a readout takes.
  [[nodiscard]] double readout_share(const Observation& before, const Observation& now) const;

  SessionOptions options_;
  Views views_;
  std::size_t restored_ = 0;  // of them the first so many
  ViewSpacing spacing_;       // of views_
  std::optional<std::size_t> replaced_;
  bool exchanged_ = false;
  ViewCoverage coverage_;  // what was seen stays seen
  // What was usable of a board in the frame at hand, and in the one before unless it was followed
  // up; without timestamps nobody knows where a frame ends, and all is of the one before.
  struct Recent {
    std::string board;
    std::uint64_t frame = kNoTimestamp;
    std::vector<Sighting> before;
    std::vector<Sighting> now;
    std::uint64_t rested = kNoTimestamp;  // when it last stood still, or was seen after a gap
    Reason reason = Reason::kNotFound;    // of the newest one
  };
  // Of what no frame has shown before; it becomes one of what the frame at hand shows.
  [[nodiscard]] Reason judge(const View& view, Recent& r, ViewWorth worth);
  [[nodiscard]] Recent& recent(const std::string& board);
  std::vector<Recent> recent_;
  bool asked_ = false;
  std::uint64_t last_frame_ = kNoTimestamp;
  std::vector<double> frame_times_;  // s, between the newest frames
};

}  // namespace calvin
