// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Bad input, the second half: caps, frames, events and metas, and what each element says to them.
#pragma once

#include "bad_settings.hpp"
#include "common/values.hpp"

namespace calvin::check {

inline constexpr char kPlain[] = "calibundistort";
inline constexpr char kUpstreamHelp[] = "Check the element upstream";
inline constexpr char kMetaHelp[] = "Check what writes the meta calvin-observation";
inline constexpr char kSenderHelp[] = "Whoever sends it must put the calibration there";

// The structure of one observation, with lists as GStreamer writes them.
inline std::string observation(std::string board, std::string ids, std::string uv,
                               std::string sigma) {
  g_autoptr(GstStructure) inner = gst_structure_from_string(
      ("observation, board=(string)" + board + ", found=(boolean)true, timestamp=(guint64)0, ids=" +
       ids + ", uv=" + uv + ", sigma=" + sigma)
          .c_str(),
      nullptr);
  g_autoptr(GstStructure) outer =
      gst_structure_new(gst::kObservationName, "camera", G_TYPE_STRING, "c", "width", G_TYPE_INT,
                        640, "height", G_TYPE_INT, 480, nullptr);
  GstStructure* const list[] = {gst_structure_copy(inner)};
  gst::take_structures(outer, "observations", list);
  g_autofree char* text = gst_structure_to_string(outer);
  return text;
}

inline std::string crowd(int count) {
  std::string ids = "<1";
  std::string uv = "<10.0,10.0";
  std::string sigma = "<0.1";
  for (int i = 1; i < count; ++i) {
    ids += ",1";
    uv += ",10.0,10.0";
    sigma += ",0.1";
  }
  return observation("checkerboard:9x6:25mm", ids + ">", uv + ">", sigma + ">");
}

// A text as the value of a field.
inline std::string quoted(const std::string& text) {
  GValue value = G_VALUE_INIT;
  g_value_init(&value, G_TYPE_STRING);
  g_value_set_string(&value, text.c_str());
  g_autofree char* quoted = gst_value_serialize(&value);
  g_value_unset(&value);
  return quoted;
}

inline const std::vector<BadInput>& bad_streams() {
  static const std::string kSized = ",width=640,height=480,framerate=30/1";
  static const std::string kBoard = "checkerboard:9x6:25mm";
  static const std::string kUv = "<10.0,10.0,20.0,10.0,30.0,10.0>";
  static const std::string kSigma = "<0.1,0.1,0.1>";
  static const std::vector<BadInput> kTable = {
      // Caps that are set: one element for each kind, and each element for some.
      {"a Bayer pattern", "calibdetect", caps, "video/x-bayer,format=bggr" + kSized,
       "video/x-bayer cannot be used here", "insert bayer2rgb", After::kStopped},
      {"a Bayer pattern to undistort", kBarrelled, caps, "video/x-bayer,format=bggr" + kSized,
       "video/x-bayer cannot be used here", "insert bayer2rgb", After::kStopped},
      {"JPEG pictures", "calibrate", caps, "image/jpeg" + kSized, "image/jpeg cannot be used here",
       "insert jpegdec", After::kStopped},
      {"H.264", kSolve, caps, "video/x-h264,stream-format=byte-stream,alignment=au" + kSized,
       "video/x-h264 cannot be used here", "insert decodebin", After::kStopped},
      {"GL memory", "caliboverlay", caps, "video/x-raw(memory:GLMemory),format=RGBA" + kSized,
       "Video in memory:GLMemory cannot be used here", "insert gldownload", After::kStopped},
      {"dmabuf memory", "calibdetect", caps, "video/x-raw(memory:DMABuf),format=NV12" + kSized,
       "Video in memory:DMABuf cannot be used here", "insert glupload ! gldownload",
       After::kStopped},
      {"a memory that nobody knows", kSolve, caps,
       "video/x-raw(memory:Punched),format=NV12" + kSized,
       "Video in memory:Punched cannot be used here", "insert an element that downloads",
       After::kStopped},
      {"a caps feature that nobody knows", kBarrelled, caps,
       "video/x-raw(meta:Punched),format=NV12" + kSized,
       "Video with the caps feature meta:Punched cannot be used here", "without meta:Punched",
       After::kStopped},
      {"a palette", kBarrelled, caps, "video/x-raw,format=RGB8P" + kSized,
       "the format RGB8P cannot be used here", "insert videoconvert", After::kStopped},
      {"a format that nobody knows", "calibdetect", caps, "video/x-raw,format=PUNCHED" + kSized,
       "unknown format 'PUNCHED'", "send video/x-raw in system memory", After::kStopped},
      {"sound", "calibdetect", caps, "audio/x-raw,format=S16LE,rate=48000,channels=2",
       "audio/x-raw cannot be used here", "send video/x-raw in system memory", After::kStopped},
      {"frames of 0x0", "calibdetect", caps,
       "video/x-raw,format=GRAY8,width=0,height=0,framerate=30/1", "Video of 0x0 px has no pixels",
       "with at least one pixel", After::kStopped},
      {"frames of a negative size", kBarrelled, caps,
       "video/x-raw,format=GRAY8,width=-640,height=480,framerate=30/1", "has no pixels",
       "with at least one pixel", After::kStopped},
      {"caps without a size", kSolve, caps, "video/x-raw,format=GRAY8,framerate=30/1",
       "caps name no width and no height", "complete the caps of the element upstream",
       After::kStopped},
      {"frames beyond all memory", "calibdetect", caps,
       "video/x-raw,format=RGB,width=2147483647,height=2147483647,framerate=30/1",
       "No memory can hold a frame", "insert videoscale", After::kStopped},
      {"frames beyond all memory to undistort", kBarrelled, caps,
       "video/x-raw,format=GRAY8,width=2147483647,height=2147483647,framerate=30/1",
       "No memory can hold a frame", "insert videoscale", After::kStopped},
      // GStreamer takes them and gets the length of the row wrong.
      {"a row beyond all memory", "calibdetect", caps,
       "video/x-raw,format=GRAY8,width=2147483647,height=1,framerate=30/1",
       "No memory can hold a frame", "insert videoscale", After::kStopped},
      {"a row beyond all memory to undistort", kBarrelled, caps,
       "video/x-raw,format=GRAY8,width=2147483647,height=1,framerate=30/1",
       "No memory can hold a frame", "insert videoscale", After::kStopped},
      {"a row beyond all memory to draw into", "caliboverlay", caps,
       "video/x-raw,format=GRAY8,width=2147483647,height=1,framerate=30/1",
       "No memory can hold a frame", "insert videoscale", After::kStopped},
      {"fields without their caps feature", "calibdetect", caps,
       "video/x-raw,format=GRAY8,interlace-mode=alternate" + kSized,
       "need the caps feature format:Interlaced", "interlace-mode=progressive", After::kStopped},
      {"fields for frames", kBarrelled, caps,
       "video/x-raw,format=GRAY8,interlace-mode=interleaved" + kSized, "The video is interlaced",
       "insert deinterlace", After::kGoesOn},
      {"a board in interlaced video", kDetect, caps,
       "video/x-raw,format=GRAY8,interlace-mode=interleaved" + kSized,
       "The video is interlaced, its fields", "Insert deinterlace", After::kGoesOn},
      {"frames of another shape than the calibration's", kBarrelled, caps,
       "video/x-raw,format=GRAY8,width=640,height=360,framerate=30/1", "another aspect",
       "Calibrate at that size", After::kGoesOn},

      {"frames of one column", "calibundistort calibration=fx=480,fy=478,cx=0,cy=236,k1=-0.28",
       caps, "video/x-raw,format=GRAY8,width=1,height=480,framerate=30/1",
       "Frames of 1x480 px are too small to be undistorted", "at least two columns and two rows",
       After::kGoesOn},
      {"frames of one pixel to be larger ones", kPlain, caps_for_vga,
       "video/x-raw,format=GRAY8,width=1,height=1,framerate=30/1",
       "Frames of 1x1 px cannot be made into frames of 640x480", "Insert videoscale",
       After::kStopped},

      // Caps that are all that upstream can offer: a source would only say "not-negotiated".
      {"a camera with nothing but a Bayer pattern", "calibrate", offer,
       "video/x-bayer,format=bggr;video/x-bayer,format=rggb", "video/x-bayer cannot be used here",
       "insert bayer2rgb", After::kStopped},
      {"a camera with nothing but JPEG pictures", kBarrelled, offer, "image/jpeg,width=[1,4096]",
       "image/jpeg cannot be used here", "insert jpegdec", After::kStopped},

      // What is asked of the source.
      {"a source asked for a palette", "calibtestsrc", asked_for, "video/x-raw,format=RGB8P",
       "Downstream takes no video that calibtestsrc makes", "insert videoconvert", After::kStopped},
      {"a source asked for a size beyond its own", "calibtestsrc", asked_for,
       "video/x-raw,width=100000", "16x16 to 8192x8192", "videoscale", After::kStopped},
      {"a source asked for still pictures", "calibtestsrc", asked_for, "video/x-raw,framerate=0/1",
       "up to 240 frames per second", "videorate", After::kStopped},
      {"a source asked for another aspect than its camera's",
       "calibtestsrc calibration=fx=500,fy=500,cx=320,cy=240,width=640,height=480", asked_for,
       "video/x-raw,width=640,height=360", "the aspect differs", "Ask for 640x480",
       After::kStopped},
      {"ground truth into a folder that is not there", "calibtestsrc ground-truth=/nowhere/t.json",
       asked_for, "video/x-raw,width=64,height=48", "Cannot write '/nowhere/t.json'", kPlaceHelp,
       After::kStopped},
      {"another board while the source runs", "calibtestsrc", asked_for_while_running,
       "board=checkerboard:5x4:10mm", "'board' cannot change", kNextStart, After::kGoesOn},

      // Frames that are not what the caps say.
      {"a frame of half its size", kDetect, small_frame, "153600", "A frame has 153600 bytes",
       kUpstreamHelp, After::kGoesOn},
      {"an empty frame", kDetect, small_frame, "0", "A frame has 0 bytes", kUpstreamHelp,
       After::kGoesOn},
      {"a frame that lacks a byte, to undistort", kBarrelled, small_frame, "307199",
       "A frame has 307199 bytes, but GRAY8 of 640x480 px needs 307200", kUpstreamHelp,
       After::kDropped},
      {"a frame of half its size to draw on", "caliboverlay", small_frame, "153600",
       "A frame has 153600 bytes", kUpstreamHelp, After::kGoesOn, Needs::kDrawing},
      {"a GstVideoMeta of another size", kDetect, frame_of_other_size, "",
       "A frame is GRAY8 of 320x240 px", kUpstreamHelp, After::kGoesOn},
      {"a GstVideoMeta of another size, to undistort", kBarrelled, frame_of_other_size, "",
       "A frame is GRAY8 of 320x240 px, but GRAY8 of 640x480 was negotiated", kUpstreamHelp,
       After::kDropped},
      {"a GstVideoMeta of no format", kDetect, frame_of_no_format, "0",
       "A frame is UNKNOWN of 640x480 px", kUpstreamHelp, After::kGoesOn},
      {"a GstVideoMeta of no format, to undistort", kBarrelled, frame_of_no_format, "9999",
       "A frame is UNKNOWN of 640x480 px", kUpstreamHelp, After::kDropped},
      {"a GstVideoMeta of no planes", kDetect, frame_without_planes, "", "tells of 0 planes",
       kUpstreamHelp, After::kGoesOn},
      {"a GstVideoMeta of no planes, to undistort", kBarrelled, frame_without_planes, "",
       "tells of 0 planes", kUpstreamHelp, After::kDropped},
      {"a GstVideoMeta of no planes, to draw on", "caliboverlay", frame_without_planes, "",
       "tells of 0 planes", kUpstreamHelp, After::kGoesOn, Needs::kDrawing},
      {"a GstVideoMeta without a way to map", kDetect, frame_without_map, "",
       "does not tell how to map it", kUpstreamHelp, After::kGoesOn},
      {"a GstVideoMeta without a way to map, to undistort", kBarrelled, frame_without_map, "",
       "does not tell how to map it", kUpstreamHelp, After::kDropped},
      {"a GstVideoMeta without a way to map, to draw on", "caliboverlay", frame_without_map, "",
       "does not tell how to map it", kUpstreamHelp, After::kGoesOn, Needs::kDrawing},
      {"a GstVideoMeta without a way to unmap", kDetect, frame_without_unmap, "",
       "does not tell how to map it", kUpstreamHelp, After::kGoesOn},
      {"memory that gives no access", kDetect, frame_without_access, "",
       "The memory of a frame cannot be read", "io-mode=mmap", After::kGoesOn},
      {"memory that gives no access, to undistort", kBarrelled, frame_without_access, "",
       "The memory of a frame cannot be read", "io-mode=mmap", After::kDropped},
      {"memory that gives access every other time", kDetect, frames_of_fickle_memory, "",
       "The memory of a frame cannot be read", "io-mode=mmap", After::kGoesOn},
      {"memory that gives access every other time, to undistort", kBarrelled,
       frames_of_fickle_memory, "", "The memory of a frame cannot be read", "io-mode=mmap",
       After::kDropped},
      {"memory that gives access every other time, to draw on", "caliboverlay",
       frames_of_fickle_memory, "", "The memory of a frame cannot be read", "io-mode=mmap",
       After::kGoesOn, Needs::kDrawing},
      {"memory that gives no access to write into", kBarrelled, room_in_fickle_memory, "",
       "cannot be written", "identity drop-allocation=true", After::kStopped},
      {"rows that reach beyond the memory", kDetect, frame_beyond_memory, "",
       "reach beyond its memory", kUpstreamHelp, After::kGoesOn},
      {"rows that reach beyond the memory, to undistort", kBarrelled, frame_beyond_memory, "",
       "reach beyond its memory", kUpstreamHelp, After::kDropped},
      {"rows that reach beyond the memory, to draw on", "caliboverlay", frame_beyond_memory, "",
       "reach beyond its memory", kUpstreamHelp, After::kGoesOn, Needs::kDrawing},
      {"a frame before its caps", kDetect, frame_before_caps, "", "A frame came before the caps",
       "set the caps upstream", After::kStopped},

      // Calibration events.
      {"a calibration event without a calibration", kPlain, sticky_event,
       "calvin-calibration, camera=(string)left;", "has no text in its field 'json'", kSenderHelp,
       After::kGoesOn},
      {"a calibration event with a number", kPlain, sticky_event,
       "calvin-calibration, json=(int)3;", "has no text in its field 'json'", kSenderHelp,
       After::kGoesOn},
      {"a calibration event with garbage", kPlain, sticky_event,
       "calvin-calibration, json=(string)\"{garbage\";", "in line", kFileHelp, After::kGoesOn},
      {"a calibration event for another aspect", kPlain, sticky_event,
       "calvin-calibration, json=(string)" + quoted(native("[640, 480]", "[640, 360]")) + ";",
       "another aspect", "Calibrate at that size", After::kGoesOn},
      {"the peer's event with garbage", kPlain, peers_event,
       "GstEventCalibrated, undistort-settings=(string)\"hello\";", "cannot be used", kFileHelp,
       After::kGoesOn},
      {"the peer's event without its settings", kPlain, peers_event, "GstEventCalibrated;",
       "has no text in its field 'undistort-settings'", kSenderHelp, After::kGoesOn},
      {"the peer's event with garbage from behind", kPlain, peers_event_from_behind,
       "GstEventCalibrated, undistort-settings=(string)\"<hello\";", "cannot be used", kFileHelp,
       After::kGoesOn},

      // Observations that others wrote.
      {"an observation of an unknown board", kSolve, meta,
       observation("nonsense", "<1,2,3>", kUv, kSigma), "no kind of board called 'nonsense'",
       kMetaHelp, After::kGoesOn},
      {"more ids than corners", kSolve, meta, observation(kBoard, "<1,2,3,4>", kUv, kSigma),
       "4 ids, 3 sigmas and 6 coordinates", kMetaHelp, After::kGoesOn},
      {"a corner without its row", kSolve, meta,
       observation(kBoard, "<1,2>", "<1.0,2.0,3.0>", "<0.1,0.1>"),
       "2 ids, 2 sigmas and 3 coordinates", kMetaHelp, After::kGoesOn},
      {"coordinates in words", kSolve, meta,
       observation(kBoard, "<1,2,3>", "<\"here\",\"there\",\"up\",\"down\",\"left\",\"right\">",
                   kSigma),
       "3 ids, 3 sigmas and 0 coordinates", kMetaHelp, After::kGoesOn},
      {"a corner nowhere", kSolve, meta,
       observation(kBoard, "<1,2,3>", "<(double)nan,10.0,20.0,10.0,30.0,10.0>", kSigma),
       "outside the image", kMetaHelp, After::kGoesOn},
      {"a corner far outside the picture", kSolve, meta,
       observation(kBoard, "<1,2,3>", "<1e9,10.0,20.0,10.0,30.0,10.0>", kSigma),
       "outside the image", kMetaHelp, After::kGoesOn},
      {"a corner that the board does not have", kSolve, meta,
       observation(kBoard, "<1,2,1000>", kUv, kSigma), "The corner id 1000 is not on the board",
       kMetaHelp, After::kGoesOn},
      {"a negative corner id", kSolve, meta, observation(kBoard, "<-1,2,3>", kUv, kSigma),
       "The corner id -1 is not on the board", kMetaHelp, After::kGoesOn},
      {"one corner twice", kSolve, meta, observation(kBoard, "<2,2,3>", kUv, kSigma),
       "The corner id 2 is given twice", kMetaHelp, After::kGoesOn},
      {"a negative sigma", kSolve, meta, observation(kBoard, "<1,2,3>", kUv, "<0.1,-0.1,0.1>"),
       "a sigma is negative", kMetaHelp, After::kGoesOn},
      {"a hundred thousand corners", kSolve, meta, crowd(100000), "given twice", kMetaHelp,
       After::kGoesOn},
      {"an observation meta with nothing in it", kSolve, meta,
       "calvin-observation, width=(int)640;", "'observations' is no array", kMetaHelp,
       After::kGoesOn},
      {"an observation event with a number for its list", kSolve, event,
       "calvin-observation, observations=(int)5;", "'observations' is no array", kMetaHelp,
       After::kGoesOn},
      {"an observation event of an unknown board", kSolve, event,
       observation("9x6", "<1,2,3>", kUv, kSigma), "no kind of board called '9x6'", kMetaHelp,
       After::kGoesOn},
  };
  return kTable;
}

}  // namespace calvin::check
