// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Every element of the plugin, whichever they are: up and down the states, alone and in a pipeline,
// with every property at its limits.

#include <functional>
#include <string>

#include "common/property_kinds.hpp"
#include "element_properties.hpp"

#include <gst/check/gstcheck.h>

using namespace calvin;

// Calls f with a new element of every factory of the plugin.
static void for_each_element(const std::function<void(GstElement*)>& f) {
  GList* features = gst_registry_get_feature_list_by_plugin(gst_registry_get(), "calvin");
  int count = 0;
  for (GList* item = features; item != nullptr; item = item->next) {
    if (!GST_IS_ELEMENT_FACTORY(item->data)) continue;
    GstElement* element = gst_element_factory_create(GST_ELEMENT_FACTORY(item->data), nullptr);
    fail_unless(element != nullptr);
    gst_object_ref_sink(element);
    f(element);
    // A worker lets go of the element a moment after it has told something.
    for (int i = 0; i < 200 && GST_OBJECT_REFCOUNT_VALUE(element) > 1; ++i) g_usleep(10000);
    ASSERT_OBJECT_REFCOUNT(element, GST_OBJECT_NAME(element), 1);
    gst_object_unref(element);
    ++count;
  }
  gst_plugin_feature_list_free(features);
  fail_unless(count >= 6, "only %d elements", count);
}

// A step of a walk; a pipeline has arrived when this returns.
static void go_to(GstElement* top, GstState state) {
  const GstStateChangeReturn change = gst_element_set_state(top, state);
  fail_if(change == GST_STATE_CHANGE_FAILURE, "%s to %s", GST_OBJECT_NAME(top),
          gst_element_state_get_name(state));
  if (change != GST_STATE_CHANGE_ASYNC) return;
  fail_if(gst_element_get_state(top, nullptr, nullptr, 20 * GST_SECOND) == GST_STATE_CHANGE_ASYNC,
          "%s never reaches %s", GST_OBJECT_NAME(top), gst_element_state_get_name(state));
}

static const GstState kWalk[] = {GST_STATE_READY,   GST_STATE_PAUSED,  GST_STATE_PLAYING,
                                 GST_STATE_PAUSED,  GST_STATE_READY,   GST_STATE_NULL,
                                 GST_STATE_PLAYING, GST_STATE_READY,   GST_STATE_PAUSED,
                                 GST_STATE_NULL,    GST_STATE_PLAYING, GST_STATE_NULL};

// `top` is the element itself or the pipeline around it.
static void walk(GstElement* top, GstElement* element) {
  check::get_all_properties(element);
  for (const GstState state : kWalk) {
    go_to(top, state);
    check::get_all_properties(element);
  }
}

GST_START_TEST(test_created_and_forgotten) {
  for_each_element([](GstElement* element) {
    check::get_all_properties(element);
    fail_unless_equals_int(GST_STATE(element), GST_STATE_NULL);
  });
}
GST_END_TEST;

GST_START_TEST(test_states_alone) {
  for_each_element([](GstElement* element) { walk(element, element); });
}
GST_END_TEST;

// The element between a source and a sink, as far as it has pads for them.
static GstElement* pipeline_around(GstElement* element) {
  GstElement* pipeline = gst_pipeline_new(nullptr);
  gst_bin_add(GST_BIN(pipeline), element);
  g_autoptr(GstCaps) caps = gst_caps_from_string("video/x-raw,format=I420,width=160,height=120");
  if (element->numsinkpads > 0) {
    GstElement* source = gst_element_factory_make("videotestsrc", nullptr);
    gst_bin_add(GST_BIN(pipeline), source);
    fail_unless(gst_element_link_filtered(source, element, caps));
  }
  if (element->numsrcpads > 0) {
    GstElement* sink = gst_element_factory_make("fakesink", nullptr);
    gst_bin_add(GST_BIN(pipeline), sink);
    fail_unless(gst_element_link_filtered(element, sink, caps));
  }
  return pipeline;
}

static void remove_pipeline(GstElement* pipeline, GstElement* element) {
  go_to(pipeline, GST_STATE_NULL);
  gst_bin_remove(GST_BIN(pipeline), element);
  gst_object_unref(pipeline);
}

GST_START_TEST(test_states_in_a_pipeline) {
  for_each_element([](GstElement* element) {
    GstElement* pipeline = pipeline_around(element);
    walk(pipeline, element);
    remove_pipeline(pipeline, element);
  });
}
GST_END_TEST;

// An empty text is no text.
static bool same(GParamSpec* spec, const GValue* a, const GValue* b) {
  if (!G_IS_PARAM_SPEC_STRING(spec)) return g_param_values_cmp(spec, a, b) == 0;
  const auto text = [](const GValue* value) {
    std::string read;
    gst::read_value(value, read);
    return read;
  };
  return text(a) == text(b);
}

GST_START_TEST(test_every_property_takes_its_limits) {
  for_each_element([](GstElement* element) {
    check::for_each_setting(element, [element](GParamSpec* spec) {
      for (const check::Choice choice : check::kLimits) {
        g_auto(GValue) set = G_VALUE_INIT;
        if (!check::choose(spec, choice, &set)) continue;
        g_object_set_property(G_OBJECT(element), spec->name, &set);
        g_auto(GValue) got = G_VALUE_INIT;
        g_value_init(&got, spec->value_type);
        g_object_get_property(G_OBJECT(element), spec->name, &got);
        g_autofree char* text = g_strdup_value_contents(&set);
        fail_unless(same(spec, &set, &got), "%s does not take %s=%s", GST_OBJECT_NAME(element),
                    spec->name, text);
      }
    });
  });
}
GST_END_TEST;

GST_START_TEST(test_every_property_takes_its_limits_while_playing) {
  for_each_element([](GstElement* element) {
    GstElement* pipeline = pipeline_around(element);
    go_to(pipeline, GST_STATE_PLAYING);
    check::for_each_setting(element, [element](GParamSpec* spec) {
      if ((spec->flags & GST_PARAM_MUTABLE_PLAYING) == 0) return;
      for (const check::Choice choice : check::kLimits) {
        g_auto(GValue) value = G_VALUE_INIT;
        if (!check::choose(spec, choice, &value)) continue;
        g_object_set_property(G_OBJECT(element), spec->name, &value);
        g_usleep(2000);  // a frame or two
      }
    });
    remove_pipeline(pipeline, element);
  });
}
GST_END_TEST;

static Suite* states_suite() {
  Suite* suite = suite_create("states");
  TCase* tests = tcase_create("all elements");
  suite_add_tcase(suite, tests);
  tcase_add_test(tests, test_created_and_forgotten);
  tcase_add_test(tests, test_states_alone);
  tcase_add_test(tests, test_states_in_a_pipeline);
  tcase_add_test(tests, test_every_property_takes_its_limits);
  tcase_add_test(tests, test_every_property_takes_its_limits_while_playing);
  return suite;
}

GST_CHECK_MAIN(states);
