// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// From the pictures of eight cameras to the file of a rig, by the program as it is installed: 300
// instants of 1280x720, rendered and written beforehand (JPEG). It has no peer here: printed are
// the time by the clock, that of the processor, and how far the cameras are from where they stand.

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

#include <sys/resource.h>

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>

#include "calvin/core/text.hpp"
#include "calvin/io/calibration_io.hpp"
#include "calvin/io/rig_io.hpp"
#include "calvin/synth/render.hpp"
#include "simulated_rig.hpp"
#include "temporary_folder.hpp"

namespace {

using namespace calvin;
namespace fs = std::filesystem;

constexpr ImageSize kFrame = {1280, 720};

scenes::SimulatedRig studio(int cameras, scenes::Random& random) {
  scenes::SimulatedRig rig = scenes::ring_rig(cameras, random);
  for (Camera& camera : rig.cameras) camera = scenes::random_camera("brown5", random, kFrame);
  return rig;
}

// Files cam0.json and cam0/0000.jpg and so on.
void write_pictures(const scenes::SimulatedRig& rig, int instants, const fs::path& folder,
                    scenes::Random& random) {
  std::vector<SE3> places;
  for (int n = 0; n < instants; ++n) places.push_back(scenes::held_board(rig, 0.7, random));
  for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
    const fs::path own = folder / fmt::format("cam{}", c);
    fs::create_directories(own);
    Calibration calibration = rig.cameras[c].to_calibration();
    calibration.camera = own.filename().string();
    (void)write_calibration(own.string() + ".json", calibration);
    const BoardRenderer renderer(rig.cameras[c]);
    for (int n = 0; n < instants; ++n) {
      RenderOptions options;
      options.noise = 4;
      options.blur = 0.7;
      options.seed = noise_seed(c, static_cast<std::uint64_t>(n));
      const SE3 pose = rig.world_from_camera[c].inverse() * places[static_cast<std::size_t>(n)];
      GrayImage picture = renderer.render(rig.board, pose, options);
      const cv::Mat pixels(picture.height, picture.width, CV_8U, picture.pixels.data());
      cv::imwrite((own / fmt::format("{:04}.jpg", n)).string(), pixels);
    }
  }
}

double processor_seconds() {
  rusage usage{};
  getrusage(RUSAGE_CHILDREN, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

int measure(int cameras, int instants) {
  const TemporaryFolder folder;
  scenes::Random random(12);
  const scenes::SimulatedRig rig = studio(cameras, random);
  const fs::path root = fs::path(folder.path());
  write_pictures(rig, instants, root, random);
  std::string line = fmt::format("{} --board {} {}", BENCH_RIG_PROGRAM, rig.board.text(),
                                 (root / "rig.json").string());
  for (int c = 0; c < cameras; ++c) {
    const std::string own = (root / fmt::format("cam{}", c)).string();
    line += fmt::format(" {0}.json {0}", own);
  }
  const auto start = std::chrono::steady_clock::now();
  const int status = std::system(line.c_str());  // NOLINT(concurrency-mt-unsafe)
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const auto solved = read_rig(root / "rig.json");
  if (status != 0 || !solved) return 1;
  double turn = 0;
  double place = 0;
  const SE3 world_from_first = rig.world_from_camera.front();
  for (std::size_t c = 0; c < solved->cameras.size(); ++c) {
    const SE3 found = to_se3(solved->cameras[c].rig_from_camera);
    const SE3 off = (world_from_first.inverse() * rig.world_from_camera[c]).inverse() * found;
    turn = std::max(turn, log_so3(off.rotation).norm());
    place = std::max(place, off.translation.norm());
  }
  std::cout << fmt::format(
      "{} cameras, {} instants, {} pictures of {}x{}: {:.1f} s by the clock, {:.1f} s of the "
      "processor; cameras within {:.3f} mrad and {:.3f} mm\n",
      cameras, instants, cameras * instants, kFrame.width, kFrame.height, seconds,
      processor_seconds(), 1e3 * turn, 1e3 * place);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 1) return measure(8, 300);
  const auto cameras = parse_int(argv[1]);
  const auto instants = argc == 3 ? parse_int(argv[2]) : std::nullopt;
  if (cameras && instants && *cameras > 1 && *instants > 0) return measure(*cameras, *instants);
  std::cerr << "Usage: bench_rig_pictures [CAMERAS INSTANTS]\n";
  return 2;
}
