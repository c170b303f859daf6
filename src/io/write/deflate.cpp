#include "io/write/deflate.h"

#include <libdeflate.h>
#include <zlib.h>

#include <algorithm>
#include <new>
#include <stdexcept>
#include <utility>

namespace sdm::io {
namespace {

constexpr std::size_t kBlock = std::size_t{1} << 20;
constexpr int kLevel = 1;  // three times as fast as the default for a few percent of size

using Compressor = std::unique_ptr<libdeflate_compressor, decltype(&libdeflate_free_compressor)>;

}  // namespace

bool deflate(std::span<const std::uint8_t> bytes, std::vector<std::uint8_t>& compressed) {
  const Compressor compressor(libdeflate_alloc_compressor(kLevel), &libdeflate_free_compressor);
  if (!compressor) throw std::bad_alloc();
  const std::size_t size = libdeflate_zlib_compress(compressor.get(), bytes.data(), bytes.size(),
                                                    compressed.data(), compressed.size());
  if (size > 0) compressed.resize(size);
  return size > 0;
}

// libdeflate has no streams.
struct DeflateStream::Impl {
  Sink sink;
  z_stream stream{};
  std::vector<std::uint8_t> block = std::vector<std::uint8_t>(kBlock);

  explicit Impl(Sink to) : sink(std::move(to)) {
    if (deflateInit(&stream, kLevel) != Z_OK) throw std::bad_alloc();
    set_output();
  }
  ~Impl() { deflateEnd(&stream); }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  void set_output() {
    stream.next_out = block.data();
    stream.avail_out = static_cast<uInt>(block.size());
  }
  // Compresses the input, and hands out full blocks; with Z_FINISH, the last one too.
  void run(int flush) {
    for (;;) {
      const int result = ::deflate(&stream, flush);
      if (result == Z_STREAM_ERROR) throw std::logic_error("zlib refuses its parameters");
      const bool full = stream.avail_out == 0, ended = result == Z_STREAM_END;
      if (full || ended) {
        sink(std::span(block).first(block.size() - stream.avail_out));
        set_output();
      }
      if (ended || (!full && flush == Z_NO_FLUSH)) return;
    }
  }
};

DeflateStream::DeflateStream(Sink sink) : impl_(std::make_unique<Impl>(std::move(sink))) {}
DeflateStream::~DeflateStream() = default;

void DeflateStream::write(std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const auto part = bytes.first(std::min(bytes.size(), kBlock));
    bytes = bytes.subspan(part.size());
    impl_->stream.next_in = const_cast<std::uint8_t*>(part.data());  // not written to
    impl_->stream.avail_in = static_cast<uInt>(part.size());
    impl_->run(Z_NO_FLUSH);
  }
}

void DeflateStream::finish() {
  impl_->run(Z_FINISH);
}

}  // namespace sdm::io
