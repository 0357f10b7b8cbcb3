// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sdk/host/core/time_order.hpp"
#include "tests/support/support.hpp"

namespace odograph {

/// A queue that takes samples by type and time.
struct Order : TimeOrder {
  using TimeOrder::TimeOrder;
  static OwnedMessage sample(uint32_t type, int64_t t_ns, uint32_t source = 0, uint32_t flags = 0) {
    alignas(8) unsigned char bytes[ODO_LARGEST_MESSAGE] = {};
    auto& header = *reinterpret_cast<odo_header*>(bytes);
    const MessageInfo* info = message_info(type);
    header.struct_size = static_cast<uint32_t>(info ? info->size : sizeof header);
    header.type = type, header.t_ns = t_ns, header.source = source, header.flags = flags;
    return OwnedMessage(header);
  }
  Verdict add(uint32_t type, int64_t t_ns, uint32_t source = 0, uint32_t flags = 0) {
    return push(sample(type, t_ns, source, flags));
  }
  Verdict imu(int64_t t_ns) { return add(ODO_TYPE_IMU, t_ns); }
  /// Times and types of what is released.
  std::vector<std::pair<int64_t, uint32_t>> released(int64_t flush_until_ns = INT64_MIN) {
    std::vector<std::pair<int64_t, uint32_t>> out;
    for (OwnedMessage m; pop(m, flush_until_ns);) out.emplace_back(m.header().t_ns, m.header().type);
    return out;
  }
  std::vector<int64_t> all(int64_t flush_until_ns = INT64_MIN) {
    std::vector<int64_t> times;
    for (const auto& [t_ns, type] : released(flush_until_ns)) times.push_back(t_ns);
    return times;
  }
};

}  // namespace odograph
