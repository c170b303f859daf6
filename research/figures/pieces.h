// Pieces of the page, as HTML.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "io/image/pictures/picture.h"
#include "research/figures/machine.h"
#include "research/figures/timing.h"

namespace sdm::figures {

/// A picture with a line of text below it; on a wide page several stand side by side in a row().
[[nodiscard]] std::string panel(const io::Picture& picture, std::string_view caption);
/// The same for SVG.
[[nodiscard]] std::string panel(const std::string& svg, std::string_view caption);
[[nodiscard]] std::string row(const std::vector<std::string>& panels);

/// A table; all columns but the first are aligned to the right.
[[nodiscard]] std::string table(const std::vector<std::string>& heads,
                                const std::vector<std::vector<std::string>>& rows);
[[nodiscard]] std::string paragraph(std::string_view text);
/// Text as HTML, with what stands between backticks as code.
[[nodiscard]] std::string prose(std::string_view text);

/// An error with two digits: "0" or "2.9e-08".
[[nodiscard]] std::string magnitude(double value);
/// "5.1 ms; gl engine: 109 ms (software)": medians, for the table at the top of the page.
[[nodiscard]] std::string both_engines(const Times& cpu, const Times& gl, const Machine& machine);

/// Legends: the kinds of sites, and the colours of the directions.
[[nodiscard]] std::string voronoi_legend();
[[nodiscard]] std::string direction_legend();

/// PNG in base64.
[[nodiscard]] std::string data_url(const io::Picture& picture);

}  // namespace sdm::figures
