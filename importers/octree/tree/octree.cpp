#include "importers/octree/tree/octree.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "importers/octree/tree/piece_runner.hpp"
#include "renderer/cloud/import/printable_text.hpp"

namespace scancast::import_octree {

namespace {

constexpr std::uint64_t mostSliceBytes = std::uint64_t(4) << 20;
constexpr std::uint64_t sampleBytes = 48;  // position, colour, intensity, classification, normal

}  // namespace

std::size_t sliceRecords(std::uint32_t recordBytes) {
    // Twice: the record, and the further columns that its numbers may become.
    const auto fits = mostSliceBytes / (2 * std::uint64_t(recordBytes) + sampleBytes);
    return static_cast<std::size_t>(std::clamp<std::uint64_t>(fits, 1, PointSource::batchPoints));
}

std::uint64_t slicesMemory(std::uint32_t recordBytes, std::uint64_t points) {
    const auto there = std::min<std::uint64_t>(points, (mostWaiting + 2) * sliceRecords(recordBytes));
    return there * (2 * std::uint64_t(recordBytes) + sampleBytes);
}

Expected<void> readPlainRecords(const TreeFile& file, std::uint64_t at, std::uint64_t points,
                                const Wanted& wanted, const RecordDecoder& decoder,
                                const Octree::TakeRecords& take) {
    const std::uint64_t bytes = decoder.recordBytes();
    const auto end = std::min(points, wanted.points);
    std::vector<std::byte> records;
    for (std::uint64_t done = 0; done < end;) {
        const auto count = std::min<std::uint64_t>(sliceRecords(decoder.recordBytes()), end - done);
        records.resize(count * bytes);
        if (auto ok = file.read(at + done * bytes, records); !ok) return ok;
        const auto more = take(decoder, records);
        if (!more) return passOn(more);
        if (!*more) return {};
        done += count;
    }
    return {};
}

void takeDeclaredPoints(const std::string& entry, std::optional<std::uint64_t> said, std::uint64_t held,
                        ScanHeader& header, std::vector<std::string>& notes) {
    if (!said) return;
    if (*said == held) {
        header.points = held;
        return;
    }
    notes.push_back(fmt::format("{} says {} points, the octree's files hold {}; these were read", entry,
                                grouped(*said), grouped(held)));
}

}  // namespace scancast::import_octree
