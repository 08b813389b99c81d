// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Every kind of bad input of the table: the message that says what is wrong and what to do, and the
// state that the element is in afterwards.

#include "bad_streams.hpp"
#include "calvin_config.h"

using namespace calvin;
using check::BadInput;
using check::Rig;

static const std::vector<BadInput>& bad_input() {
  static const auto kAll = [] {
    std::vector<BadInput> all = check::bad_settings();
    all.insert(all.end(), check::bad_streams().begin(), check::bad_streams().end());
    return all;
  }();
  return kAll;
}

static std::string all_texts(Rig& rig, GstMessageType type) {
  std::string all;
  for (const std::string& text : rig.bus.texts(type)) all += text + "\n";
  return all;
}

GST_START_TEST(test_bad_input_is_answered) {
  const BadInput& bad = bad_input().at(static_cast<std::size_t>(__i__));
  if (bad.needs_formats && !CALVIN_HAVE_FORMATS) return;
  Rig rig(bad);
  bad.give(rig, bad.input);
  const GstMessageType type = rig.goes_on() ? GST_MESSAGE_WARNING : GST_MESSAGE_ERROR;
  const std::string said = all_texts(rig, type);
  fail_unless(said.find(bad.says) != std::string::npos, "%s: '%s' is not in: %s", bad.what,
              bad.says, said.c_str());
  fail_unless(said.find(bad.advice) != std::string::npos, "%s: '%s' is not in: %s", bad.what,
              bad.advice, said.c_str());
  if (rig.goes_on()) {
    const std::string errors = all_texts(rig, GST_MESSAGE_ERROR);
    fail_unless(errors.empty(), "%s: %s", bad.what, errors.c_str());
  }
}
GST_END_TEST;

GST_START_TEST(test_there_are_a_hundred_kinds) {
  std::vector<std::string> kinds;
  for (const BadInput& bad : bad_input()) kinds.push_back(bad.what);
  std::sort(kinds.begin(), kinds.end());
  fail_unless(std::adjacent_find(kinds.begin(), kinds.end()) == kinds.end());
  fail_unless(kinds.size() >= 100, "%d", static_cast<int>(kinds.size()));
}
GST_END_TEST;

static Suite* bad_input_suite() {
  Suite* suite = suite_create("bad_input");
  TCase* tc = tcase_create("general");
  suite_add_tcase(suite, tc);
  tcase_add_checked_fixture(tc, gst::register_metas, nullptr);
  tcase_add_loop_test(tc, test_bad_input_is_answered, 0, static_cast<int>(bad_input().size()));
  tcase_add_test(tc, test_there_are_a_hundred_kinds);
  return suite;
}

GST_CHECK_MAIN(bad_input)
