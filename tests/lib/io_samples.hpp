// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Calibrations to write and files to read, for the tests of io/.
#pragma once

#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "calvin/camera/camera.hpp"
#include "calvin/camera/lens_table.hpp"
#include "calvin/core/calibration.hpp"
#include "calvin/io/calibration_io.hpp"
#include "calvin_config.h"

namespace calvin::test {

// 640x480, f about 520, with the model's own typical lens; awkward digits on purpose.
inline Calibration sample(const std::string& model) {
  Calibration calibration;
  calibration.camera = "cam0";
  calibration.image_size = {640, 480};
  calibration.model = model;
  calibration.parameters = {{"fx", 520.1234567890123, {}},
                            {"fy", 518.0 + 1.0 / 3, {}},
                            {"cx", 325, {}},
                            {"cy", 236.00000000000003, {}}};
  const LensTraits& lens = *find_lens(model);
  if (!lens.perspective) {
    for (auto& p : calibration.parameters) p.value *= p.name[0] == 'f' ? 0.5 : 1;
  }
  for (std::size_t i = 0; i < lens.coefficients.size(); ++i) {
    const auto& [low, high] = lens.typical[i];
    calibration.parameters.push_back(
        {std::string(lens.coefficients[i]), low + (high - low) / 3, {}});
  }
  return calibration;
}

// One camera in the files of other software.
inline constexpr const char* kRosFile = R"(image_width: 640
image_height: 480
camera_name: narrow_stereo
camera_matrix:
  rows: 3
  cols: 3
  data: [520, 0, 325, 0, 518, 236, 0, 0, 1]
distortion_model: plumb_bob
distortion_coefficients:
  rows: 1
  cols: 5
  data: [-0.28, 0.09, 0.0005, -0.0007, 0]
rectification_matrix:
  rows: 3
  cols: 3
  data: [1, 0, 0, 0, 1, 0, 0, 0, 1]
projection_matrix:
  rows: 3
  cols: 4
  data: [480, 0, 326, 0, 0, 488, 235, 0, 0, 0, 1, 0]
)";

inline constexpr const char* kOpenCvYamlFile = R"(%YAML:1.0
---
calibration_time: "Sat Nov 21 05:10:00 2026"
image_width: 640
image_height: 480
flags: 0
camera_matrix: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 520., 0., 325., 0., 518., 236., 0., 0., 1. ]
distortion_coefficients: !!opencv-matrix
   rows: 5
   cols: 1
   dt: d
   data: [ -0.28, 0.09, 5e-04, -7e-04, 0. ]
avg_reprojection_error: 0.097
)";

inline constexpr const char* kOpenCvXmlFile = R"(<?xml version="1.0"?>
<opencv_storage>
<cameraMatrix type_id="opencv-matrix">
  <rows>3</rows>
  <cols>3</cols>
  <dt>d</dt>
  <data>
    520. 0. 325. 0. 518. 236. 0. 0. 1.</data></cameraMatrix>
<distCoeffs type_id="opencv-matrix">
  <rows>1</rows>
  <cols>5</cols>
  <dt>d</dt>
  <data>
    -0.28 0.09 5e-04 -7e-04 0.</data></distCoeffs>
</opencv_storage>
)";

inline constexpr const char* kOpenCvJsonFile = R"({
    "cameraResolution": [ 640, 480 ],
    "cameraMatrix": { "type_id": "opencv-matrix", "rows": 3, "cols": 3, "dt": "d",
        "data": [ 520.0, 0.0, 325.0, 0.0, 518.0, 236.0, 0.0, 0.0, 1.0 ] },
    "dist_coeffs": { "type_id": "opencv-matrix", "rows": 1, "cols": 5, "dt": "d",
        "data": [ -0.28, 0.09, 0.0005, -0.0007, 0.0 ] }
})";

inline constexpr const char* kNativeFile =
    R"({"format": "calvin-calibration", "version": 1, "camera": "cam0", "image_size": [640, 480],
