// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/base/output_file.hpp"
#include "sdk/tools/plot/plot.hpp"

#include <cstdio>
#include <fstream>
#include <sstream>

#include "sdk/host/platform/temporary_folder.hpp"

namespace odograph {
namespace {

/// Removes special characters: the text goes into a gnuplot script.
std::string quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' || c == '\\' || c == '\n' ? ' ' : c;
  return out + "'";
}

std::string script(const Plot& plot, const std::string& output) {
  std::ostringstream s;
  s << "set terminal svg size 800," << (plot.equal_axes ? 640 : 360)
    << " dynamic background rgb 'white' font 'sans-serif,13'\n"
    << "set output " << quoted(output) << "\nset grid\nset key outside above Left reverse noenhanced\n"
    << "do for [i=1:8] { set linetype i lw 1.5 }\nset xlabel " << quoted(plot.x_label) << "\nset ylabel "
    << quoted(plot.y_label) << '\n';
  if (plot.equal_axes) s << "set size ratio -1\n";
  if (plot.log_y) s << "set logscale y\n";
  if (plot.y_down) s << "set yrange [] reverse\n";
  for (size_t i = 0; i < plot.series.size(); ++i) {
    s << "$d" << i << " << EOD\n";
    for (const auto& [x, y] : plot.series[i].points) s << x << ' ' << y << '\n';
    s << "EOD\n";
  }
  s << "plot ";
  for (size_t i = 0; i < plot.series.size(); ++i)
    s << (i ? ", " : "") << "$d" << i << " with " << plot.series[i].style << " title " << quoted(plot.series[i].name);
  s << '\n';
  return s.str();
}

}  // namespace

Result<std::string> draw_svg(const Plot& plot) {
  const Failure none{ODO_E_UNSUPPORTED, "No picture: gnuplot could not be run (on Debian: apt install gnuplot-nox)."};
  const TemporaryFolder folder;
  if (folder.path().empty()) return none;
  const std::string output = (folder.path() / "plot.svg").string();
  std::string svg;
  if (FILE* pipe = popen("gnuplot 2>/dev/null", "w")) {
    const std::string text = script(plot, output);
    std::fwrite(text.data(), 1, text.size(), pipe);
    if (pclose(pipe) == 0) {
      std::ifstream file(output);
      std::stringstream content;
      content << file.rdbuf();
      svg = content.str();
    }
  }
  const size_t begin = svg.find("<svg");
  if (begin == std::string::npos) return none;
  return svg.substr(begin);
}

Result<bool> write_svg(const Plot& plot, const std::string& file) {
  const auto svg = draw_svg(plot);
  if (!svg) return svg.failure();
  return write_whole_file(file, *svg);
}

std::string plots_page(const std::string& title, const std::string& figures, const std::vector<std::string>& warnings,
                       const std::string& written, const std::vector<Plot>& plots) {
  std::string html = "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\"><title>Odograph: " + title +
                     "</title>\n<style>body{font:16px sans-serif;max-width:60em;margin:2em auto;padding:0 1em}"
                     "svg{max-width:100%;height:auto}</style>\n<h1>" +
                     title + "</h1>\n<pre>" + figures + "</pre>\n";
  for (const auto& warning : warnings) html += "<p>Beware: " + warning + "</p>\n";
  html += "<pre>" + written + "</pre>\n";
  for (const Plot& plot : plots) {
    const auto svg = draw_svg(plot);
    html += "<h2>" + plot.title + "</h2>\n" + (svg ? *svg : "<p>" + svg.failure().text + "</p>\n");
  }
  return html + "</html>\n";
}

}  // namespace odograph
