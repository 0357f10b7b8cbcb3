// SPDX-License-Identifier: Apache-2.0
// A good fixer that uses a vendor's messages, and answers with one as well.
#include <odograph/plugin.hpp>

struct Scan {
  odo_header header;
};
struct Answer {
  odo_header header;
};
template <>
struct odo::type_of<Scan> : std::integral_constant<uint32_t, ODO_TYPE_VENDOR(7, 1)> {};
template <>
struct odo::type_of<Answer> : std::integral_constant<uint32_t, ODO_TYPE_VENDOR(7, ODO_VENDOR_EVENT | 2)> {};
struct WifiFixer {
  static constexpr odo::Description description{"test/wifi_fixer", "1.0.0", "For a test.",
                                                ODO_INTERFACE_ABSOLUTE_FIXER};
  static std::vector<odo::Parameter<WifiFixer>> parameters() { return {}; }
  static constexpr uint32_t extra_inputs[] = {ODO_TYPE_VENDOR(7, 1)};
  static constexpr uint32_t extra_outputs[] = {ODO_TYPE_VENDOR(7, ODO_VENDOR_EVENT | 2)};
  using VendorMessages = odo::Messages<Scan>;
  void on(const Scan& scan, odo::Output& output) {
    auto fix = odo::make<odo_fix>(scan.header.t_ns);
    fix.header.flags = ODO_FIX_NORTH | ODO_FIX_EAST | ODO_FIX_COVARIANCE;
    fix.p_n[0] = scan.header.struct_size;
    fix.covariance_n[0] = fix.covariance_n[4] = fix.covariance_n[8] = 1;
    output.emit(fix);
    output.emit(odo::make<Answer>(scan.header.t_ns));
  }
};

ODO_PLUGIN(WifiFixer)
