#include "io/mesh/read_mtl.h"

#include <fmt/format.h>
#include <sdm/error.h>
#include <sdm/mesh_attributes.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "core/parse_number.h"
#include "io/file/text_scanner.h"

namespace sdm::io {
namespace {

// An option of a picture, and the most arguments that it takes. Those of numbers may be fewer.
struct PictureOption {
  std::string_view name;
  std::size_t arguments;
  bool numbers;
};
constexpr PictureOption kPictureOptions[] = {
    {"-blendu", 1, false},  {"-blendv", 1, false}, {"-cc", 1, false},     {"-clamp", 1, false},
    {"-imfchan", 1, false}, {"-type", 1, false},   {"-texres", 1, false}, {"-bm", 1, true},
    {"-boost", 1, true},    {"-mm", 2, true},      {"-o", 3, true},       {"-s", 3, true},
    {"-t", 3, true}};

// Pictures that are not read, and why.
struct Unread {
  std::string_view statement;
  const char* why;
};
constexpr Unread kUnread[] = {{"map_d", "opacity is read as a number (d), or as the alpha of map_Kd"},
                              {"map_Tr", "opacity is read as a number (Tr), or as the alpha of map_Kd"},
                              {"map_Pr", "roughness is read as a number (Pr)"},
                              {"map_Pm", "metal is read as a number (Pm)"},
                              {"map_Bump", "heights are not read, only normals (norm)"},
                              {"map_bump", "heights are not read, only normals (norm)"},
                              {"bump", "heights are not read, only normals (norm)"},
                              {"disp", "displacements are not read"},
                              {"decal", "decals are not read"}};

class MtlReader {
 public:
  MtlReader(std::string_view text, const std::filesystem::path& folder, PolygonMaterials& materials)
      : in_(text), folder_(folder), materials_(materials) {}

  void read() {
    for (; !in_.at_end(); in_.skip_line()) {
      if (!in_.more_on_line()) continue;
      if (in_.accept("newmtl"))
        begin();
      else if (!materials_.list.empty())
        try {
          read_statement(materials_.list.back());
        } catch (const Cancelled&) {
          throw;
        } catch (const Error& fault) {
          leave_out("a statement", fault.what());
        }
    }
  }

 private:
  void begin() {
    materials_.list.emplace_back().name = words_of_line();
    diffuse_.reset();
    emitted_.reset();
  }
  void read_statement(Material& material) {
    if (in_.accept("Kd")) {
      diffuse_ = light();
      if (!is_replaced("Kd", "map_Kd", diffuse_, material.base_color_texture))
        std::ranges::copy(*diffuse_, material.base_color.begin());
    } else if (in_.accept("Ke")) {
      emitted_ = light();
      if (!is_replaced("Ke", "map_Ke", emitted_, material.emissive_texture)) material.emissive = *emitted_;
    } else if (in_.accept("d")) {
      set_opacity(material, factor());
    } else if (in_.accept("Tr")) {
      set_opacity(material, 1 - factor());
    } else if (in_.accept("Pm")) {
      material.metallic = factor();
    } else if (in_.accept("Pr")) {
      material.roughness = factor();
    } else if (in_.accept("map_Kd")) {
      if (read_texture("map_Kd", material.base_color_texture)) {
        std::fill_n(material.base_color.begin(), 3, 1.f);
        (void)is_replaced("Kd", "map_Kd", diffuse_, material.base_color_texture);
      }
    } else if (in_.accept("map_Ke")) {
      if (read_texture("map_Ke", material.emissive_texture)) {
        material.emissive = {1, 1, 1};
        (void)is_replaced("Ke", "map_Ke", emitted_, material.emissive_texture);
      }
    } else if (in_.accept("norm")) {
      read_texture("norm", material.normal_texture);
    } else {
      for (const Unread& unread : kUnread)
        if (in_.accept(unread.statement)) return leave_out(unread.statement, unread.why);
    }
  }

  // Whether a picture stands for the colour, which is noted where it would darken the picture.
  bool is_replaced(const char* statement, const char* picture,
                   const std::optional<std::array<float, 3>>& color, const TextureUse& use) {
    if (use.texture == kNone) return false;
    if (color && *color != std::array<float, 3>{1, 1, 1})
      leave_out(statement, fmt::format("the picture of {} replaces it", picture));
    return true;
  }

  static void set_opacity(Material& material, float alpha) {
    material.base_color[3] = alpha;
    material.alpha_mode = alpha < 1 ? AlphaMode::blend : AlphaMode::opaque;
  }

  float factor() {
    const double number = in_.number();
    if (!std::isfinite(number)) throw Error("a number is infinite or NaN");
    return static_cast<float>(std::clamp(number, 0.0, 1.0));
  }

  std::array<float, 3> light() {
    std::array<float, 3> color{};
    color.fill(linear_light(factor()));
    for (std::size_t k = 1; k < 3 && in_.more_on_line(); ++k) color[k] = linear_light(factor());
    return color;
  }

  // As of usemtl.
  std::string words_of_line() {
    std::string text;
    while (in_.more_on_line()) text.append(text.empty() ? "" : " ").append(in_.word());
    return text;
  }

  bool read_texture(const char* statement, TextureUse& use) {
    TextureUse read;
    std::string name = options_and_name(read);
    std::ranges::replace(name, '\\', '/');
    try {
      read.texture = materials_.texture_in_file(folder_, name);
      use = read;
      return true;
    } catch (const Cancelled&) {
      throw;
    } catch (const Error& fault) {
      leave_out(statement, fault.what());
      return false;
    }
  }
  void leave_out(std::string_view statement, std::string_view fault) {
    materials_.leave_out(statement, materials_.list.back().name, fault);
  }

  std::string options_and_name(TextureUse& use) {
    while (in_.more_on_line()) {
      TextScanner after = in_;
      const std::string_view word = after.word();
      const PictureOption* const option = std::ranges::find(kPictureOptions, word, &PictureOption::name);
      if (option == std::end(kPictureOptions)) return std::string(in_.rest_of_line());
      in_ = after;
      if (!option->numbers) {
        if (in_.more_on_line() && in_.word() == "on" && option->name == "-clamp")
          use.wrap = {TextureWrap::clamp, TextureWrap::clamp};
        continue;
      }
      for (std::size_t i = 0; i < option->arguments; ++i) {
        const auto number = next_number();
        if (!number) break;
        if (i < 2 && option->name == "-s") use.place[i][i] = *number;
        if (i < 2 && option->name == "-o") use.place[i][2] = *number;
      }
    }
    return {};
  }

  // Reads the next word if it is a number: the name of a file may begin with one.
  std::optional<double> next_number() {
    if (!in_.more_on_line()) return std::nullopt;
    TextScanner after = in_;
    const std::optional<double> number = parse_number(after.word());
    if (number) in_ = after;
    return number;
  }

  TextScanner in_;
  const std::filesystem::path& folder_;
  PolygonMaterials& materials_;
  std::optional<std::array<float, 3>> diffuse_, emitted_;  // Kd and Ke of the last material
};

}  // namespace

void read_mtl(std::string_view text, const std::filesystem::path& folder, PolygonMaterials& materials) {
  MtlReader(text, folder, materials).read();
}

}  // namespace sdm::io
