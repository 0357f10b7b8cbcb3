// SPDX-License-Identifier: Apache-2.0
//
// Reports which services it is offered and their results, and has more state to save than the host keeps.
#include <odograph/plugin.hpp>

namespace {

struct ServiceUser {
  static constexpr odo::Description description{"test/asks_services", "1.0.0", "Asks.", ODO_INTERFACE_ATTITUDE};
  static std::vector<odo::Parameter<ServiceUser>> parameters() { return {}; }

  template <class Table>
  static const Table* service(const odo::Output& output, std::string_view id) {
    return static_cast<const Table*>(output.host()->get_service(output.host(), id.data(), id.size()));
  }
  void configured(odo::Output& output) {
    const auto say = [&](const std::string& what) { output.report(ODO_SEVERITY_WARNING, what, what); };
    say(std::string("wake ") + (service<odo_wake_service>(output, ODO_SERVICE_WAKE) ? "yes" : "no"));
    const auto* number = service<int>(output, "acme.number/1");
    say("number " + (number ? std::to_string(*number) : "none"));
    const auto* assets = service<odo_content_service>(output, ODO_SERVICE_CONTENTS);
    if (!assets) return say("no assets");
    const odo_string name = odo::str("asset.txt"), missing = odo::str("missing.txt");
    odo_asset* asset = nullptr;
    uint64_t size = 7;
    if (assets->open(assets->user, &missing, &asset, &size) != ODO_E_NOT_FOUND) say("opened what is not there");
    if (assets->open(assets->user, &name, &asset, &size) != ODO_OK) return say("no asset");
    char text[64];
    const int64_t got = assets->read(asset, 2, text, sizeof text);
    say("asset " + std::to_string(size) + " " + std::string(text, static_cast<size_t>(got < 0 ? 0 : got)));
    if (assets->read(asset, size, text, sizeof text) != 0) say("read behind the end");
    assets->close(asset);
  }
  void on(const odo_imu&, odo::Output&) {}
  std::vector<uint8_t> save() const { return std::vector<uint8_t>(ODO_LARGEST_STATE + 1u); }
  void load(const uint8_t*, size_t) {}
};

}  // namespace

ODO_PLUGIN(ServiceUser)
