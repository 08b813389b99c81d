// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What calibdetect does: looks for boards on a worker, with the streaming thread waiting for it or
// not, and posts what was seen in the name of the element.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <gst/gst.h>

#include "calvin/core/observation.hpp"
#include "calvin/detect/detection.hpp"
#include "calvin/io/board_names.hpp"
#include "common/calibration_reader.hpp"
#include "common/frames/frame_luma.hpp"
#include "common/frames/frame_part.hpp"
#include "common/frames/interpolated_times.hpp"
#include "common/messages.hpp"
#include "common/metas.hpp"
#include "common/shared_settings.hpp"
#include "common/worker.hpp"
#include "detect/boards_detector.hpp"
#include "detect/calibration_check.hpp"

namespace calvin::gst {

enum DetectMode { kModeAuto, kModeSync, kModeAsync };

struct DetectorSettings {
  std::string board{kDefaultBoard};
  std::string camera = "cam0";
  std::string recheck;
  DetectMode mode = kModeAuto;
  double max_rate = 0;  // 1/s; 0: every frame
  bool post_messages = false;
  // Whether the detector has yet to take up what was set.
  bool board_changed = true;
  bool recheck_changed = true;
};

// What was found on a frame.
struct FrameFindings {
  std::vector<Observation> observations;
  DetectorHint hint;
};

class CalibDetector : public SharedSettings<DetectorSettings> {
 public:
  explicit CalibDetector(GstElement* element) : element_(element) {}

  // Any thread.
  [[nodiscard]] GstStructure* stats();

  // An error for settings that cannot work.
  [[nodiscard]] Status start();
  // Any thread: whoever waits for a detection goes on without it.
  void cancel() { worker_.cancel(); }
  void resume() { worker_.resume(); }
  void stop() {
    worker_.stop();
    board_reader_.stop();
    recheck_.stop();
  }
  // Somebody downstream wants to refine the corners with the camera, in their patches.
  void send_patches() {
    const std::lock_guard guard(lock_);
    patches_wanted_ = true;
  }

  // The rest on the streaming thread.
  [[nodiscard]] Status set_format(const GstVideoInfo& info);
  [[nodiscard]] bool has_format() const { return luma_ != nullptr; }
  // Whether choose_mode() is to be called before the next look(): once after each format.
  [[nodiscard]] bool mode_known() const { return mode_known_; }
  void choose_mode(bool live);

  // Of each frame in the order in which they come, also of those that are not looked at.
  [[nodiscard]] FrameTimes times_of(const GstSegment& segment, GstBuffer* buffer) {
    return frame_times(&segment, times_.of(segment, buffer), GST_BUFFER_DURATION(buffer));
  }

  // Looks for the boards in a frame, or has them looked for while the stream goes on: then what is
  // found waits for a later frame, and this one may not be changed any more. Absent: nothing to
  // attach.
  [[nodiscard]] std::optional<FrameFindings> look(GstBuffer* buffer, const FrameTimes& times);

  // Waits for what is being computed, unless cancelled.
  void drain() { worker_.drain(); }
  // The result that no buffer took yet.
  [[nodiscard]] std::optional<FrameFindings> take_waiting();
  // From here on another format applies: what is still being computed is of no use.
  void next_format();
  // And other times.
  void next_segment() {
    next_format();
    times_.restart();
  }

 private:
  // What one detection needs.
  struct Job {
    FrameTimes times;
    DetectorSettings settings;
    SharedDetector detector;
    std::shared_ptr<CalibrationCheck> check;
    std::shared_ptr<LumaReader> luma;
    Picture picture;
    std::optional<FramePart> part;  // of the picture that is the frame
    guint64 generation = 0;
    guint64 boards_asked_for = 0;
    bool patches = false;
  };

  // What was seen of one board.
  struct Seen {
    const Detection& detection;
    const Board* board;  // nullptr: any will do, and none was taken yet
    std::string hint;    // what keeps it from being found
    int place = 0;       // where it will stand in the meta
  };

  // `board` is read before the first frame; names in a file that are set while frames flow are read
  // beside them, and used when they have been. Keeps the old ones on an error.
  [[nodiscard]] Status start_boards();
  [[nodiscard]] Status update_boards();
  [[nodiscard]] Status take_boards(Result<SharedDetector> boards);
  void read_boards_beside(const std::string& text);
  // `recheck` is read before the first frame; a file that is named or replaced while frames flow is
  // used when it has been read.
  [[nodiscard]] Status start_recheck();
  [[nodiscard]] Status update_recheck();
  void name_recheck();
  [[nodiscard]] Status take_recheck(CalibrationReader::ReadResult read);
  // From here on pictures in memory have this format.
  [[nodiscard]] Status read_pictures(const GstVideoInfo& info);
  // How the frame lies in the buffer, and that it can be read.
  [[nodiscard]] Status prepare(GstBuffer* buffer, Job& job);
  [[nodiscard]] bool is_due(const FrameTimes& times, double max_rate);
  void skip();
  [[nodiscard]] std::optional<FrameFindings> wait_for(Job job);

  // On the worker.
  [[nodiscard]] FrameFindings run(const Job& job, const std::stop_token& stop);
  // Whether it has been too dark for a while to find anything.
  [[nodiscard]] bool stays_dark(const std::vector<Detection>& detections, const ImageView& image);
  // Whether it was not said yet what keeps the board at `place` from being found.
  [[nodiscard]] bool is_news(const Detection& detection, const std::string& hint, int place);
  void take_board(const Job& job, const SharedDetector& boards, const std::stop_token& stop);
  void report(const Job& job, const Seen& seen, guint64 latency_us, const std::stop_token& stop);
  void post(GstStructure* message, const std::stop_token& stop);
  void recheck(const Job& job, const View& view, int place, const std::stop_token& stop);

  GstElement* element_;

  // Under lock_.
  std::optional<Result<SharedDetector>>
      boards_found_;                     // for the last change of `board`, read beside
  guint64 boards_asked_for_ = 0;         // counts those changes; the streaming thread does
  std::optional<FrameFindings> result_;  // waits for a buffer to ride on
  guint64 generation_ = 0;  // of the stream: a result of an older segment is thrown away
  bool patches_wanted_ = false;
  guint64 frames_ = 0;
  guint64 detections_ = 0;
  guint64 skipped_ = 0;

  // Streaming thread only. What the worker uses of it goes along with the job.
  GstVideoInfo info_{};
  InterpolatedTimes times_;
  bool is_interlaced_ = false;  // and that was said
  std::shared_ptr<LumaReader> luma_;
  ImageSize luma_size_;
  SharedDetector detector_;
  CalibrationReader recheck_;
  std::shared_ptr<CalibrationCheck> check_;
  bool async_ = false;
  bool mode_known_ = false;
  bool frame_refused_ = false;  // and that was reported
  GstClockTime last_detection_ = GST_CLOCK_TIME_NONE;

  // lock_: what was said at each place since its board was found, and how many frames in a row were
  // too dark. Changed by the worker alone, but a job that was cancelled may outlive its run.
  std::map<int, std::set<std::string>> hints_said_;
  int dark_frames_ = 0;

  Worker worker_;
  Worker board_reader_;
};

}  // namespace calvin::gst
