// SPDX-License-Identifier: Apache-2.0
//
// What the host and the plugins report, kept until the app hears it.
#include "sdk/host/core/session.hpp"
#include <algorithm>
#include <cstring>
#include "sdk/host/base/saturating.hpp"
#include "sdk/host/core/c_guard.hpp"

namespace odograph {

void Session::reported(const Report& report) {
  HostServices::Listener listener;
  {
    const std::lock_guard lock(error_mutex_);
    if (report.severity >= ODO_SEVERITY_WARNING) {
      ++errors_;
      last_error_.status = report.status < 0                       ? report.status
                           : report.severity == ODO_SEVERITY_ERROR ? ODO_E_ERROR
                                                                   : ODO_E_DISCARD;
      std::snprintf(last_error_.message, sizeof last_error_.message, "%s: %s", report.origin.c_str(),
                    report.text.c_str());
    }
    listener = listener_;
    if (reports_.size() < kMaxReports) reports_.push_back(report);
    has_reports_ = true;
  }
  if (listener) listener(report);
  notify();
}

void Session::notify() {
  if (!live_) return;
  const std::lock_guard lock(mutex_);  // so that the thread does not miss it
  work_waiting_.notify_one();
}

/// Under the lock.
bool Session::report_is_waiting() const { return has_reports_ && callback_ && callback_types_.has(ODO_TYPE_REPORT); }

/// With ownership and without the lock: reports come from any thread, the callback on one.
void Session::publish_reports() {
  std::vector<Report> reports;
  {
    const std::lock_guard lock(error_mutex_);
    reports.swap(reports_);
    has_reports_ = false;
  }
  for (const Report& report : reports) {
    auto event = make_message<odo_report>(ODO_TYPE_REPORT, intake_.newest_ns);
    event.header.source = report.instance;
    event.count = report.count;
    event.severity = report.severity;
    event.status = report.status;
    std::snprintf(event.plugin, sizeof event.plugin, "%s", report.origin.c_str());
    std::snprintf(event.key, sizeof event.key, "%s", report.key.c_str());
    std::snprintf(event.text, sizeof event.text, "%s", report.text.c_str());
    publish(event.header);
  }
}

void Session::set_report_listener(HostServices::Listener listener) {
  const std::lock_guard lock(error_mutex_);
  listener_ = std::move(listener);
}

int32_t Session::last_error(odo_error& out) {
  const std::lock_guard lock(error_mutex_);
  if (errors_ == 0) return fail(&out, {ODO_OK, ""});
  errors_ = 0;
  return fail(&out, {last_error_.status, last_error_.message});
}

}  // namespace odograph
