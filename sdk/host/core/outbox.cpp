// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/core/outbox.hpp"

#include <memory>
#include <utility>

#include "sdk/host/base/printable.hpp"

namespace odograph {

void Outbox::set_callback(TypeSet types, odo_callback callback, void* user) {
  std::unique_ptr<const Receiver> receiver;
  wants_reports_ = callback && types.has(ODO_TYPE_REPORT);
  if (callback && !types.empty()) receiver.reset(new Receiver{std::move(types), callback, user});
  receiver.reset(receiver_.exchange(receiver.release()));
  std::unique_lock lock(mutex_);
  ++waiting_;
  returned_.wait(lock, [this] { return !runs_ || thread_ == std::this_thread::get_id(); });
  --waiting_;
}

void Outbox::publish(const odo_header& event) {
  thread_ = std::this_thread::get_id();
  runs_ = true;
  const Receiver* const receiver = receiver_;
  if (receiver && receiver->types.has(event.type)) receiver->callback(receiver->user, &event);
  runs_ = false;
  if (waiting_ == 0) return;
  const std::lock_guard lock(mutex_);  // so that the waiting thread does not miss it
  returned_.notify_all();
}

void Outbox::add(const Report& report) {
  const std::lock_guard lock(mutex_);
  if (report.severity >= ODO_SEVERITY_WARNING)
    last_error_ = {report.status < 0                       ? report.status
                   : report.severity == ODO_SEVERITY_ERROR ? ODO_E_ERROR
                                                           : ODO_E_DISCARD,
                   report.origin + ": " + report.text};
  if (reports_.size() < kMaxReports) reports_.push_back(report);
  has_reports_ = true;
}

bool Outbox::report_is_waiting() const { return has_reports_ && wants_reports_; }

void Outbox::publish_reports(int64_t t_ns) {
  std::vector<Report> reports;
  {
    const std::lock_guard lock(mutex_);
    reports.swap(reports_);
    has_reports_ = false;
  }
  for (const Report& report : reports) {
    auto event = make_message<odo_report>(ODO_TYPE_REPORT, t_ns);
    event.header.source = report.instance;
    event.count = report.count;
    event.severity = report.severity;
    event.status = report.status;
    copy_text(event.plugin, report.origin);
    copy_text(event.key, report.key);
    copy_text(event.text, report.text);
    publish(event.header);
  }
}

void Outbox::set_last_error(Failure error) {
  const std::lock_guard lock(mutex_);
  last_error_ = std::move(error);
}

Failure Outbox::take_last_error() {
  const std::lock_guard lock(mutex_);
  return std::exchange(last_error_, {ODO_OK, ""});
}

}  // namespace odograph
