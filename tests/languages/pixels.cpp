// SPDX-License-Identifier: Apache-2.0
//
// A front-end that keeps a frame and records the address of its pixels (allocations.c).
#include <dlfcn.h>

#include <odograph/plugin.hpp>

namespace {

class Pixels {
 public:
  static constexpr odo::Description description{"test/pixels", "1.0.0", "Notes where pixels are",
                                                ODO_INTERFACE_VO_FRONTEND};
  static std::vector<odo::Parameter<Pixels>> parameters() { return {}; }
  Pixels() : see_(reinterpret_cast<void (*)(const void*)>(dlsym(RTLD_DEFAULT, "odo_test_see"))) {}
  ~Pixels() { release(); }

  void on(const odo_frame& frame, odo::Output& output) {
    if (see_) see_(frame.planes[0].data);
    if (frame.loan.retain && frame.loan.retain(frame.loan.owner) == ODO_OK) {
      release();
      kept_ = frame.loan;
    }
    auto event = odo::make<odo_vo_motion>(frame.header.t_ns);
    event.t_from_ns = std::exchange(last_ns_, frame.header.t_ns);
    event.state = ODO_LOST, event.reason = ODO_REASON_INITIALISING;
    if (event.t_from_ns != 0) output.emit(event);
  }

 private:
  void release() {
    if (kept_.release) kept_.release(kept_.owner);
    kept_ = {};
  }

  void (*see_)(const void*);
  odo_loan kept_{};
  int64_t last_ns_ = 0;
};

}  // namespace

ODO_PLUGIN(Pixels)
