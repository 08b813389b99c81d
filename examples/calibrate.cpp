// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A folder of pictures to a calibration file: the library in some fifteen lines, which
// docs/library.md walks through. Built against the installed library:
//   g++ -std=c++20 calibrate.cpp -o calibrate $(pkg-config --cflags --libs calvin opencv4)
//   ./calibrate PICTURES checkerboard:9x6:25mm camera.json
#include <filesystem>
#include <iostream>
#include <system_error>
#include <vector>

#include <calvin/calvin.hpp>
#include <calvin/opencv.hpp>
#include <opencv2/imgcodecs.hpp>

calvin::Status calibrate(const std::filesystem::path& folder, const char* text, const char* file) {
  const auto board = calvin::parse_board(text);
  if (!board) return tl::unexpected(board.error());
  const auto detector = calvin::make_detector(*board);
  if (!detector) return tl::unexpected(detector.error());
  std::vector<calvin::View> views;
  std::error_code none;
  for (const auto& entry : std::filesystem::directory_iterator(folder, none)) {
    const cv::Mat picture = cv::imread(entry.path(), cv::IMREAD_GRAYSCALE);
    const auto seen = detector.value()->detect(calvin::image_view(picture));
    if (seen.observation.found()) views.push_back({seen.observation, *board});
  }
  if (views.empty()) {
    return calvin::make_error(calvin::ErrorCode::kNotFound, "No picture there shows the board.");
  }
  const auto solution = calvin::solve(views, views[0].observation.image_size);
  if (!solution) return tl::unexpected(solution.error());
  std::cout << views.size() << " views, rms " << *solution->calibration.rms << " px\n";
  return calvin::write_calibration(file, solution->calibration);
}

int main(int argc, char** argv) {
  if (argc != 4) {
    std::cerr << "calibrate PICTURES BOARD FILE\n";
    return 2;
  }
  const calvin::Status done = calibrate(argv[1], argv[2], argv[3]);
  if (!done) std::cerr << done.error().message << '\n';
  return done ? 0 : 1;
}
