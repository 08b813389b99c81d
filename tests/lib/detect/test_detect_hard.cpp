// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Small blurred squares of little contrast in noise, compression and clutter, drawn by OpenCV: how
// many boards are found whole, whether a corner is none, how long the worst take, and sigmas.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iostream>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <time.h>

#include "calvin/detect/detector.hpp"
#include "calvin/target/kinds.hpp"
#include "hard_picture.hpp"
#include "scenes.hpp"

namespace calvin {
namespace {

double cpu_time_ms() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
}

class Tally {
 public:
  void look(const hard::Picture& picture) {
    const Board board = Checkerboard{picture.cols, picture.rows, 0.025};
    auto& detector = detectors_[{picture.cols, picture.rows}];
    if (!detector) detector = std::move(*make_detector(board));
    const cv::Mat& image = picture.image;
    const ImageView view = {image.data, image.cols, image.rows,
                            static_cast<std::ptrdiff_t>(image.step[0]), 1};
    Observation seen;
    double least = 1e9;
    for (int again = 0; again < 3; ++again) {
      const double before = cpu_time_ms();
      seen = detector->detect(view).observation;
      least = std::min(least, cpu_time_ms() - before);
    }
    times_.push_back(least);
    whole_ += static_cast<int>(seen.ids.size()) == board.point_count() ? 1 : 0;
    compare(seen, picture);
  }

  [[nodiscard]] double count() const { return static_cast<double>(times_.size()); }
  [[nodiscard]] double whole() const { return whole_ / count(); }
  [[nodiscard]] int found() const { return found_; }
  [[nodiscard]] int wrong() const { return wrong_; }
  [[nodiscard]] double predicted_over_real() const { return std::sqrt(predicted_ / real_); }
  // Of the 95th percentile of times over the median.
  [[nodiscard]] double slowest() {
    std::sort(times_.begin(), times_.end());
    return times_[times_.size() * 95 / 100] / times_[times_.size() / 2];
  }
  void print(const char* what) {
    std::cout << "  " << what << ": of " << count() << " boards " << found_ << " found, "
              << 100 * whole() << " % whole, " << wrong_ << " with a corner that is none, sigma "
              << predicted_over_real() << " of the error, slowest " << slowest()
              << " of the median\n";
  }

 private:
  // Of each corner, px: from the one of its name, or from the nearest where names are said to be
  // open.
  static std::vector<double> errors_of(const Observation& seen, const hard::Picture& picture) {
    const auto off = [&](std::size_t i, std::size_t id) {
      const cv::Point2d& at = picture.corners[id];
      return std::hypot(seen.uv[i].u - at.x, seen.uv[i].v - at.y);
    };
    std::vector<double> errors;
    for (std::size_t i = 0; i < seen.ids.size(); ++i) {
      double error = off(i, static_cast<std::size_t>(seen.ids[i]));
      for (std::size_t id = 0; !seen.ambiguous.empty() && id < picture.corners.size(); ++id) {
        error = std::min(error, off(i, id));
      }
      errors.push_back(error);
    }
    return errors;
  }

  void compare(const Observation& seen, const hard::Picture& picture) {
    constexpr double kAnother = 0.5;  // of a square
    constexpr double kStray = 1.5;    // px: beyond, an error is none of a fit
    if (!seen.found()) return;
    ++found_;
    bool is_wrong = false;
    const std::vector<double> errors = errors_of(seen, picture);
    for (std::size_t i = 0; i < errors.size(); ++i) {
      is_wrong |= errors[i] > kAnother * picture.square;
      if (errors[i] > kStray) continue;
      real_ += errors[i] * errors[i] / 2;
      predicted_ += seen.sigma[i] * seen.sigma[i];
    }
    wrong_ += is_wrong ? 1 : 0;
  }

  std::map<std::pair<int, int>, std::unique_ptr<Detector>> detectors_;
  std::vector<double> times_;  // ms
  int whole_ = 0;
  int found_ = 0;
  int wrong_ = 0;
  double predicted_ = 0;  // px², a coordinate
  double real_ = 0;
};

Tally look_at(const hard::Rules& rules, std::uint64_t first) {
  const std::uint64_t count = scenes::full_count() ? 400 : 60;
  Tally tally;
  for (std::uint64_t i = 0; i < count; ++i) tally.look(hard::make_picture(first + i, rules));
  return tally;
}

TEST(HardPictures, AreFoundWhole) {
  Tally tally = look_at({}, 100000);
  tally.print("contrast 80 to 120");
  EXPECT_GE(tally.whole(), 0.95);
  EXPECT_EQ(tally.wrong(), 0);
  EXPECT_LT(tally.slowest(), 2.5);
  EXPECT_GT(tally.predicted_over_real(), 0.8);
  EXPECT_LT(tally.predicted_over_real(), 1.25);
}

// A corner of 50 grey levels in noise of 16 is at times not to be seen, nor is a whole board.
TEST(HardPictures, OfLeastContrastAreMostlyFoundWhole) {
  Tally tally = look_at({50, 80, false}, 200000);
  tally.print("contrast 50 to 80");
  EXPECT_GE(tally.whole(), 0.94);
  EXPECT_EQ(tally.wrong(), 0);
}

TEST(HardPictures, CutByTheBorderHaveSigmasToMatch) {
  Tally tally = look_at({80, 120, true}, 300000);
  tally.print("cut by the border");
  EXPECT_GE(tally.found(), 0.7 * tally.count());
  // Clutter behind the board may at times go on like a row where its own margin is out of view.
  EXPECT_LE(tally.wrong(), 1 + 0.01 * tally.count());
  EXPECT_GT(tally.predicted_over_real(), 0.8);
  EXPECT_LT(tally.predicted_over_real(), 1.25);
}

}  // namespace
}  // namespace calvin
