// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Tells the thread sanitizer of GLib's mutexes and of how GStreamer hands buffers on. GLib makes
// the first of futexes and is not instrumented: without this, two threads that GST_OBJECT_LOCK or a
// queue keeps apart look like a race. A pool hands a buffer from the thread that was done with it
// to the one that fills it anew through an atomic queue, a harness through a queue of its own, and
// memory is written to by whoever has its last reference, which a counter tells. Linked into the
// tests, these functions stand before the libraries' own for everybody but those themselves.

#include <dlfcn.h>

#include <gst/check/gstharness.h>
#include <gst/gst.h>
#include <gst/video/video.h>

extern "C" void __tsan_acquire(void* address);
extern "C" void __tsan_release(void* address);

namespace {

// Of all that was let go of: which references a memory had is known to GStreamer alone.
char let_go;

// Links with libgstvideo whoever needs nothing of it: only what a program is linked with do its own
// functions stand before.
[[maybe_unused]] auto* volatile in_libgstvideo = &gst_video_info_init;

template <typename F>
F* next(const char* name) {
  return reinterpret_cast<F*>(dlsym(RTLD_NEXT, name));
}

}  // namespace

extern "C" {

void g_mutex_lock(GMutex* mutex) {
  static auto* const kReal = next<void(GMutex*)>("g_mutex_lock");
  kReal(mutex);
  __tsan_acquire(mutex);
}

gboolean g_mutex_trylock(GMutex* mutex) {
  static auto* const kReal = next<gboolean(GMutex*)>("g_mutex_trylock");
  if (kReal(mutex) == FALSE) return FALSE;
  __tsan_acquire(mutex);
  return TRUE;
}

void g_mutex_unlock(GMutex* mutex) {
  static auto* const kReal = next<void(GMutex*)>("g_mutex_unlock");
  __tsan_release(mutex);
  kReal(mutex);
}

void g_cond_wait(GCond* condition, GMutex* mutex) {
  static auto* const kReal = next<void(GCond*, GMutex*)>("g_cond_wait");
  __tsan_release(mutex);
  kReal(condition, mutex);
  __tsan_acquire(mutex);
}

gboolean g_cond_wait_until(GCond* condition, GMutex* mutex, gint64 end_time) {
  static auto* const kReal = next<gboolean(GCond*, GMutex*, gint64)>("g_cond_wait_until");
  __tsan_release(mutex);
  const gboolean in_time = kReal(condition, mutex, end_time);
  __tsan_acquire(mutex);
  return in_time;
}

void gst_mini_object_unref(GstMiniObject* object) {
  static auto* const kReal = next<void(GstMiniObject*)>("gst_mini_object_unref");
  __tsan_release(object);
  __tsan_release(&let_go);
  kReal(object);
}

gboolean gst_video_frame_map(GstVideoFrame* frame, const GstVideoInfo* info, GstBuffer* buffer,
                             GstMapFlags flags) {
  static auto* const kReal =
      next<gboolean(GstVideoFrame*, const GstVideoInfo*, GstBuffer*, GstMapFlags)>(
          "gst_video_frame_map");
  const gboolean mapped = kReal(frame, info, buffer, flags);
  if (mapped != FALSE && (flags & GST_MAP_WRITE) != 0) __tsan_acquire(&let_go);
  return mapped;
}

GstFlowReturn gst_pad_push(GstPad* pad, GstBuffer* buffer) {
  static auto* const kReal = next<GstFlowReturn(GstPad*, GstBuffer*)>("gst_pad_push");
  __tsan_release(buffer);
  return kReal(pad, buffer);
}

GstBuffer* gst_harness_pull(GstHarness* h) {
  static auto* const kReal = next<GstBuffer*(GstHarness*)>("gst_harness_pull");
  GstBuffer* buffer = kReal(h);
  if (buffer != nullptr) __tsan_acquire(buffer);
  return buffer;
}

// Whoever frees an object knows what all did who have let go of it before.
void g_object_unref(gpointer object) {
  static auto* const kReal = next<void(gpointer)>("g_object_unref");
  __tsan_release(object);
  __tsan_acquire(object);
  kReal(object);
}

GstFlowReturn gst_buffer_pool_acquire_buffer(GstBufferPool* pool, GstBuffer** buffer,
                                             GstBufferPoolAcquireParams* params) {
  static auto* const kReal =
      next<GstFlowReturn(GstBufferPool*, GstBuffer**, GstBufferPoolAcquireParams*)>(
          "gst_buffer_pool_acquire_buffer");
  const GstFlowReturn result = kReal(pool, buffer, params);
  if (result == GST_FLOW_OK) __tsan_acquire(*buffer);
  return result;
}

}  // extern "C"
