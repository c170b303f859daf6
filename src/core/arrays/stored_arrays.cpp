#include "core/arrays/stored_arrays.h"

#include <sdm/error.h>

#include <algorithm>
#include <bit>
#include <string>

#include "core/checksum.h"
#include "core/parallel.h"

namespace sdm::core {
namespace {

static_assert(std::endian::native == std::endian::little, "the order of the stored bytes");

constexpr std::size_t kAlignment = 64;
constexpr std::size_t kPart = std::size_t{1} << 18;  // bytes, of which each has a checksum

struct StoredHeader {
  std::array<char, 8> magic;
  std::uint32_t version;
  std::uint32_t arrays;
  std::uint64_t size;      // of the block
  std::uint64_t checksum;  // of all else
};
static_assert(sizeof(StoredHeader) == 32, "no padding");

constexpr std::size_t aligned(std::size_t offset) {
  return (offset + kAlignment - 1) / kAlignment * kAlignment;
}

// The checksum of a header, and of those of the parts of what follows it.
std::uint64_t whole_checksum(StoredHeader header, std::span<const std::uint64_t> parts) {
  header.checksum = 0;
  Checksum sum;
  sum.add(std::span<const StoredHeader>(&header, 1));
  sum.add(parts);
  return sum.value();
}

std::uint64_t part_checksum(std::span<const std::byte> bytes) {
  return XXH3_64bits(bytes.data(), bytes.size());
}

std::uint64_t block_checksum(const StoredHeader& header, std::span<const std::byte> bytes) {
  bytes = bytes.subspan(sizeof header);
  std::vector<std::uint64_t> parts((bytes.size() + kPart - 1) / kPart);
  parallel_for(parts.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      parts[i] = part_checksum(bytes.subspan(i * kPart).first(std::min(kPart, bytes.size() - i * kPart)));
  });
  return whole_checksum(header, parts);
}

// Bytes that arrive in pieces, of whose parts the checksums are taken.
class PartSums {
 public:
  void add(std::span<const std::byte> bytes) {
    while (!bytes.empty()) {
      const std::span<const std::byte> taken = bytes.first(std::min(bytes.size(), kPart - filled_));
      sum_.add(taken);
      filled_ += taken.size();
      bytes = bytes.subspan(taken.size());
      if (filled_ == kPart) end_part();
    }
  }
  std::vector<std::uint64_t> finish() {
    if (filled_ > 0) end_part();
    return std::move(sums_);
  }

 private:
  void end_part() {
    sums_.push_back(sum_.value());
    sum_ = {};
    filled_ = 0;
  }

  Checksum sum_;
  std::size_t filled_ = 0;
  std::vector<std::uint64_t> sums_;
};

}  // namespace

void ArrayWriter::add(const void* data, std::size_t count, std::size_t item_size) {
  parts_.push_back({data, count, static_cast<std::uint32_t>(item_size)});
}

// Goes through the bytes twice: the checksum stands before them.
void ArrayWriter::write(const StoredFormat& format,
                        const std::function<void(std::span<const std::byte>)>& write) const {
  std::vector<ArrayReader::Entry> table;
  for (const Part& part : parts_) table.push_back({part.count, part.item_size});
  StoredHeader header{format.magic, format.version, static_cast<std::uint32_t>(table.size()), 0, 0};
  const std::span<const std::byte> table_bytes = std::as_bytes(std::span(table));
  // Calls visit(bytes) for all that follows the header, and returns the size of the block.
  const auto for_each_piece = [&](const auto& visit) {
    static constexpr std::array<std::byte, kAlignment> kPadding{};
    visit(table_bytes);
    std::size_t offset = sizeof header + table_bytes.size();
    for (const Part& part : parts_) {
      visit(std::span<const std::byte>(kPadding).first(aligned(offset) - offset));
      const std::size_t size = part.count * part.item_size;
      visit({static_cast<const std::byte*>(part.data), size});
      offset = aligned(offset) + size;
    }
    return offset;
  };
  PartSums sums;
  header.size = for_each_piece([&](std::span<const std::byte> bytes) { sums.add(bytes); });
  header.checksum = whole_checksum(header, sums.finish());
  write(std::as_bytes(std::span(&header, 1)));
  for_each_piece([&](std::span<const std::byte> bytes) {
    if (!bytes.empty()) write(bytes);
  });
}

ArrayReader::ArrayReader(StoredBytes stored, const StoredFormat& format)
    : stored_(std::move(stored)), format_(format) {
  const std::string object = format.object;
  const std::span<const std::byte> bytes = stored_.bytes;
  StoredHeader header;
  if (bytes.size() < sizeof header || std::memcmp(bytes.data(), format.magic.data(), 8) != 0)
    throw Error("this is not a stored " + object);
  std::memcpy(&header, bytes.data(), sizeof header);
  if (header.version != format.version)
    throw Error("another version of sdm has stored the " + object + " (format " +
                std::to_string(header.version) + " instead of " + std::to_string(format.version) +
                "); build it again from its " + format.source);
  if (header.size > bytes.size())
    throw Error("the stored " + object + " is incomplete: " + std::to_string(bytes.size()) + " of " +
                std::to_string(header.size) + " bytes; build it again from its " + format.source);
  if (header.size < bytes.size() || block_checksum(header, bytes) != header.checksum) fail();
  if (header.arrays > (bytes.size() - sizeof header) / sizeof(Entry)) fail();
  table_ = {reinterpret_cast<const Entry*>(bytes.data() + sizeof header), header.arrays};
  offset_ = sizeof header + table_.size_bytes();
}

std::span<std::byte> ArrayReader::take(std::size_t item_size) {
  if (next_ == table_.size()) fail();
  const Entry entry = table_[next_++];
  const std::size_t begin = aligned(offset_), whole = stored_.bytes.size();
  if (entry.item_size != item_size || begin > whole || entry.count > (whole - begin) / item_size) fail();
  offset_ = begin + entry.count * item_size;
  return stored_.bytes.subspan(begin, entry.count * item_size);
}

void ArrayReader::finish() const {
  if (next_ != table_.size() || offset_ != stored_.bytes.size()) fail();
}

void ArrayReader::fail() const {
  throw Error("the stored " + std::string(format_.object) + " is damaged; build it again from its " +
              format_.source);
}

}  // namespace sdm::core
