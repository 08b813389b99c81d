// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Programs that end, or fork, while elements are at work: they end with the status that they give.

#include <execinfo.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <functional>
#include <mutex>

#include "gate.hpp"
#include "support.hpp"

#include <gst/check/gstcheck.h>

using namespace calvin;

// ---- Programs that must end with 7 --------------------------------------------------------------

// Several solves and many detections, on their workers.
static GstElement* calibrating() {
  return gst_parse_launch(
      "calibtestsrc num-buffers=40 ! calibrate name=c post-messages=true ! fakesink sync=false",
      nullptr);
}

static void play(GstElement* pipeline) {
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  g_autoptr(GstBus) bus = gst_element_get_bus(pipeline);
  GstMessage* end = gst_bus_timed_pop_filtered(
      bus, 60 * GST_SECOND, static_cast<GstMessageType>(GST_MESSAGE_EOS | GST_MESSAGE_ERROR));
  gst_clear_message(&end);
}

// Calls f at the n-th notify::calibration, on the worker.
static void at_notify(GstElement* pipeline, int n, void (*f)()) {
  static int left;
  static void (*call)();
  left = n;
  call = f;
  GstElement* c = gst_bin_get_by_name(GST_BIN(pipeline), "c");
  g_signal_connect(c, "notify::calibration", G_CALLBACK(+[](GObject*, GParamSpec*, gpointer) {
                     if (--left == 0) call();
                   }),
                   nullptr);
}

// Ends with the status of a child that does this.
static void as_child(const std::function<void()>& program) {
  const pid_t child = fork();
  if (child == 0) {
    alarm(60);
    program();
  }
  int status = -1;
  waitpid(child, &status, 0);
  _exit(WIFEXITED(status) ? WEXITSTATUS(status) : 100 + WTERMSIG(status));
}

static void end() { exit(7); }
static void end_as_child() { as_child(end); }

static void end_in_handler(int n) {
  GstElement* pipeline = calibrating();
  at_notify(pipeline, n, end);
  play(pipeline);
}

static void end_at_message(const char* name) {
  static int left = 3;
  GstElement* pipeline = calibrating();
  g_autoptr(GstBus) bus = gst_element_get_bus(pipeline);
  gst_bus_set_sync_handler(
      bus,
      [](GstBus*, GstMessage* message, gpointer wanted) {
        const GstStructure* s = gst_message_get_structure(message);
        const bool found =
            s != nullptr && gst_structure_has_name(s, static_cast<const char*>(wanted));
        if (found && --left == 0) end();
        return GST_BUS_PASS;
      },
      const_cast<char*>(name), nullptr);
  play(pipeline);
}

// The child has none of the threads that the elements of its parent have.
static void free_in_a_child(const char* factory) {
  GstElement* element = check::make_element(factory);
  gst_object_ref_sink(element);
  gst_element_set_state(element, GST_STATE_PAUSED);
  g_usleep(200000);  // until they wait
  as_child([&] {
    gst_element_set_state(element, GST_STATE_NULL);
    gst_element_set_state(element, GST_STATE_PAUSED);
    gst_element_set_state(element, GST_STATE_NULL);
    gst_object_unref(element);
    end();
  });
}

// A frame in the parent, whose threads share the rows of it, and one in the child.
static void undistort_in_a_child() {
  GstHarness* h = check::harness_of(check::make_element(
      "calibundistort n-threads=4 calibration=fx=480,fy=478,cx=322,cy=236,k1=-0.28"));
  gst_harness_set_src_caps(h, check::caps_of("GRAY8", {640, 480}));
  const auto push = [h](int n) {
    GstBuffer* buffer = gst_buffer_new_allocate(nullptr, 640 * 480, nullptr);
    gst_buffer_memset(buffer, 0, 0x80, 640 * 480);
    GST_BUFFER_PTS(buffer) = static_cast<guint64>(n) * GST_SECOND / 30;
    gst_buffer_unref(gst_harness_push_and_pull(h, buffer));
  };
  push(0);
  as_child([&] {
    for (int n = 1; n < 4; ++n) push(n);
    gst_harness_teardown(h);
    end();
  });
}

// Never freed: at the end of a forked child somebody seems to wait at it still.
static check::Gate& in_handler = *new check::Gate;
static std::mutex application;

// The handler waits for a lock of whoever ends the program.
static void end_while_a_handler_waits() {
  GstElement* pipeline = calibrating();
  at_notify(pipeline, 2, [] {
    in_handler.pass();
    const std::lock_guard guard(application);
  });
  in_handler.close();
  const std::lock_guard guard(application);
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  if (!in_handler.reached()) return;
  in_handler.open();
  end();
}

