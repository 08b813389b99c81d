// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The pipelines of the random walk, and how one of their elements is replaced while they run.
#pragma once

#include <algorithm>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "walk_ledger.hpp"

namespace calvin::check {

// Named src: the source; caps: a capsfilter behind it, which lets frames of the former caps pass;
// sink, sink1: the ends; every FILE: one file for the calibration.
// Behind a tee the sinks do not wait for each other: a query of the source can wait in one branch
// for its sink to go on, which waits for the other to preroll, and that for the source.
struct Shape {
  const char* name;
  bool live;
  const char* launch;
};

inline constexpr Shape kShapes[] = {
    {"file", false,
     "calibtestsrc name=src board=checkerboard:5x4:40mm ! capsfilter name=caps "
     "caps-change-mode=delayed ! "
     "calibrate board=checkerboard:5x4:40mm max-views=15 location=FILE ! "
     "calibundistort qos=false ! fakesink name=sink"},
    {"camera", true,
     "calibtestsrc name=src is-live=true motion=hand board=checkerboard:5x4:40mm ! "
     "capsfilter name=caps caps-change-mode=delayed ! calibrate board=checkerboard:5x4:40mm ! "
     "calibundistort qos=false calibration=FILE ! fakesink name=sink sync=true"},
    {"tee", false,
     "calibtestsrc name=src board=checkerboard:5x4:40mm ! capsfilter name=caps "
     "caps-change-mode=delayed ! tee name=t "
     "t. ! queue max-size-buffers=3 ! calibdetect board=checkerboard:5x4:40mm mode=async ! "
     "calibsolve capture-mode=all max-views=20 export=ros:FILE.yaml ! caliboverlay ! "
     "fakesink async=false name=sink "
     "t. ! queue max-size-buffers=3 ! calibundistort qos=false calibration=FILE ! "
     "fakesink async=false name=sink1"},
    {"two undistort", false,
     "videotestsrc name=src pattern=ball ! capsfilter name=caps caps-change-mode=delayed ! "
     "calibundistort qos=false calibration=FILE ! queue ! calibundistort qos=false ! "
     "calibdetect ! fakesink name=sink"},
    {"live tee", true,
     "videotestsrc name=src is-live=true ! capsfilter name=caps caps-change-mode=delayed ! tee "
     "name=t "
     "t. ! queue ! calibrate overlay=false ! fakesink async=false name=sink sync=true "
     "t. ! queue ! calibundistort qos=false calibration=FILE ! caliboverlay ! "
     "fakesink async=false name=sink1 sync=true"},
};

inline bool is_ours(GstElement* element) {
  GstElementFactory* factory = gst_element_get_factory(element);
  return factory != nullptr &&
         g_strcmp0(gst_plugin_feature_get_plugin_name(GST_PLUGIN_FEATURE(factory)), "calvin") == 0;
}

inline bool is_filter(GstElement* element) {
  return is_ours(element) && !GST_IS_BIN(element) && element->numsinkpads > 0;
}

class WalkPipeline {
 public:
  WalkPipeline(const Shape& shape, const std::string& file) : shape_(shape) {
    std::string text = shape.launch;
    for (auto at = text.find("FILE"); at != std::string::npos; at = text.find("FILE", at)) {
      text.replace(at, 4, file);
    }
    GError* error = nullptr;
    pipeline_ = gst_parse_launch(text.c_str(), &error);
    g_assert_no_error(error);
    bus_ = gst_element_get_bus(pipeline_);
    for (const char* sink : {"sink", "sink1"}) {
      if (g_autoptr(GstElement) element = find(sink)) ledger_.watch_end(element, "sink");
    }
    g_autoptr(GstElement) source = find("src");
    ledger_.watch_end(source, "src");
    watch(pipeline_);
  }
  WalkPipeline(const WalkPipeline&) = delete;
  WalkPipeline& operator=(const WalkPipeline&) = delete;
  ~WalkPipeline() { close(); }

  // Leaves nothing behind but the ledger.
  void close() {
    if (pipeline_ == nullptr) return;
    gst_element_set_state(pipeline_, GST_STATE_NULL);
    ours_.clear();
    gst_bus_set_flushing(bus_, TRUE);
    gst_clear_object(&bus_);
    gst_clear_object(&pipeline_);
  }

  [[nodiscard]] const Shape& shape() const { return shape_; }
  [[nodiscard]] GstElement* top() const { return pipeline_; }
  [[nodiscard]] GstBus* bus() const { return bus_; }
  Ledger& ledger() { return ledger_; }
  [[nodiscard]] GstElement* find(const char* name) const {
    return gst_bin_get_by_name(GST_BIN(pipeline_), name);
  }

  using ElementPtr = std::shared_ptr<GstElement>;
  // Our elements, bins and what is in them, at this moment.
  std::vector<ElementPtr> ours() {
    const std::lock_guard guard(lock_);
    return ours_;
  }