"model": "brown5", "future": {"unknown": [1, {"deep": null}]},
"parameters": {"fx": 520, "fy": 518, "cx": 325, "cy": 236, "k1": -0.28, "k2": 0.09, "p1": 0.0005,
"p2": -7E-4, "k3": 0}, "device": {}, "created": "2026-11-21T10:00:00Z"})";

// Bouguet's toolbox: the script that it writes, and its variables as Octave saves them.
inline constexpr const char* kBouguetScript = R"(% Intrinsic and Extrinsic Camera Parameters
%
% Nothing else is in this file; the corners are in Calib_Results.mat.

%-- Focal length:
fc = [ 520.000000000000000 ; 518.000000000000000 ];

%-- Principal point:
cc = [ 325.000000000000000 ; 236.000000000000000 ];

%-- Skew coefficient:
alpha_c = 0.000000000000000;

%-- Distortion coefficients:
kc = [ -0.280000000000000 ; 0.090000000000000 ; 0.000500000000000 ; -0.000700000000000 ; 0.000000000000000 ];

%-- Focal length uncertainty:
fc_error = [ 0.900000000000000 ; 1.200000000000000 ];

%-- Image size:
nx = 640;
ny = 480;

n_ima = 20;						% Number of calibration images
omc_1 = [ NaN ; NaN ; NaN ];
)";
inline constexpr const char* kBouguetOctave =
    R"(# Created by Octave 8.4.0, Sat Nov 21 05:10:00 2026 UTC <a@b>
# name: fc
# type: matrix
# rows: 2
# columns: 1
 520
 518


# name: cc
# type: matrix
# rows: 2
# columns: 1
 325
 236


# name: kc
# type: matrix
# rows: 5
# columns: 1
 -0.28
 0.09
 5.0e-04
 -7.0e-04
 0


# name: nx
# type: scalar
640


# name: ny
# type: scalar
480


# name: calib_name
# type: string
# elements: 1
# length: 5
Image


# name: err_std
# type: matrix
# rows: 2
# columns: 1
 0.3
 0.4


)";

inline const std::vector<std::string>& sample_files() {
  static const std::vector<std::string> kFiles = {kRosFile,        kOpenCvYamlFile, kOpenCvXmlFile,
                                                  kOpenCvJsonFile, kNativeFile,     kBouguetScript,
                                                  kBouguetOctave};
  return kFiles;
}

// Points in front of a camera.
inline std::vector<Eigen::Vector3d> grid() {
  std::vector<Eigen::Vector3d> points;
  for (int i = -4; i <= 4; ++i) {
    for (int j = -3; j <= 3; ++j) points.emplace_back(0.14 * i, 0.14 * j, 1 + 0.05 * i);
  }
  return points;
}

inline bool readable(std::string_view format) {
  return CALVIN_HAVE_FORMATS || format == "calvin" || format == "opencv-json" ||
         format == "mrcal" || format == "colmap";
}

// All that hold a camera with skew, and the lens of brown5. Kalibr's, mrcal's and COLMAP's do not:
// test_rig_formats.cpp, test_mrcal.cpp, test_colmap.cpp.
inline std::vector<std::string_view> formats_with_skew() {
  std::vector<std::string_view> formats = calibration_formats();
  std::erase_if(formats, [](std::string_view format) {
    return format == "kalibr" || format == "mrcal" || format == "colmap";
  });
  return formats;
}

// The file formats of OpenCV and ROS know the lenses of their own programs only.
inline bool holds(std::string_view format, std::string_view model) {
  static const std::set<std::string_view> kOfRos = {"pinhole", "brown4", "brown5", "rational8",
                                                    "fisheye"};
  if (format == "calvin" || kOfRos.contains(model)) return true;
  return format != "ros" && (model == "thinprism12" || model == "tilted14");
}

}  // namespace calvin::test