static const struct {
  const char* name;
  void (*run)();
} kPrograms[] = {
    {"exit in the first notify", [] { end_in_handler(1); }},
    {"exit in a later notify", [] { end_in_handler(3); }},
    {"exit at a result", [] { end_at_message("calib-result"); }},
    {"exit at a detection", [] { end_at_message("calib-detection"); }},
    {"exit while a handler waits", end_while_a_handler_waits},
    {"exit while a camera is watched",
     [] {
       GstElement* pipeline = gst_parse_launch(
           "calibtestsrc is-live=true ! calibsolve device=/dev/null ! fakesink", nullptr);
       gst_element_set_state(pipeline, GST_STATE_PLAYING);
       g_autoptr(GstBus) bus = gst_element_get_bus(pipeline);
       // That the lens cannot be read: all threads are at work.
       GstMessage* told = gst_bus_timed_pop_filtered(bus, 60 * GST_SECOND, GST_MESSAGE_WARNING);
       if (told != nullptr) end();
     }},
    {"exit of a child",
     [] {
       play(calibrating());
       end_as_child();
     }},
    {"exit of a grandchild",
     [] {
       play(calibrating());
       as_child(end_as_child);
     }},
    {"exit of a child while its parent solves",
     [] {
       GstElement* pipeline = calibrating();
       at_notify(pipeline, 2, [] { in_handler.pass(); });
       in_handler.close();
       gst_element_set_state(pipeline, GST_STATE_PLAYING);
       if (in_handler.reached()) end_as_child();
     }},
    {"exit of a child of a handler",
     [] {
       GstElement* pipeline = calibrating();
       at_notify(pipeline, 3, end_as_child);
       play(pipeline);
     }},
    {"a child frees a calibdetect", [] { free_in_a_child("calibdetect"); }},
    {"a child frees a calibsolve", [] { free_in_a_child("calibsolve"); }},
    {"a child frees a calibsolve that reads a lens",
     [] { free_in_a_child("calibsolve device=/dev/null"); }},
    {"a child frees a calibrate", [] { free_in_a_child("calibrate"); }},
    {"a child frees a calibundistort", [] { free_in_a_child("calibundistort"); }},
    {"a child undistorts", undistort_in_a_child},
    {"a child calibrates",
     [] {
       GstElement* element = check::make_element("calibsolve");
       gst_element_set_state(element, GST_STATE_PAUSED);
       gst_element_set_state(element, GST_STATE_NULL);
       as_child([] {
         play(calibrating());
         end();
       });
     }},
};

// ---- Tests --------------------------------------------------------------------------------------

// As programs of their own: GstCheck has its own end of a program.
GST_START_TEST(test_it_ends_with_its_status) {
  const char* name = kPrograms[__i__].name;
  const char* const arguments[] = {"/proc/self/exe", name, nullptr};
  int status = -1;
  g_autofree char* told = nullptr;
  fail_unless(g_spawn_sync(nullptr, const_cast<char**>(arguments), nullptr, G_SPAWN_DEFAULT,
                           nullptr, nullptr, nullptr, &told, &status, nullptr));
  fail_if(WIFSIGNALED(status), "%s: signal %d\n%s", name, WTERMSIG(status), told);
  fail_unless(WEXITSTATUS(status) == 7, "%s: status %d", name, WEXITSTATUS(status));
}
GST_END_TEST;

static Suite* exit_suite() {
  Suite* suite = suite_create("exit");
  TCase* tc = tcase_create("general");
  suite_add_tcase(suite, tc);
  tcase_add_loop_test(tc, test_it_ends_with_its_status, 0, G_N_ELEMENTS(kPrograms));
  return suite;
}

// Where a program crashed, before it ends by that signal.
static void tell_where(int signal) {
  void* frames[64];
  backtrace_symbols_fd(frames, backtrace(frames, G_N_ELEMENTS(frames)), STDERR_FILENO);
  raise(signal);
}

int main(int argc, char** argv) {
  for (const auto& program : kPrograms) {
    if (argc < 2 || g_strcmp0(argv[1], program.name) != 0) continue;
    alarm(60);
    gst_init(&argc, &argv);
    struct sigaction action = {};
    action.sa_handler = tell_where;
    action.sa_flags = static_cast<int>(SA_RESETHAND | SA_NODEFER);
    sigaction(SIGSEGV, &action, nullptr);
    sigaction(SIGABRT, &action, nullptr);
    program.run();
    sleep(5);  // another thread may be ending the program
    _exit(99);
  }
  gst_check_init(&argc, &argv);
  return gst_check_run_suite(exit_suite(), "exit", __FILE__);
}
