// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calvin-calibrate-images [--board TEXT] [--model NAME] [--output DIR] FOLDER: calibrates a camera
// from a folder of pictures of any format that GStreamer decodes, and undistorts the first of them.
// A DIR that is not there is made.
//
// The pictures go through one pipeline, one after the other:
//   filesrc ! decodebin ! videoconvert ! concat ! calibrate ! fakesink
#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <system_error>
#include <vector>

#include <fmt/format.h>
#include <gst/gst.h>
#include <gst/pbutils/pbutils.h>

#include "calvin/core/file.hpp"
#include "calvin/core/image.hpp"

namespace fs = std::filesystem;

namespace {

struct Options {
  std::string board = "checkerboard:9x6:25mm";
  std::string model = "brown5";
  fs::path output = ".";
  fs::path folder;
};

struct Picture {
  fs::path path;
  calvin::ImageSize size;
};

// Before the work: whether there is a folder that the files can go to. One level of it is made.
bool prepare(const fs::path& output) {
  std::error_code error;
  fs::create_directory(output, error);
  if (!error) {
    const calvin::Status writable = calvin::check_writable((output / "camera.json").string());
    if (!writable) fmt::print(stderr, "{}\n", writable.error().message);
    return writable.has_value();
  }
  fmt::print(stderr,
             "There is no folder {}, and it cannot be made: {}. Give --output a folder that is "
             "there, or a new one in such a folder.\n",
             output.string(), error.message());
  return false;
}

// The pictures of a folder, by name, with their sizes.
struct Folder {
  std::vector<Picture> pictures;
  std::size_t files = 0;  // those that are no pictures too
};

void leave_out(const fs::path& file, const std::string& why) {
  fmt::print(stderr, "{}: left out, {}\n", file.filename().string(), why);
}

// The size of a picture that GStreamer decodes to its end, or why there is none and what to do.
std::optional<calvin::ImageSize> size_of(GstDiscoverer* discoverer, const fs::path& file,
                                         std::string& why) {
  std::error_code ignored;
  const fs::file_status status = fs::status(file, ignored);
  if (fs::exists(status) && !fs::is_regular_file(status)) {  // a FIFO may never be written
    why = "it is a device or a FIFO: take it away.";
    return std::nullopt;
  }
  if (const std::ifstream stream(file); !stream) {
    why = fmt::format("it cannot be opened ({}): make it readable, or take it away.",
                      std::generic_category().message(errno));
    return std::nullopt;
  }
  g_autofree char* uri = gst_filename_to_uri(file.c_str(), nullptr);
  g_autoptr(GError) error = nullptr;
  g_autoptr(GstDiscovererInfo) info = gst_discoverer_discover_uri(discoverer, uri, &error);
  const bool whole = info != nullptr && gst_discoverer_info_get_result(info) == GST_DISCOVERER_OK;
  GList* streams = whole ? gst_discoverer_info_get_video_streams(info) : nullptr;
  std::optional<calvin::ImageSize> size;
  if (streams != nullptr) {
    const auto* video = GST_DISCOVERER_VIDEO_INFO(streams->data);
    size = {static_cast<int>(gst_discoverer_video_info_get_width(video)),
            static_cast<int>(gst_discoverer_video_info_get_height(video))};
  }
  gst_discoverer_stream_info_list_free(streams);
  if (size && (size->width < 1 || size->height < 1)) size.reset();  // it ended in its header
  why = fmt::format("it cannot be decoded ({}): save it again as PNG or JPEG, or take it away.",
                    error != nullptr ? error->message : "there is no picture in it");
  return size;
}

// Names every file that it leaves out.
Folder find_pictures(const fs::path& path) {
  Folder folder;
  std::vector<fs::path> files;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(path, error)) {
    std::error_code ignored;  // a link that leads nowhere is no folder
    if (!entry.is_directory(ignored)) files.push_back(fs::absolute(entry.path()));
  }
  if (error) fmt::print(stderr, "{}: {}\n", path.string(), error.message());
  std::sort(files.begin(), files.end());
  folder.files = files.size();
  g_autoptr(GstDiscoverer) discoverer = gst_discoverer_new(10 * GST_SECOND, nullptr);
  for (const fs::path& file : files) {
    std::string why;
    if (const auto size = size_of(discoverer, file, why)) {
      folder.pictures.push_back({file, *size});
    } else {
      leave_out(file, why);
    }
  }
  return folder;
}

