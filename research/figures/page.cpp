// report.html.
#include <fmt/format.h>
#include <sdm/version.h>

#include "research/figures/charts/svg.h"
#include "research/figures/pieces.h"
#include "research/figures/reproduce.h"

namespace sdm::figures {
namespace {

constexpr std::string_view kStyle = R"(
:root { color-scheme: light dark; --page: #fff; --ink: #1c1e22; --soft: #44484e; --faint: #5a5e64; --line: #d5d8dd;
  --strong-line: #8a8f96; --bar: #c5c9d0; --measured: #0072b2; --axis: #5a5e64; --grid: #e2e4e8; --link: #0b57c9; }
@media (prefers-color-scheme: dark) {
  :root { --page: #16181c; --ink: #e6e8eb; --soft: #b9bec6; --faint: #a2a8b1; --line: #33373e;
    --strong-line: #6d737c; --bar: #4a4f58; --measured: #56b4e9; --axis: #a2a8b1; --grid: #2d3138; --link: #8ab4f8; }
}
body { margin: 0 auto; max-width: 1180px; padding: 16px 20px 60px; background: var(--page); color: var(--ink);
  font: 16px/1.5 system-ui, "DejaVu Sans", sans-serif; }
a { color: var(--link); }
h1 { font-size: 28px; line-height: 1.2; margin: 20px 0 8px; }
h2 { font-size: 21px; line-height: 1.3; margin: 44px 0 8px; padding-top: 14px; border-top: 1px solid var(--line); }
p { margin: 8px 0; max-width: 75em; }
dl { display: grid; grid-template-columns: max-content 1fr; gap: 2px 14px; margin: 12px 0; }
dt { color: var(--faint); }
dd { margin: 0; overflow-wrap: anywhere; }
.paper, .measured { padding: 2px 0 2px 14px; border-left: 4px solid var(--bar); }
.measured { border-color: var(--measured); }
.paper b, .measured b { display: block; font-size: 13px; letter-spacing: 0.04em; text-transform: uppercase; color: var(--faint); }
.row { display: flex; flex-wrap: wrap; gap: 6px 20px; align-items: flex-start; margin: 14px 0; }
figure { margin: 10px 0; max-width: 100%; }
figure img { max-width: 100%; height: auto; display: block; background: #fff; }
figure svg { max-width: 100%; height: auto; display: block; }
figcaption { font-size: 14px; color: var(--soft); margin-top: 4px; }
svg text { font-family: system-ui, "DejaVu Sans", sans-serif; }
.wide { overflow-x: auto; margin: 14px 0; }
table { border-collapse: collapse; font-size: 14px; }
th, td { padding: 4px 12px 4px 0; text-align: right; border-bottom: 1px solid var(--grid); vertical-align: top; }
th { border-bottom-color: var(--strong-line); }
td { white-space: nowrap; }
.comparisons td, td:first-child { white-space: normal; }
td:first-child { min-width: 9em; }
th:first-child, td:first-child { text-align: left; }
.comparisons { width: 100%; }
.comparisons th, .comparisons td { text-align: left; }
.legend { font-size: 14px; color: var(--soft); }
.swatch { display: inline-block; margin-left: 12px; white-space: nowrap; }
.swatch i { display: inline-block; width: 14px; height: 14px; margin-right: 5px; vertical-align: -2px; border: 1px solid var(--strong-line); }
.contents { font-size: 15px; }
.contents ol { margin: 6px 0; padding: 0; list-style: none; columns: 18em; column-gap: 28px; }
.contents li { padding: 2px 0; break-inside: avoid; }
@media (min-width: 1000px) {
  section > figure:has(svg) { display: inline-block; width: calc(50% - 12px); margin-right: 8px; vertical-align: top; }
  section > figure:has(svg):only-of-type { width: 70%; }
}
@media (min-width: 1500px) {
  body { margin-left: max(320px, calc(50vw - 480px)); }
  .contents { position: fixed; top: 20px; left: 24px; width: 270px; max-height: calc(100vh - 40px); overflow-y: auto; }
  .contents ol { columns: 1; }
}
@media print { .contents { display: none; } section { break-inside: avoid-page; } }
)";

std::string head(const Reproduction& r) {
  const Machine& m = r.machine;
  std::string html = fmt::format(
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n<meta name=\"viewport\" "
      "content=\"width=device-width, initial-scale=1\">\n<meta http-equiv=\"Content-Security-Policy\" "
      "content=\"default-src 'none'; img-src data:; style-src 'unsafe-inline'\">\n<title>Surface Distance "
      "Maps, reproduced</title>\n<style>{}</style></head><body>\n<h1>Surface Distance Maps, "
      "reproduced</h1>\n<p>The figures and tables of A. Sud, N. Govindaraju, R. Gayle and D. Manocha, "
      "<cite>Surface Distance Maps</cite>, UNC TR06-011, 2006, computed again by <code>sdm-paper "
      "figures</code>. All "
      "numbers but the paper's come from one run.</p>\n",
      kStyle);
  if (r.quick)
    html +=
        "<p><strong>A quick run, with fewer frames, lower resolutions and fewer repetitions than the "
        "paper.</strong></p>\n";
  const auto entry = [&](const char* name, const std::string& value) {
    html += fmt::format("<dt>{}</dt><dd>{}</dd>\n", name, escaped(value));
  };
  html += "<dl>\n";
  entry("sdm", kVersion);
  entry("Processor", fmt::format("{}, {} cores, {} threads used, {:.1f} GiB of memory", m.processor, m.cores,
                                 m.threads, m.memory_gb));
  entry("System", m.system + ", compiled by " + m.compiler);
  entry("OpenGL", m.gl_text());
  entry("Run", fmt::format("{:.0f} s in all; times are medians, with the least and the most of the runs",
                           r.seconds));
  entry("The paper's", "2.4 GHz Opteron 280, NVIDIA GeForce 7800 GTX");
  html += "</dl>\n";
  if (m.gl_software)
    html +=
        "<p>The gl engine implements the paper's algorithm on OpenGL. Here OpenGL runs on the processor: its "
        "times are not those of a GPU, and say nothing about one.</p>\n";
  return html;
}

std::string contents(const Reproduction& r) {
  std::string html = "<nav class=\"contents\" aria-label=\"Contents\"><ol>\n";
  for (const Figure& figure : r.figures)
    html += fmt::format("<li><a href=\"#{}\">{}</a></li>\n", figure.key, escaped(figure.title));
  return html + "</ol></nav>\n";
}

std::string comparisons(const Reproduction& r) {
  std::string rows;
  for (const Figure& figure : r.figures)
    for (const Comparison& c : figure.comparisons)
      rows += fmt::format("<tr><td><a href=\"#{}\">{}</a></td><td>{}</td><td>{}</td></tr>\n", figure.key,
                          escaped(c.what), escaped(c.paper), escaped(c.measured));
  if (rows.empty()) return {};
  return "<div class=\"wide\"><table class=\"comparisons\"><thead><tr><th></th><th>the paper</th><th>this "
         "run, cpu engine unless said</th></tr></thead><tbody>\n" +
         rows + "</tbody></table></div>\n";
}

}  // namespace

std::string report_page(const Reproduction& reproduction) {
  std::string html = head(reproduction) + contents(reproduction) + comparisons(reproduction);
  for (const Figure& figure : reproduction.figures) {
    html += fmt::format(
        "<section id=\"{}\"><h2>{}</h2>\n<p class=\"paper\"><b>The paper</b>{}</p>\n<p "
        "class=\"measured\"><b>This run</b>{}</p>\n",
        figure.key, escaped(figure.title), prose(figure.paper), prose(figure.measured));
    for (const std::string& piece : figure.html) html += piece;
    html += "</section>\n";
  }
  return html + "</body></html>\n";
}

}  // namespace sdm::figures
