// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Accounts for every buffer of a pipeline. What enters an element of ours leaves it, before the
// next one enters, in order and once; one may be lost only where a disturbance (a flush, a seek, a
// state change to READY or NULL, an unlinked pad) fell into its stay. Every buffer is freed when
// the pipeline is.
#pragma once

#include <atomic>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gst/gst.h>

namespace calvin::check {

class Ledger {
 public:
  // While one lives, buffers may get lost.
  class Disturbance {
   public:
    explicit Disturbance(Ledger& ledger) : ledger_(ledger) { ++ledger_.begun_; }
    Disturbance(const Disturbance&) = delete;
    Disturbance& operator=(const Disturbance&) = delete;
    ~Disturbance() { ++ledger_.ended_; }

   private:
    Ledger& ledger_;
  };

  // A filter: one buffer out for each one in.
  void watch_filter(GstElement* element) {
    auto gate = std::make_shared<Gate>();
    gate->name = GST_OBJECT_NAME(element);
    add_probe(element, "sink", GST_PAD_PROBE_TYPE_BUFFER, gate, enters);
    add_probe(element, "src", GST_PAD_PROBE_TYPE_BUFFER, gate, leaves);
  }
  // An end of the pipeline: its buffers since the last flush are counted under its name.
  void watch_end(GstElement* element, const char* pad) {
    auto gate = std::make_shared<Gate>();
    gate->name = GST_OBJECT_NAME(element);
    const auto types =
        static_cast<GstPadProbeType>(GST_PAD_PROBE_TYPE_BUFFER | GST_PAD_PROBE_TYPE_EVENT_FLUSH);
    add_probe(element, pad, types, gate, counted);
  }

  void reset_counts() {
    const std::lock_guard guard(lock_);
    counts_.clear();
  }
  std::map<std::string, std::uint64_t> counts() {
    const std::lock_guard guard(lock_);
    return counts_;
  }
  // What was wrong, empty where nothing was.
  std::vector<std::string> faults() {
    const std::lock_guard guard(lock_);
    return faults_;
  }
  [[nodiscard]] std::int64_t live_buffers() const { return live_; }
  [[nodiscard]] std::uint64_t passed() const { return passed_; }
  [[nodiscard]] std::uint64_t lost() const { return lost_; }

 private:
  struct Gate {
    Ledger* ledger = nullptr;
    std::string name;
    std::optional<GstClockTime> inside;  // the buffer that has not left yet
    std::uint64_t begun = 0;             // disturbances when it entered
    bool disturbed = false;
  };
  using Handler = GstPadProbeReturn (*)(GstPad*, GstPadProbeInfo*, gpointer);

  void add_probe(GstElement* element, const char* name, GstPadProbeType type,
                 const std::shared_ptr<Gate>& gate, Handler handler) {
    gate->ledger = this;
    g_autoptr(GstPad) pad = gst_element_get_static_pad(element, name);
    gst_pad_add_probe(pad, type, handler, new std::shared_ptr<Gate>(gate),
                      [](gpointer data) { delete static_cast<std::shared_ptr<Gate>*>(data); });
  }
  static Gate& gate_of(gpointer data) { return **static_cast<std::shared_ptr<Gate>*>(data); }

  static GstPadProbeReturn enters(GstPad*, GstPadProbeInfo* info, gpointer data) {
    Gate& gate = gate_of(data);
    Ledger& ledger = *gate.ledger;
    GstBuffer* buffer = GST_PAD_PROBE_INFO_BUFFER(info);
    ledger.follow(buffer);
    const std::lock_guard guard(ledger.lock_);
    if (gate.inside) ledger.lose(gate);
    gate.inside = GST_BUFFER_PTS(buffer);
    gate.begun = ledger.begun_;
    gate.disturbed = ledger.begun_ != ledger.ended_;
    return GST_PAD_PROBE_OK;
  }
  static GstPadProbeReturn leaves(GstPad*, GstPadProbeInfo* info, gpointer data) {
    Gate& gate = gate_of(data);
    Ledger& ledger = *gate.ledger;
    GstBuffer* buffer = GST_PAD_PROBE_INFO_BUFFER(info);
    ledger.follow(buffer);
    const std::lock_guard guard(ledger.lock_);
    if (gate.inside != GST_BUFFER_PTS(buffer)) {
      ledger.faults_.push_back(fmt::format("{} pushes {} ns, which is not the buffer that entered",
                                           gate.name, GST_BUFFER_PTS(buffer)));
    }
    gate.inside.reset();
    ++ledger.passed_;
    return GST_PAD_PROBE_OK;
  }
  static GstPadProbeReturn counted(GstPad*, GstPadProbeInfo* info, gpointer data) {
    Gate& gate = gate_of(data);
    Ledger& ledger = *gate.ledger;
    const std::lock_guard guard(ledger.lock_);
    if ((info->type & GST_PAD_PROBE_TYPE_BUFFER) != 0) {
      ledger.follow(GST_PAD_PROBE_INFO_BUFFER(info));
      ++ledger.counts_[gate.name];
    } else if (GST_EVENT_TYPE(GST_PAD_PROBE_INFO_EVENT(info)) == GST_EVENT_FLUSH_STOP) {
      ledger.counts_[gate.name] = 0;
    }
    return GST_PAD_PROBE_OK;
  }

  void lose(const Gate& gate) {
    ++lost_;
    if (gate.disturbed || gate.begun != begun_) return;
    faults_.push_back(fmt::format("{} lost the buffer of {} ns", gate.name, *gate.inside));
  }
  // A buffer that passes twice is followed twice, and freed as often.
  void follow(GstBuffer* buffer) {
    ++live_;
    gst_mini_object_weak_ref(
        GST_MINI_OBJECT(buffer),
        [](gpointer data, GstMiniObject*) { --static_cast<Ledger*>(data)->live_; }, this);
  }

  std::atomic<std::uint64_t> begun_ = 0;
  std::atomic<std::uint64_t> ended_ = 0;
  std::atomic<std::int64_t> live_ = 0;
  std::atomic<std::uint64_t> passed_ = 0;
  std::atomic<std::uint64_t> lost_ = 0;
  std::mutex lock_;
  std::vector<std::string> faults_;
  std::map<std::string, std::uint64_t> counts_;
};

}  // namespace calvin::check