// One camera has one picture size: keeps the most frequent one and names the rest.
void keep_one_size(std::vector<Picture>& pictures) {
  std::map<std::pair<int, int>, int> count;
  for (const Picture& p : pictures) ++count[{p.size.width, p.size.height}];
  const auto most = std::max_element(
      count.begin(), count.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  std::erase_if(pictures, [&](const Picture& p) {
    const bool other = std::pair(p.size.width, p.size.height) != most->first;
    if (other) {
      leave_out(p.path,
                fmt::format("it is {}x{} and most are {}x{}: a camera is calibrated at one "
                            "size, put it into a folder of its own.",
                            p.size.width, p.size.height, most->first.first, most->first.second));
    }
    return other;
  });
}

void link_decoded(GstElement* /*decodebin*/, GstPad* pad, gpointer sink) {
  if (!gst_pad_is_linked(GST_PAD(sink))) gst_pad_link(pad, GST_PAD(sink));
}

// Adds filesrc ! decodebin ! videoconvert for one picture in front of the concat.
void add_picture(GstBin* bin, GstElement* concat, const Picture& picture) {
  GstElement* source = gst_element_factory_make("filesrc", nullptr);
  GstElement* decoder = gst_element_factory_make("decodebin", nullptr);
  GstElement* convert = gst_element_factory_make("videoconvert", nullptr);
  g_object_set(source, "location", picture.path.c_str(), nullptr);
  gst_bin_add_many(bin, source, decoder, convert, nullptr);
  gst_element_link(source, decoder);
  gst_element_link(convert, concat);
  g_autoptr(GstPad) sink = gst_element_get_static_pad(convert, "sink");
  g_signal_connect_object(decoder, "pad-added", G_CALLBACK(link_decoded), sink, G_CONNECT_DEFAULT);
}

GstElement* make_pipeline(const Options& options, const std::vector<Picture>& pictures) {
  const std::string location = (options.output / "camera.json").string();
  GstElement* pipeline = gst_pipeline_new(nullptr);
  GstElement* concat = gst_element_factory_make("concat", nullptr);
  GstElement* filter = gst_element_factory_make("capsfilter", nullptr);
  GstElement* calibrate = gst_element_factory_make("calibrate", nullptr);
  GstElement* sink = gst_element_factory_make("fakesink", nullptr);
  if (concat == nullptr || calibrate == nullptr) {
    fmt::print(stderr, "the element {} is missing: is GST_PLUGIN_PATH set?\n",
               concat == nullptr ? "concat" : "calibrate");
    return nullptr;
  }
  g_autoptr(GstCaps) gray = gst_caps_from_string("video/x-raw,format=GRAY8");
  g_object_set(filter, "caps", gray, nullptr);
  g_object_set(calibrate, "board", options.board.c_str(), "model", options.model.c_str(),
               "location", location.c_str(), "overlay", FALSE, "post-messages", TRUE, nullptr);
  // Pictures wait for the detector, and every board counts.
  gst_util_set_object_arg(G_OBJECT(calibrate), "mode", "sync");
  gst_util_set_object_arg(G_OBJECT(calibrate), "capture-mode", "all");
  gst_bin_add_many(GST_BIN(pipeline), concat, filter, calibrate, sink, nullptr);
  gst_element_link_many(concat, filter, calibrate, sink, nullptr);
  for (const Picture& picture : pictures) add_picture(GST_BIN(pipeline), concat, picture);
  return pipeline;
}

// Prints what the elements say until the end; in how many pictures a board was found, nothing where
// it ended badly. The first message of each picture has the index 0, those of other boards follow.
std::optional<std::size_t> run(GstElement* pipeline, const std::vector<Picture>& pictures) {
  g_autoptr(GstBus) bus = gst_element_get_bus(pipeline);
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  std::size_t looks = 0;
  std::set<std::size_t> found;
  bool good = false;
  for (bool done = false; !done;) {
    g_autoptr(GstMessage) message = gst_bus_timed_pop(bus, GST_CLOCK_TIME_NONE);
    const GstStructure* s = gst_message_get_structure(message);
    if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_ELEMENT &&
        gst_structure_has_name(s, "calib-detection")) {
      int index = 0;
      gst_structure_get_int(s, "index", &index);
      looks += index == 0 ? 1 : 0;
      if (looks == 0 || looks > pictures.size()) continue;
      const std::size_t picture = looks - 1;
      int points = 0;
      gst_structure_get_int(s, "points", &points);
      if (points > 0) found.insert(picture);
      fmt::print("{}: {} corners ({})\n", pictures[picture].path.filename().string(), points,
                 gst_structure_get_string(s, "reason"));
    } else if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_ERROR) {
      g_autoptr(GError) error = nullptr;
      gst_message_parse_error(message, &error, nullptr);
      fmt::print(stderr, "{}\n", error->message);
      done = true;
    } else if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_EOS) {
      good = done = true;
    }
  }
  gst_element_set_state(pipeline, GST_STATE_NULL);
  if (!good) return std::nullopt;
  return found.size();
}

