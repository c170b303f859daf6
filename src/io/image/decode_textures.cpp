#include <fmt/format.h>
#include <sdm/bake_files.h>
#include <sdm/error.h>
#include <sdm/threads.h>

#include <functional>
#include <new>

#include "core/excerpt.h"
#include "core/memory.h"

namespace sdm {

std::vector<Image> decode_textures(std::span<const TextureFile> textures,
                                   std::vector<std::string>& notes) try {
  std::vector<Image> images(textures.size());
  std::vector<std::string> faults(textures.size());
  std::vector<std::function<void()>> tasks;
  for (std::size_t i = 0; i < textures.size(); ++i)
    tasks.emplace_back([&, i] {
      try {
        images[i] = decode_image(textures[i].bytes);
      } catch (const Cancelled&) {
        throw;
      } catch (const Error& error) {
        faults[i] = error.what();
      }
    });
  run_concurrently(tasks);
  for (std::size_t i = 0; i < textures.size(); ++i)
    if (!faults[i].empty())
      notes.push_back(fmt::format("the texture {} is left out: {}", excerpt(textures[i].name), faults[i]));
  return images;
} catch (const std::bad_alloc&) {
  throw out_of_memory("the textures");
}

}  // namespace sdm
