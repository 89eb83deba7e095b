// The points of one scan, block by block, as columns of numbers: its section's packets taken apart. Owned and used by one
// thread; the file must outlive it. Pipeline: pages → **packets → columns** → points.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "importers/e57/packed_column.hpp"
#include "importers/e57/paged_file.hpp"
#include "importers/e57/scan_description.hpp"

namespace scancast::import_e57 {

class RecordReader {
  public:
    static constexpr std::size_t blockRecords = 8192;
    /// Of fields that are ahead of others in a file's packets.
    static constexpr std::size_t mostWaiting = 64 << 20;

    /// Checks the section's head, and that it can hold what it promises. `wanted`: fields to decode, by their index.
    /// Errors: Malformed, and those of the pages; sentences begin with `called`.
    static Expected<RecordReader> open(PagedFile& file, const ScanDescription& scan,
                                       std::span<const int> wanted, std::string called,
                                       std::size_t waitingBytes = mostWaiting);

    /// Decodes the next records, at most blockRecords; 0 behind the last. Errors: Malformed, Truncated when the section
    /// ends before them; ResourceLimit.
    Expected<std::size_t> next();
    /// Of the last block; empty for a field that was not wanted.
    std::span<const double> column(int field) const;

  private:
    RecordReader(PagedFile& file, const ScanDescription& scan, std::span<const int> wanted,
                 std::string called);
    Expected<void> readSectionHead();
    Expected<void> readPacket();
    /// Records that are there of all wanted fields, at most so many.
    std::uint64_t available(std::uint64_t most) const;
    tl::unexpected<Error> wrong(std::uint64_t at, const std::string& reason) const;

    struct Wanted {
        std::size_t field;
        PackedColumn packed;
        std::vector<double> values;
    };

    PagedFile* file_;
    std::string called_;
    std::uint64_t section_, records_;
    std::size_t fieldCount_;
    std::size_t waitingBytes_ = mostWaiting;
    std::uint64_t recordBits_ = 0;  ///< of all fields
    std::vector<Wanted> wanted_;
    std::vector<int> wantedOf_;       ///< index in wanted_, by field; -1 = none
    std::uint64_t at_ = 0, end_ = 0;  ///< the next packet, the section's end; logical
    std::uint64_t taken_ = 0;
    std::size_t block_ = 0;
    std::vector<std::byte> packet_;
};

}  // namespace scancast::import_e57
