// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

#include "calvin/detect/checkerboard.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <numeric>

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "calvin/detect/grid.hpp"
#include "calvin/detect/refine.hpp"

namespace calvin::detect {

namespace {

constexpr int kSearchWidth = 960;    // px; the board is searched for at no more than this
constexpr int kLeastSide = 16;       // px; no board is in a smaller image
constexpr double kLeastSpacing = 4;  // px between grid lines

class CheckerboardDetector final : public Detector {
 public:
  explicit CheckerboardDetector(const Board& board) : board_(board) {}

  Detection detect(const ImageView& image, std::stop_token stop) noexcept override {
    try {
      return search(image, stop);
    } catch (const std::exception&) {
      // cv::Exception for an image that OpenCV cannot search, or no memory: nothing was found.
      return {};
    }
  }

 private:
  Detection search(const ImageView& image, const std::stop_token& stop) {
    Detection result;
    result.observation.board = board_.text();
    result.observation.image_size = image.size();
    if (image.data == nullptr || image.width < kLeastSide || image.height < kLeastSide) {
      return result;
    }
    const cv::Mat luma = contiguous(image);
    Grid grid;
    if (stop.stop_requested() || !find(luma, grid) || stop.stop_requested()) return result;
    if (!is_smooth(grid)) return result;
    if (least_spacing(grid) < kLeastSpacing) {
      result.reason = Reason::kTooSmall;
      return result;
    }
    result.reason = label(image, board_, grid, result.observation.ambiguous);
    if (result.reason == Reason::kAccepted && !(refine(luma, grid, result.observation.sigma) &&
                                                is_smooth(grid) && has_corners(image, grid))) {
      result.reason = Reason::kNotFound;
    }
    if (result.reason == Reason::kAccepted) {
      result.observation.uv = grid.points;
      result.observation.ids.resize(grid.points.size());
      std::iota(result.observation.ids.begin(), result.observation.ids.end(), 0);
    } else {
      result.observation.sigma.clear();
      result.observation.ambiguous.clear();
    }
    return result;
  }

  // The pixels as OpenCV wants them: in place, or a copy where they are not side by side.
  cv::Mat contiguous(const ImageView& image) {
    if (image.step == 1 && image.stride >= image.width) {
      return {image.height, image.width, CV_8UC1, const_cast<std::uint8_t*>(image.data),
              static_cast<std::size_t>(image.stride)};
    }
    copy_.create(image.height, image.width, CV_8UC1);
    for (int y = 0; y < image.height; ++y) {
      std::uint8_t* row = copy_.ptr(y);
      for (int x = 0; x < image.width; ++x) row[x] = image.at(x, y);
    }
    return copy_;
  }

  bool find(const cv::Mat& luma, Grid& grid) {
    cv::Mat small = luma;
    if (luma.cols > kSearchWidth) {
      const int height = std::max(1, luma.rows * kSearchWidth / luma.cols);
      cv::resize(luma, small_, {kSearchWidth, height}, 0, 0, cv::INTER_AREA);
      small = small_;
    }
    std::vector<cv::Point2f> corners;
    if (!cv::findChessboardCornersSB(small, {board_.cols, board_.rows}, corners,
                                     cv::CALIB_CB_NORMALIZE_IMAGE) ||
        corners.size() != static_cast<std::size_t>(board_.point_count())) {
      return false;
    }
    const double su = static_cast<double>(luma.cols) / small.cols;
    const double sv = static_cast<double>(luma.rows) / small.rows;
    grid = {board_.cols, board_.rows, {}};
    for (const cv::Point2f& p : corners) {
      const Pixel uv = {(p.x + 0.5) * su - 0.5, (p.y + 0.5) * sv - 0.5};
      if (!(uv.u >= 0 && uv.v >= 0 && uv.u <= luma.cols - 1 && uv.v <= luma.rows - 1)) return false;
      grid.points.push_back(uv);
    }
    return true;
  }

  Board board_;
  cv::Mat copy_;
  cv::Mat small_;
};

}  // namespace

std::unique_ptr<Detector> make_checkerboard_detector(const Board& board) {
  return std::make_unique<CheckerboardDetector>(board);
}

}  // namespace calvin::detect