// The first picture as it is and undistorted, as PNG.
bool draw_pair(const Options& options, const Picture& picture) {
  for (const bool undistort : {false, true}) {
    const std::string element = undistort ? fmt::format("! calibundistort calibration=\"{}\" ",
                                                        (options.output / "camera.json").string())
                                          : "";
    const std::string name = undistort ? "after.png" : "before.png";
    const std::string text = fmt::format(
        "filesrc location=\"{}\" ! decodebin ! videoconvert ! video/x-raw,format=GRAY8 {}! "
        "videoconvert ! pngenc ! filesink location=\"{}\"",
        picture.path.string(), element, (options.output / name).string());
    g_autoptr(GstElement) pipeline = gst_parse_launch(text.c_str(), nullptr);
    if (pipeline == nullptr || !run(pipeline, {})) return false;
  }
  return true;
}

bool parse(int argc, char** argv, Options& options) {
  g_autofree char* board = nullptr;
  g_autofree char* model = nullptr;
  g_autofree char* output = nullptr;
  const GOptionEntry entries[] = {
      {"board", 0, 0, G_OPTION_ARG_STRING, &board, "The board in the pictures", "TEXT"},
      {"model", 0, 0, G_OPTION_ARG_STRING, &model, "The camera model", "NAME"},
      {"output", 0, 0, G_OPTION_ARG_FILENAME, &output, "Where the files go; made if need be",
       "DIR"},
      {nullptr, 0, 0, G_OPTION_ARG_NONE, nullptr, nullptr, nullptr}};
  g_autoptr(GOptionContext) context = g_option_context_new("FOLDER");
  g_autoptr(GError) error = nullptr;
  g_option_context_add_main_entries(context, entries, nullptr);
  g_option_context_add_group(context, gst_init_get_option_group());
  if (!g_option_context_parse(context, &argc, &argv, &error) || argc != 2) {
    g_autofree char* help = g_option_context_get_help(context, TRUE, nullptr);
    fmt::print(stderr, "{}{}", error != nullptr ? std::string(error->message) + "\n" : "", help);
    return false;
  }
  if (board != nullptr) options.board = board;
  if (model != nullptr) options.model = model;
  if (output != nullptr) options.output = output;
  options.folder = argv[1];
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  if (!parse(argc, argv, options)) return 2;
  if (!prepare(options.output)) return 1;
  auto [pictures, files] = find_pictures(options.folder);
  if (pictures.empty()) {
    fmt::print(stderr, "There is no picture in {} that GStreamer can decode.\n",
               options.folder.string());
    return 1;
  }
  keep_one_size(pictures);
  GstElement* pipeline = make_pipeline(options, pictures);
  if (pipeline == nullptr) return 1;
  const auto found = run(pipeline, pictures);
  gst_object_unref(pipeline);
  if (found) {
    fmt::print("{} of {} pictures used: {} left out, {} without a board\n", *found, files,
               files - pictures.size(), pictures.size() - *found);
  }
  if (!found || !draw_pair(options, pictures.front())) return 1;
  fmt::print("camera.json, before.png and after.png are in {}\n", options.output.string());
  return 0;
}
