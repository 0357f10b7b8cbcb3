// SPDX-License-Identifier: Apache-2.0
//
// `odograph view`: serves a local page of a run, during the run and afterwards.
#include <chrono>
#include <cstdio>
#include <mutex>
#include <string>
#include <thread>

#include "sdk/host/base/printable.hpp"
#include "sdk/tools/command_line/commands.hpp"
#include "sdk/tools/page/run_page.hpp"
#include "sdk/tools/replay/outcome.hpp"

// After Eigen, because a macro of the resolver's header, which this one includes, clashes with Eigen's parameter names.
#include <httplib.h>

namespace odograph {
namespace {

constexpr auto kRenewed = std::chrono::seconds(1);  // update interval of the page during a run
constexpr int kPictureWidth_px = 640;

struct ViewArguments {
  RunOptions options;
  ReadOptions reading;
  std::string input;
  int port = 8350;
  bool once = false;
};

/// The newest data of the page, for the server's threads.
class Shown {
 public:
  void set(std::string page, std::string data) {
    const std::lock_guard lock(mutex_);
    page_ = std::move(page), data_ = std::move(data);
  }
  std::string page() const {
    const std::lock_guard lock(mutex_);
    return page_;
  }
  std::string data() const {
    const std::lock_guard lock(mutex_);
    return data_;
  }

 private:
  mutable std::mutex mutex_;
  std::string page_, data_;
};

int view(ViewArguments& a) {
  a.reading.true_states = false;
  const auto recording = open_recording(a.input, a.reading);
  if (!recording) return print_failure(recording.failure());
  Shown shown;
  const std::string name = std::filesystem::path(a.options.config).filename().string();
  PageOptions page{.command = "odograph view -c " + a.options.config + " -i " + a.input, .served = true, .live = true};
  const auto show = [&](const RunResult& result) {
    shown.set(run_page(*recording, {{name, &result}}, page), run_page_data(*recording, {{name, &result}}, page));
  };
  show(RunResult{});

  httplib::Server server;  // accessible from this machine only
  server.set_pre_routing_handler([](const httplib::Request& in, httplib::Response& out) {
    // Against DNS rebinding: a foreign name that resolves to this address arrives as the host.
    const std::string host = in.get_header_value("Host");
    if (host.starts_with("127.0.0.1:") || host.starts_with("localhost:"))
      return httplib::Server::HandlerResponse::Unhandled;
    out.status = 403;
    return httplib::Server::HandlerResponse::Handled;
  });
  server.Get("/", [&](const httplib::Request&, httplib::Response& out) { out.set_content(shown.page(), "text/html"); });
  server.Get("/data", [&](const httplib::Request&, httplib::Response& out) {
    out.set_content(shown.data(), "application/json");
  });
  server.Get(R"(/picture/(\d{1,9}))", [&](const httplib::Request& in, httplib::Response& out) {
    const auto jpeg = picture_of(*recording, std::stoul(in.matches[1]), kPictureWidth_px);
    if (jpeg.empty()) return void(out.status = 404);
    out.set_content(std::string(jpeg.begin(), jpeg.end()), "image/jpeg");
  });
  const int port =
      a.port == 0 ? server.bind_to_any_port("127.0.0.1") : (server.bind_to_port("127.0.0.1", a.port) ? a.port : -1);
  if (port < 0)
    return print_failure({ODO_E_STATE, "port " + std::to_string(a.port) + " is taken; --port 0 takes a free one"});
  std::thread serving([&] { server.listen_after_bind(); });
  std::printf("http://127.0.0.1:%d/ shows the run; Ctrl-C ends\n", port);
  std::fflush(stdout);

  auto renewed = std::chrono::steady_clock::now();
  Progress progress("run");
  a.options.collect_poses = true;
  a.options.progress = [&](size_t done, size_t all) { progress.show(done, all); };
  a.options.so_far = [&](const RunResult& result) {
    if (std::chrono::steady_clock::now() - renewed < kRenewed) return;
    show(result);
    renewed = std::chrono::steady_clock::now();
  };
  const auto result = replay(*recording, a.options);
  const int status = result ? exit_status(*result) : print_failure(result.failure());
  if (result) {
    page.live = false;
    show(*result);
    for (const auto& report : result->reports) std::fprintf(stderr, "%s\n", printable(report).c_str());
  }
  if (!result || a.once) server.stop();
  serving.join();
  return status;
}

}  // namespace

void add_view(CLI::App& app, int& status) {
  auto* command = app.add_subcommand(
      "view", "Run a pipeline and show it on a local web page, which is served for playback until Ctrl-C");
  auto a = std::make_shared<ViewArguments>();
  command->add_option("-c,--config", a->options.config, "pipeline config (YAML)")->required();
  command->add_option("-i,--input", a->input, "recording, as `run` takes it")->required();
  command->add_option("--port", a->port, "port of the page on this machine; 0: any free port")->capture_default_str();
  command->add_flag("--once", a->once, "exit after the run");
  command->add_option("--plugins", a->options.plugin_path, "folder to look for plugins in first");
  command->add_option("--assets", a->options.asset_path,
                      "folder of files named by the config, if they are not beside it");
  command->add_flag("--pictures-outside", a->reading.pictures_outside,
                    "read pictures outside of the recording's folder too");
  command->callback([a, &status] { status = view(*a); });
}

}  // namespace odograph
