// The points of one scan, block by block, as columns of numbers: its section's packets taken apart. Owned and used by one
// thread; the file must outlive it. Pipeline: pages → **packets → columns** → points.
//
// Of a file that is to be recovered, it leaves out the records whose wanted bytes lie in pages that are damaged or not there. How many
// bytes each field has in a packet stands in the packet's head: as long as heads are sound, so is the place of every record behind the
// damage. Behind a head that is not, nobody knows where the next one is, and the scan ends.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
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
    Expected<std::size_t> next() { return takeBlock(true); }
    /// In the place of all of them: how many there are, without decoding any.
    Expected<std::uint64_t> countWhole();
    /// Behind the last, where there were less than the scan promises: "scan 3 is damaged at byte 2,048", or that it ends too early.
    std::string loss() const;
    bool isCut() const;
    /// Of the last block; empty for a field that was not wanted.
    std::span<const double> column(int field) const;

  private:
    RecordReader(PagedFile& file, const ScanDescription& scan, std::span<const int> wanted,
                 std::string called);
    Expected<void> readSectionHead();
    Expected<void> readSound(std::uint64_t at, std::span<std::byte> into);
    Expected<void> readPacket();
    Expected<void> readStreams(std::size_t bytes);
    Expected<std::size_t> takeBlock(bool decode);
    void leaveOutLost(bool decode);
    void meetLoss(std::uint64_t at);
    void stopAt(std::uint64_t at);
    /// Records that are there of all wanted fields, at most so many.
    std::uint64_t available(std::uint64_t most) const;
    tl::unexpected<Error> wrong(std::uint64_t at, const std::string& reason) const;

    struct Records {
        std::uint64_t begin, end;
    };
    struct Wanted {
        std::size_t field;
        PackedColumn packed;
        std::vector<double> values;
        std::uint64_t bytes = 0;     ///< of its stream, so far
        std::deque<Records> lost{};  ///< in order, behind those that were taken
    };
    void append(Wanted& one, std::size_t from, std::size_t length);

    PagedFile* file_;
    std::string called_;
    std::uint64_t section_, records_;
    std::uint64_t readable_;  ///< of the records; less where so many cannot be in what is there of the file
    std::size_t fieldCount_;
    std::size_t waitingBytes_ = mostWaiting;
    std::uint64_t recordBits_ = 0;  ///< of all fields
    std::vector<Wanted> wanted_;
    std::vector<int> wantedOf_;       ///< index in wanted_, by field; -1 = none
    std::uint64_t at_ = 0, end_ = 0;  ///< the next packet, the section's end; logical
    std::uint64_t taken_ = 0;
    std::size_t block_ = 0;
    std::vector<std::byte> packet_;
    std::vector<LostBytes> lostBytes_;        ///< of what was read last
    std::optional<std::uint64_t> firstLoss_;  ///< logical
    bool stopped_ = false;                    ///< nobody knows where the next packet is
    std::vector<bool> whole_;                 ///< of the block
};

}  // namespace scancast::import_e57
