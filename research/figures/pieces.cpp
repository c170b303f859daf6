#include "research/figures/pieces.h"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <sstream>

#include "io/image/pictures/png.h"
#include "research/figures/charts/svg.h"

namespace sdm::figures {
namespace {

std::string base64(std::string_view bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string result;
  result.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8 | (k < count ? static_cast<std::uint8_t>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k) result += k <= count ? kDigits[group >> (18 - 6 * k) & 63] : '=';
  }
  return result;
}

std::string swatch(io::Rgb color, std::string_view name) {
  return fmt::format(R"(<span class="swatch"><i style="background:{}"></i>{}</span>)", css(color),
                     escaped(name));
}

}  // namespace

std::string data_url(const io::Picture& picture) {
  std::ostringstream png;
  io::write_png(png, picture.width, picture.height, [&](std::uint32_t y, std::span<io::Rgb> pixels) {
    std::copy_n(&picture.pixels[std::size_t{y} * picture.width], picture.width, pixels.begin());
  });
  return "data:image/png;base64," + base64(std::move(png).str());
}

std::string panel(const io::Picture& picture, std::string_view caption) {
  const std::string text = escaped(caption);
  return fmt::format(
      R"(<figure style="max-width:{}px"><img width="{}" height="{}" alt="{}" src="{}"><figcaption>{}</figcaption></figure>)"
      "\n",
      std::max(picture.width, 120u), picture.width, picture.height, text, data_url(picture), text);
}

std::string panel(const std::string& svg, std::string_view caption) {
  return caption.empty()
             ? fmt::format("<figure>{}</figure>\n", svg)
             : fmt::format("<figure>{}<figcaption>{}</figcaption></figure>\n", svg, escaped(caption));
}

std::string row(const std::vector<std::string>& panels) {
  std::string result = "<div class=\"row\">\n";
  for (const std::string& each : panels) result += each;
  return result + "</div>\n";
}

std::string table(const std::vector<std::string>& heads, const std::vector<std::vector<std::string>>& rows) {
  std::string result = "<div class=\"wide\"><table><thead><tr>";
  for (const std::string& head : heads) result += "<th>" + escaped(head) + "</th>";
  result += "</tr></thead><tbody>\n";
  for (const auto& cells : rows) {
    result += "<tr>";
    for (const std::string& cell : cells) result += "<td>" + escaped(cell) + "</td>";
    result += "</tr>\n";
  }
  return result + "</tbody></table></div>\n";
}

std::string prose(std::string_view text) {
  std::string html = escaped(text);
  for (bool open = true;; open = !open) {
    const std::size_t tick = html.find('`');
    if (tick == std::string::npos) return html;
    html.replace(tick, 1, open ? "<code>" : "</code>");
  }
}

std::string paragraph(std::string_view text) {
  return fmt::format("<p>{}</p>\n", prose(text));
}

std::string magnitude(double value) {
  return value == 0 ? "0" : fmt::format("{:.1e}", value);
}

std::string both_engines(const Times& cpu, const Times& gl, const Machine& machine) {
  if (gl.empty()) return cpu.median_text();
  return fmt::format("{}; gl engine: {}{}", cpu.median_text(), gl.median_text(),
                     machine.gl_software ? " (software, no GPU)" : "");
}

std::string voronoi_legend() {
  return "<p class=\"legend\">Closest site, one colour each: " +
         swatch(io::site_color(SiteType::face, 1), "faces pale") +
         swatch(io::site_color(SiteType::edge, 1), "edges strong") +
         swatch(io::site_color(SiteType::vertex, 1), "vertices dark") + "</p>\n";
}

std::string direction_legend() {
  std::string result = "<p class=\"legend\">Direction to the closest point:";
  for (const auto& [vector, name] : {std::pair(Vec3f{1, 0, 0}, "+x"), std::pair(Vec3f{-1, 0, 0}, "\u2212x"),
                                     std::pair(Vec3f{0, 1, 0}, "+y"), std::pair(Vec3f{0, -1, 0}, "\u2212y"),
                                     std::pair(Vec3f{0, 0, 1}, "+z"), std::pair(Vec3f{0, 0, -1}, "\u2212z")})
    result += swatch(io::direction_color(vector), name);
  return result + "</p>\n";
}

}  // namespace sdm::figures
