#include <fmt/format.h>
#include <sdm/error.h>
#include <sdm/mesh_files.h>

#include <array>
#include <cmath>
#include <limits>
#include <new>
#include <string>

#include "core/memory.h"
#include "io/file/atomic_file.h"
#include "io/file/little_endian.h"
#include "io/file/npy.h"

namespace sdm {

using namespace io;

struct SequenceWriter::Impl {
  AtomicFile out;
  std::size_t vertices;
  std::uint64_t frames = 0;
  std::string bytes{};

  void write_header() {
    out.stream().seekp(0);
    out.stream() << npy_header("<f4", std::array<std::uint64_t, 3>{frames, vertices, 3});
  }
};

SequenceWriter::SequenceWriter(const std::filesystem::path& file, std::size_t vertices) try
    : impl_(new Impl{.out = AtomicFile(file), .vertices = vertices}) {
  impl_->write_header();  // rewritten by commit(), when the number of frames is known
} catch (const std::bad_alloc&) {
  throw out_of_memory("writing " + file.string());
}
SequenceWriter::~SequenceWriter() = default;
SequenceWriter::SequenceWriter(SequenceWriter&&) noexcept = default;
SequenceWriter& SequenceWriter::operator=(SequenceWriter&&) noexcept = default;

void SequenceWriter::add(std::span<const Vec3> positions) try {
  if (positions.size() != impl_->vertices)
    throw Error(fmt::format("frame {} has {} positions for {} vertices", impl_->frames, positions.size(),
                            impl_->vertices));
  impl_->bytes.clear();
  for (std::size_t v = 0; v < positions.size(); ++v)
    for (const double x : positions[v]) {
      if (!(std::abs(x) <= std::numeric_limits<float>::max()))
        throw Error(fmt::format("frame {}: vertex {} has a coordinate that float32 cannot represent",
                                impl_->frames, v));
      append_little_endian(impl_->bytes, static_cast<float>(x));
    }
  impl_->out.stream().write(impl_->bytes.data(), static_cast<std::streamsize>(impl_->bytes.size()));
  impl_->out.check();
  ++impl_->frames;
} catch (const std::bad_alloc&) {
  throw out_of_memory("writing a sequence");
}

void SequenceWriter::commit() try {
  impl_->write_header();
  impl_->out.commit();
} catch (const std::bad_alloc&) {
  throw out_of_memory("writing a sequence");
}

}  // namespace sdm