  // Takes an element of ours out, frees it, and puts a new one with the same settings in its place,
  // between two buffers. False where no such moment came in time.
  bool replace(GstElement* old) {
    g_autoptr(GstPad) sink = gst_element_get_static_pad(old, "sink");
    g_autoptr(GstPad) upstream = gst_pad_get_peer(sink);
    if (upstream == nullptr) return false;
    auto* order = new std::shared_ptr<Order>(std::make_shared<Order>());
    const std::shared_ptr<Order> ours = *order;
    ours->walk = this;
    ours->old = old;
    // Not an IDLE probe: a pad counts as idle while another probe looks at a buffer on its way,
    // which would then reach the new element ahead of the sticky events.
    const gulong id = gst_pad_add_probe(
        upstream, GST_PAD_PROBE_TYPE_BLOCK_DOWNSTREAM, replace_when_blocked, order,
        [](gpointer data) { delete static_cast<std::shared_ptr<Order>*>(data); });
    for (int i = 0; i < 50; ++i) {
      {
        const std::lock_guard guard(ours->lock);
        if (ours->done) return true;
      }
      g_usleep(1000);
    }
    const std::lock_guard guard(ours->lock);
    if (ours->done) return true;
    ours->cancelled = true;
    gst_pad_remove_probe(upstream, id);
    return false;
  }

 private:
  struct Order {
    WalkPipeline* walk = nullptr;
    GstElement* old = nullptr;
    std::mutex lock;
    bool done = false;
    bool cancelled = false;
  };

  static GstPadProbeReturn replace_when_blocked(GstPad* upstream, GstPadProbeInfo*, gpointer data) {
    Order& order = **static_cast<std::shared_ptr<Order>*>(data);
    const std::lock_guard guard(order.lock);
    if (order.cancelled || order.done) return GST_PAD_PROBE_REMOVE;
    order.walk->replace_now(upstream, order.old);
    order.done = true;
    return GST_PAD_PROBE_REMOVE;
  }

  void replace_now(GstPad* upstream, GstElement* old) {
    const Ledger::Disturbance disturbance(ledger_);
    g_autoptr(GstPad) src = gst_element_get_static_pad(old, "src");
    g_autoptr(GstPad) sink = gst_element_get_static_pad(old, "sink");
    g_autoptr(GstPad) downstream = gst_pad_get_peer(src);
    GstElement* parent = GST_ELEMENT(GST_OBJECT_PARENT(old));
    GstElement* fresh = copy_of(old);
    gst_pad_unlink(upstream, sink);
    gst_pad_unlink(src, downstream);
    forget(old);
    gst_element_set_locked_state(old, TRUE);  // the pipeline may be on its way to PLAYING
    gst_element_set_state(old, GST_STATE_NULL);
    gst_bin_remove(GST_BIN(parent), old);
    gst_bin_add(GST_BIN(parent), fresh);
    watch_one(fresh);
    if (GST_IS_BIN(fresh)) watch(fresh);
    g_autoptr(GstPad) new_sink = gst_element_get_static_pad(fresh, "sink");
    g_autoptr(GstPad) new_src = gst_element_get_static_pad(fresh, "src");
    gst_pad_link(new_src, downstream);
    gst_pad_link(upstream, new_sink);
    gst_element_sync_state_with_parent(fresh);
  }

  static GstElement* copy_of(GstElement* old) {
    GstElement* fresh = gst_element_factory_create(gst_element_get_factory(old), nullptr);
    guint count = 0;
    g_autofree GParamSpec** specs = g_object_class_list_properties(G_OBJECT_GET_CLASS(old), &count);
    for (guint i = 0; i < count; ++i) {
      if ((~specs[i]->flags & G_PARAM_READWRITE) != 0) continue;
      if (specs[i]->owner_type == GST_TYPE_OBJECT || specs[i]->owner_type == GST_TYPE_BIN) continue;
      g_auto(GValue) value = G_VALUE_INIT;
      g_value_init(&value, specs[i]->value_type);
      g_object_get_property(G_OBJECT(old), specs[i]->name, &value);
      g_object_set_property(G_OBJECT(fresh), specs[i]->name, &value);
    }
    return fresh;
  }

  void watch_one(GstElement* element) {
    if (!is_ours(element)) return;
    if (is_filter(element)) ledger_.watch_filter(element);
    const std::lock_guard guard(lock_);
    ours_.emplace_back(GST_ELEMENT(gst_object_ref(element)), gst_object_unref);
  }
  void watch(GstElement* bin) {
    GstIterator* all = gst_bin_iterate_recurse(GST_BIN(bin));
    gst_iterator_foreach(
        all,
        [](const GValue* item, gpointer data) {
          static_cast<WalkPipeline*>(data)->watch_one(GST_ELEMENT(g_value_get_object(item)));
        },
        this);
    gst_iterator_free(all);
  }
  // The element and what is in it.
  void forget(GstElement* old) {
    const std::lock_guard guard(lock_);
    std::erase_if(ours_, [old](const ElementPtr& element) {
      return element.get() == old ||
             gst_object_has_as_ancestor(GST_OBJECT(element.get()), GST_OBJECT(old));
    });
  }

  const Shape& shape_;
  Ledger ledger_;
  GstElement* pipeline_ = nullptr;
  GstBus* bus_ = nullptr;
  std::mutex lock_;
  std::vector<ElementPtr> ours_;
};

}  // namespace calvin::check
