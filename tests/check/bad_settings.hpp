// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Bad input, the first half: properties, files and signals, and what each element says to them.
#pragma once

#include "bad_input_ways.hpp"

namespace calvin::check {

inline constexpr char kBoardHelp[] = "A right text is 'checkerboard:9x6:25mm'";
inline constexpr char kKeysHelp[] = "A right text is 'fx=520,fy=518";
inline constexpr char kFileHelp[] = "Give a calibration in the native JSON";
inline constexpr char kPlaceHelp[] = "Choose a place in a folder that exists";
inline constexpr char kNextStart[] = "takes effect at the next start";
inline constexpr char kBarrelled[] =
    "calibundistort calibration=fx=480,fy=478,cx=325,cy=236,k1=-0.28,width=640,height=480";
inline constexpr char kSolve[] = "calibsolve capture-mode=all";
inline constexpr char kDetect[] = "calibdetect mode=sync";

// A text with `change` replaced by `with`.
inline std::string changed(std::string text, const std::string& change, const std::string& with) {
  const auto at = text.find(change);
  g_assert(at != std::string::npos);
  return text.replace(at, change.size(), with);
}
inline std::string native(const std::string& change, const std::string& with) {
  return changed(
      R"({"format": "calvin-calibration", "version": 1, "image_size": [640, 480], "model": "brown5",
 "parameters": {"fx": 536, "fy": 535, "cx": 342, "cy": 235, "k1": -0.2, "k2": 0.1, "p1": 0, "p2": 0, "k3": 0}})",
      change, with);
}
inline std::string xml(const std::string& change, const std::string& with) {
  return changed(
      R"(<?xml version="1.0"?><opencv_storage>
<cameraMatrix type_id="opencv-matrix"><rows>3</rows><cols>3</cols><dt>d</dt><data>480. 0. 325. 0. 478. 236. 0. 0. 1.</data></cameraMatrix>
<distCoeffs type_id="opencv-matrix"><rows>5</rows><cols>1</cols><dt>d</dt><data>-0.28 0.09 0. 0. 0.</data></distCoeffs>
</opencv_storage>)",
      change, with);
}
inline std::string ros(const std::string& change, const std::string& with) {
  return changed(
      "image_width: 640\nimage_height: 480\ncamera_name: c\n"
      "camera_matrix:\n  rows: 3\n  cols: 3\n  data: [480, 0, 325, 0, 478, 236, 0, 0, 1]\n"
      "distortion_model: plumb_bob\n"
      "distortion_coefficients:\n  rows: 1\n  cols: 5\n  data: [-0.28, 0.09, 0, 0, 0]\n",
      change, with);
}
inline const std::vector<BadInput>& bad_settings() {
  static const std::vector<BadInput> kTable = {
      // Board texts.
      {"a board of no known kind", "calibdetect", at_start, "board=checkers:9x6:25mm",
       "no kind of board called 'checkers'", kBoardHelp, After::kRefused},
      {"a board without a length", "calibdetect", at_start, "board=checkerboard:9x6",
       "needs a kind, a size in corners and a length", kBoardHelp, After::kRefused},
      {"an empty board text", "calibdetect", at_start, "board=", "wrong", kBoardHelp,
       After::kRefused},
      {"a length without a unit", "calibdetect", at_start, "board=checkerboard:9x6:25",
       "not a length with a unit", kBoardHelp, After::kRefused},
      {"a length with a comma", "calibdetect", at_start, "board=checkerboard:9x6:2,5cm",
       "not a length with a unit", kBoardHelp, After::kRefused},
      {"a negative length", "calibdetect", at_start, "board=checkerboard:9x6:-25mm",
       "not a positive length", kBoardHelp, After::kRefused},
      {"a length that is not a number", "calibdetect", at_start, "board=checkerboard:9x6:nanmm",
       "not a length", kBoardHelp, After::kRefused},
      {"squares of a kilometre", "calibtestsrc", at_start, "board=checkerboard:9x6:5000m",
       "out of range", kBoardHelp, After::kRefused},
      {"negative corners", "calibdetect", at_start, "board=checkerboard:-9x6:25mm", "out of range",
       kBoardHelp, After::kRefused},
      {"a board of one corner", "calibdetect", at_start, "board=checkerboard:1x1:25mm",
       "out of range", kBoardHelp, After::kRefused},
      {"a board of a million corners", "calibdetect", at_start, "board=checkerboard:1000x1000:1mm",
       "out of range", kBoardHelp, After::kRefused},
      {"corners in words", "calibdetect", at_start, "board=checkerboard:ninexsix:25mm",
       "not COLSxROWS", kBoardHelp, After::kRefused},
      {"a board text of a page", "calibdetect", at_start, "board=" + std::string(5000, 'x'),
       "too long", kBoardHelp, After::kRefused},
      {"a board behind nothing", "calibdetect", at_start, "board=checkerboard:9x6:25mm;",
       "no board before or after a ';'", kBoardHelp, After::kRefused},
      {"a file of board names that is missing", "calibdetect", at_start, "board=@/none.json#floor",
       "No such file", kBoardHelp, After::kRefused},
      {"a file of something else than board names", "calibdetect", at_start,
       "board=@/no-names.json#floor", "not a file of board names", kBoardHelp, After::kRefused},
      {"a board name that is not in its file", "calibdetect", at_start, "board=@/names.json#wall",
       "it has 'floor'", kBoardHelp, After::kRefused},
      {"a board name that stands for another", "calibdetect", at_start, "board=@/names.json#floor",
       "stands for another name", kBoardHelp, After::kRefused},
      {"two boards to render", "calibtestsrc", at_start,
       "board=checkerboard:9x6:25mm;checkerboard:5x4:10mm", "names 2", "renders one board",
       After::kRefused},
      {"a wrong board while frames flow", "calibdetect", while_running, "board=nonsense",
       "no kind of board", kBoardHelp, After::kGoesOn},

      // Key lists.
      {"a focal length that is no number", "calibundistort", at_start,
       "calibration=fx=nan,fy=478,cx=325,cy=236", "fx is 'nan', not a number", kKeysHelp,
       After::kRefused},
      {"an infinite coefficient", "calibundistort", at_start,
       "calibration=fx=480,fy=478,cx=325,cy=236,k1=inf", "k1 is 'inf', not a number", kKeysHelp,
       After::kRefused},
      {"a negative focal length", "calibundistort", at_start,
       "calibration=fx=480,fy=-478,cx=325,cy=236", "must be positive", kKeysHelp, After::kRefused},
      {"a number beyond all bounds", "calibundistort", at_start,
       "calibration=fx=1e300,fy=478,cx=325,cy=236", "not a usable number", kKeysHelp,
       After::kRefused},
      {"numbers with commas", "calibundistort", at_start,
       "calibration=fx=480,5,fy=478,1,cx=325,cy=236", "'5' is not name=value", kKeysHelp,
       After::kRefused},
      {"a number with its unit", "calibundistort", at_start,
       "calibration=fx=480px,fy=478,cx=325,cy=236", "fx is '480px', not a number", kKeysHelp,
       After::kRefused},
      {"a width of nothing", "calibundistort", at_start,
       "calibration=fx=480,fy=478,cx=325,cy=236,width=0,height=480", "not a number of pixels",
       kKeysHelp, After::kRefused},
      {"a width without a height", "calibundistort", at_start,
       "calibration=fx=480,fy=478,cx=325,cy=236,width=640", "belong together", kKeysHelp,
       After::kRefused},
      {"an unknown model", "calibundistort", at_start,
       "calibration=fx=480,fy=478,cx=325,cy=236,model=cubic", "no camera model 'cubic'", kKeysHelp,
       After::kRefused},
      {"an unknown key", "calibundistort", at_start, "calibration=fx=480,fy=478,cx=325,cy=236,k9=1",
       "'k9' is not of", kKeysHelp, After::kRefused},
      {"one key twice", "calibundistort", at_start,
       "calibration=fx=480,fx=481,fy=478,cx=325,cy=236", "'fx' occurs twice", kKeysHelp,
       After::kRefused},
      {"a key list without fy", "calibundistort", at_start, "calibration=fx=480,cx=325,cy=236",
       "fy is missing", kKeysHelp, After::kRefused},
      {"the camera of a source without a focal length", "calibtestsrc", at_start,
       "calibration=fx=0,fy=500,cx=320,cy=240", "must be positive", kKeysHelp, After::kRefused},
      {"a wrong key list while frames flow", kBarrelled, while_running, "calibration=fx=480,fy=0",
       "missing", kKeysHelp, After::kGoesOn},

      // JSON.
      {"JSON that is cut off", "calibundistort", in_file, native("1, \"image", "\"image"),
       "in line", kFileHelp, After::kRefused},
      {"the JSON of something else", "calibundistort", in_file, "{\"answer\": 42}",
       "none of the fields of a calibration", kFileHelp, After::kRefused},
      {"another format's name", "calibundistort", in_file,
       native("calvin-calibration", "calvin-fixture"), "'format' is 'calvin-fixture'", kFileHelp,
       After::kRefused},
      {"a version of the future", "calibundistort", in_file,
       native("\"version\": 1", "\"version\": 99"), "newer version", kFileHelp, After::kRefused},
      {"version 0", "calibundistort", in_file, native("\"version\": 1", "\"version\": 0"),
       "'version' is not 1", kFileHelp, After::kRefused},
      {"a JSON file without a model", "calibundistort", in_file, native("\"model\"", "\"modell\""),
       "'model' is missing", kFileHelp, After::kRefused},
      {"a model that nobody knows", "calibundistort", in_file, native("brown5", "cubic7"),
       "'cubic7' is not known", kFileHelp, After::kRefused},
      {"a JSON file without parameters", "calibundistort", in_file,
       native("\"parameters\"", "\"numbers\""), "'parameters' is missing", kFileHelp,
       After::kRefused},
      {"a parameter too few", "calibundistort", in_file, native("\"cx\": 342, ", ""), "has no 'cx'",
       kFileHelp, After::kRefused},
      {"a parameter too many", "calibundistort", in_file,
       native("\"k3\": 0", "\"k3\": 0, \"k4\": 0"), "has a 'k4'", kFileHelp, After::kRefused},
      {"a list for a number", "calibundistort", in_file, native("536", "[536]"),
       "'parameters.fx' is not a finite number", kFileHelp, After::kRefused},
      {"a text for a number", "calibundistort", in_file, native("536", "\"536\""),
       "'parameters.fx' is not a finite number", kFileHelp, After::kRefused},
      {"NaN in JSON", "calibundistort", in_file, native("536", "NaN"), "in line", kFileHelp,
       After::kRefused},
      {"a number that no double holds", "calibundistort", in_file, native("536", "1e999"),
       "in line 2", kFileHelp, After::kRefused},
      {"a picture of 0x0", "calibundistort", in_file, native("[640, 480]", "[0, 0]"),
       "'image_size' is not", kFileHelp, After::kRefused},
      {"a picture of half a pixel", "calibundistort", in_file, native("[640, 480]", "[0.5, 480]"),
       "'image_size' is not", kFileHelp, After::kRefused},
      {"a field twice", "calibundistort", in_file, native("\"fy\": 535", "\"fx\": 535"),
       "'fx' occurs twice", kFileHelp, After::kRefused},
      {"a hundred thousand brackets", "calibundistort", in_file,
       native("\"brown5\"", std::string(100000, '[')), "nested more than", kFileHelp,
       After::kRefused},
      {"a sensor crop outside the picture", "calibundistort", in_file,
       native("\"version\": 1", "\"version\": 1, \"sensor_crop\": [600, 0, 100, 100]"),
       "'sensor_crop' is not within the image", kFileHelp, After::kRefused},
      {"a negative sigma in a file", "calibundistort", in_file,
       native("\"version\": 1", "\"version\": 1, \"sigma\": {\"fx\": -1}"),
       "'sigma.fx' is negative", kFileHelp, After::kRefused},
      {"JSON in UTF-16", "calibundistort", in_file, std::string("{\0\"\0f\0", 6), "not text",
       kFileHelp, After::kRefused},
      {"broken JSON as the property", "calibundistort", at_start,
       "calibration={\"format\": ", "at its end", kFileHelp, After::kRefused},
      {"broken JSON while frames flow", kBarrelled, while_running,
       "calibration={\"format\": ", "at its end", kFileHelp, After::kGoesOn},

      // OpenCV and ROS.
      {"11 distortion coefficients", "calibundistort", in_file,
       changed(xml("<rows>5", "<rows>11"), "-0.28", "0 0 0 0 0 0 -0.28"),
       "there are 11 distortion coefficients", kFileHelp, After::kRefused, Needs::kFormats},
      {"a camera matrix of 2x2", "calibundistort", in_file,
       changed(xml("<rows>3</rows><cols>3", "<rows>2</rows><cols>2"),
               "480. 0. 325. 0. 478. 236. 0. 0. 1.", "480. 0. 0. 478."),
       "not a matrix of 3x3", kFileHelp, After::kRefused, Needs::kFormats},
      {"fewer numbers than rows and columns", "calibundistort", in_file, xml("-0.28 ", ""),
       "'distCoeffs.data' has 4 numbers", kFileHelp, After::kRefused, Needs::kFormats},
      {"words in a matrix", "calibundistort", in_file, xml("480.", "wide"), "not a finite number",
       kFileHelp, After::kRefused, Needs::kFormats},
      {"a matrix in base64", "calibundistort", in_file, xml("480.", "$base64$AAAA 480."), "base64",
       "write the file as plain text", After::kRefused, Needs::kFormats},
      {"an empty OpenCV file", "calibundistort", in_file,
       "<?xml version=\"1.0\"?><opencv_storage></opencv_storage>", "is missing", kFileHelp,
       After::kRefused, Needs::kFormats},
      {"an OpenCV file without coefficients", "calibundistort", in_file,
       changed(xml("<distCoeffs", "<other"), "</distCoeffs", "</other"), "is missing", kFileHelp,
       After::kRefused, Needs::kFormats},
      {"a camera matrix that is no camera's", "calibundistort", in_file,
       xml("0. 0. 1.", "0. 1. 0."), "has not the form", kFileHelp, After::kRefused,
       Needs::kFormats},
      {"XML that is cut off", "calibundistort", in_file, "<?xml version=\"1.0\"?><opencv_storage>",
       "camera.txt", kFileHelp, After::kRefused, Needs::kFormats},
      {"the settings that made the peer abort", "calibundistort", at_start, "calibration=<hello",
       "cannot be used", kFileHelp, After::kRefused},
      {"YAML that is none", "calibundistort", in_file, "%YAML:1.0\n---\ncamera_matrix: [1, {\n",
       "camera.txt", kFileHelp, After::kRefused, Needs::kFormats},
      {"an unknown distortion model in ROS's file", "calibundistort", in_file,
       ros("plumb_bob", "plumb_jack"), "'distortion_model' is 'plumb_jack'", kFileHelp,
       After::kRefused, Needs::kFormats},
      {"a ROS file without a size", "calibundistort", in_file, ros("image_width: 640\n", ""),
       "'image_width' is missing", kFileHelp, After::kRefused, Needs::kFormats},
      {"too many coefficients for ROS's model", "calibundistort", in_file,
       changed(ros("cols: 5", "cols: 6"), "[-0.28", "[0, -0.28"), "are 6, but plumb_bob has 5",
       kFileHelp, After::kRefused, Needs::kFormats},

      // Files.
      {"a folder for a calibration", "calibundistort", at_start, "calibration=@/directory",
       "Is a directory", kFileHelp, After::kRefused},
      {"a pipe for a calibration", "calibundistort", at_start, "calibration=@/pipe",
       "not a regular file", kFileHelp, After::kRefused},
      {"an empty file", "calibundistort", at_start, "calibration=@/empty", "it is empty", kFileHelp,
       After::kRefused},
      {"a program for a calibration", "calibundistort", at_start, "calibration=@/binary",
       "not text", kFileHelp, After::kRefused},
      {"a link to itself", "calibundistort", at_start, "calibration=@/loop", "symbolic links",
       kFileHelp, After::kRefused},
      {"a file of 4 GiB", "calibundistort", at_start, "calibration=@/huge", "larger than",
       kFileHelp, After::kRefused},
      {"a calibration file that is not there", "calibundistort", at_start,
       "calibration=@/nothing/cam.json", "No such file", "not undistorted", After::kGoesOn},
      {"a name too long for a file", "calibundistort", at_start,
       "calibration=" + std::string(5000, 'x'), "too long", kFileHelp, After::kRefused},

      // What calibsolve is to write and to solve.
      {"a location in a folder that is not there", kSolve, at_start, "location=@/nothing/cam.json",
       "Cannot write", kPlaceHelp, After::kGoesOn},
      {"a folder as the location", kSolve, at_start, "location=@/directory", "Is a directory",
       kPlaceHelp, After::kGoesOn},
      {"an export into a file as if it were a folder", kSolve, at_start,
       "export=ros:@/empty/cam.yaml", "Not a directory", kPlaceHelp, After::kGoesOn},
      {"a location below a link to itself", kSolve, at_start, "location=@/loop/cam.json",
       "Cannot write", kPlaceHelp, After::kGoesOn},
      {"an unknown export format", kSolve, at_start, "export=pdf:a.pdf", "'pdf:a.pdf' is wrong",
       "ros:camera.yaml", After::kRefused},
      {"an export without a file", kSolve, at_start, "export=ros", "'ros' is wrong",
       "ros:camera.yaml", After::kRefused},
      {"two exports to one file", kSolve, at_start, "export=ros:@/a.yaml,opencv-yaml:@/./a.yaml",
       "twice", "a file of its own", After::kRefused},
      {"an export over the location", "calibsolve location=/tmp/cam.json", at_start,
       "export=opencv-json:/tmp/cam.json", "twice", "a file of its own", After::kRefused},
      {"fixing what does not exist", kSolve, at_start, "fix=aspect,k9", "'k9' cannot be fixed",
       "What can: aspect, center", After::kRefused},
      {"fixing what another model has", "calibsolve model=pinhole", at_start, "fix=k1",
       "'k1' cannot be fixed", "What can: aspect, center", After::kRefused},
      {"a model that cannot be solved", kSolve, at_start, "model=brown17", "'brown17' is not known",
       "Known models: ", After::kRefused},
      {"fewer views at most than at least", "calibsolve min-views=10", at_start, "max-views=5",
       "max-views=5 is less than min-views=10", "raise max-views", After::kRefused},
      {"the end without any view", kSolve, eos, "location=@/cam.json", "No calibration",
       "Show the whole board", After::kStopped},
      {"solving without a view", kSolve, signal, "solve", "no view of the board was taken",
       "Show the whole board", After::kGoesOn},
      {"an unknown model while frames flow", kSolve, while_running, "model=brown99",
       "Known models: pinhole", "What was set before goes on", After::kGoesOn},
      {"a broken initial calibration while frames flow", kSolve, while_running, "initial={",
       "(initial)", "What was set before goes on", After::kGoesOn},
      {"a fixed focal length without a value for it", kSolve, while_running, "fix=fx",
       "cannot be fixed at nothing", "give a calibration", After::kGoesOn},
      {"another model with a parameter held that it does not have", "calibsolve fix=k1",
       while_running, "model=pinhole", "'k1' cannot be fixed", "What was set before goes on",
       After::kGoesOn},
      {"fewer views at most than at least while frames flow", kSolve, while_running, "max-views=2",
       "max-views=2 is less than min-views=3", "raise max-views", After::kGoesOn},
      {"an unknown export format while frames flow", kSolve, while_running, "export=pdf:a.pdf",
       "'pdf:a.pdf' is wrong", "ros:camera.yaml", After::kGoesOn},
      {"a location in no folder while frames flow", kSolve, while_running_beside,
       "location=@/nothing/cam.json", "Cannot write", kPlaceHelp, After::kGoesOn},
      {"one file twice while frames flow", kSolve, while_running_beside,
       "export=ros:@/a.yaml,opencv-yaml:@/./a.yaml", "twice", "What was set before goes on",
       After::kGoesOn},
      {"a name in a file of boards that is not there while frames flow", kDetect,
       while_running_beside, "board=@/none.json#floor", "none.json", "checkerboard:9x6:25mm",
       After::kGoesOn},
      {"a broken initial calibration", kSolve, at_start, "initial=@/binary", "(initial)", kFileHelp,
       After::kRefused},
      {"an initial calibration that is not there", kSolve, at_start, "initial=@/none.json",
       "(initial)", kFileHelp, After::kRefused},
      {"a parameter tied twice", kSolve, at_start, "fix=fx=fy,aspect", "'aspect' ties",
       "tied already", After::kRefused},
      {"a tie to what does not exist", kSolve, at_start, "fix=k1=k9", "k9", "What can",
       After::kRefused},
      {"a broken calibration to check against", kDetect, at_start, "recheck=@/empty", "(recheck)",
       kFileHelp, After::kRefused},
      {"a calibration to check against that is not there", kDetect, at_start, "recheck=@/none.json",
       "(recheck)", kFileHelp, After::kRefused},
      {"a broken calibration to check against while frames flow", kDetect, while_running,
       "recheck={", "(recheck)", kFileHelp, After::kGoesOn},
      {"another overlay while frames flow", "calibrate mode=sync overlay=false", while_running,
       "overlay=true", "'overlay' cannot change", "set it in the states NULL or READY",
       After::kGoesOn},
  };
  return kTable;
}

}  // namespace calvin::check
