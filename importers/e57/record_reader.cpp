#include "importers/e57/record_reader.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "files/bytes.hpp"
#include "renderer/cloud/import/printable_text.hpp"

namespace scancast::import_e57 {

namespace {

constexpr std::size_t sectionHeadBytes = 32;
constexpr std::size_t packetHeadBytes = 6;
constexpr std::size_t longestPacket = 65536;
constexpr std::uint64_t mostRecordsPerByte =
    1000;  ///< where nearly all is constant; the stream's reader has the same limit
enum SectionType : std::uint8_t { compressedVector = 1 };
enum PacketType : std::uint8_t { indexPacket = 0, dataPacket = 1, ignoredPacket = 2 };

}  // namespace

RecordReader::RecordReader(PagedFile& file, const ScanDescription& scan, std::span<const int> wanted,
                           std::string called)
    : file_(&file),
      called_(std::move(called)),
      section_(scan.section),
      records_(scan.records),
      readable_(scan.records),
      fieldCount_(scan.fields.size()),
      wantedOf_(scan.fields.size(), -1),
      packet_(longestPacket) {
    for (const auto& field : scan.fields)
        if (field.encoding != Encoding::Other) recordBits_ += field.bits;
    for (const int index : wanted) {
        const auto field = static_cast<std::size_t>(index);
        if (wantedOf_[field] >= 0) continue;
        wantedOf_[field] = static_cast<int>(wanted_.size());
        wanted_.push_back({field, PackedColumn(scan.fields[field]), std::vector<double>(blockRecords)});
    }
}

tl::unexpected<Error> RecordReader::wrong(std::uint64_t at, const std::string& reason) const {
    return fail(ErrorCode::Malformed,
                fmt::format("byte {}: {}: {}", grouped(PagedFile::physicalOffset(at)), called_, reason));
}

Expected<RecordReader> RecordReader::open(PagedFile& file, const ScanDescription& scan,
                                          std::span<const int> wanted, std::string called,
                                          std::size_t waitingBytes) {
    RecordReader reader(file, scan, wanted, std::move(called));
    reader.waitingBytes_ = waitingBytes;
    if (auto ok = reader.readSectionHead(); !ok) return passOn(ok);
    return reader;
}

Expected<void> RecordReader::readSectionHead() {
    const auto begin = file_->logicalOffset(section_, called_ + ": its points' section");
    if (!begin) return passOn(begin);
    std::array<std::byte, sectionHeadBytes> head{};
    if (auto ok = readSound(*begin, head); !ok) return ok;
    if (!lostBytes_.empty()) {
        stopAt(*begin + lostBytes_.front().begin);
        readable_ = 0;
        return {};
    }
    if (loadLe<std::uint8_t>(head.data()) != compressedVector)
        return wrong(*begin, fmt::format("its points should begin here, but what does is of type {}, not 1",
                                         loadLe<std::uint8_t>(head.data())));
    const auto bytes = loadLe<std::uint64_t>(head.data() + 8);
    if (bytes < sectionHeadBytes || bytes > file_->logicalBytes() - *begin)
        return wrong(*begin,
                     fmt::format("its points are said to take {} bytes; there are {} to the file's end",
                                 grouped(bytes), grouped(file_->logicalBytes() - *begin)));
    end_ = *begin + bytes;
    if (records_ == 0) return {};
    const auto data =
        file_->logicalOffset(loadLe<std::uint64_t>(head.data() + 16), called_ + ": its first packet");
    if (!data) return passOn(data);
    at_ = *data;
    if (at_ < *begin + sectionHeadBytes || at_ >= end_)
        return wrong(*begin, "its first packet lies outside of its section");
    // Divided, not multiplied: what is declared can be anything.
    const auto room = end_ - at_;
    const bool fits = recordBits_ == 0
                          ? records_ / mostRecordsPerByte <= room
                          : records_ <= std::min(room * 8 / recordBits_, room * mostRecordsPerByte);
    if (!fits)
        return wrong(*begin, fmt::format("{} points of {} bits are promised, and there are {} bytes for them",
                                         grouped(records_), recordBits_, grouped(room)));
    const auto there = std::max(file_->logicalBytesThere(), at_) - at_;
    if (there < room && readable_ / mostRecordsPerByte >= there) readable_ = there * mostRecordsPerByte;
    return {};
}

Expected<void> RecordReader::readSound(std::uint64_t at, std::span<std::byte> into) {
    auto ok = file_->readSound(at, into, lostBytes_);
    if (!ok && ok.error().code == ErrorCode::Malformed)
        ok.error().message += "; ingest --recover reads what is whole";
    return ok;
}

void RecordReader::meetLoss(std::uint64_t at) {
    if (!firstLoss_) firstLoss_ = at;
}

void RecordReader::stopAt(std::uint64_t at) {
    meetLoss(at);
    stopped_ = true;
}

bool RecordReader::isCut() const {
    return !firstLoss_ || *firstLoss_ >= file_->logicalBytesThere();
}

std::string RecordReader::loss() const {
    if (isCut()) return called_ + " ends too early";
    return fmt::format("{} is damaged at byte {}", called_,
                       grouped(*firstLoss_ / PagedFile::contentBytes * PagedFile::pageBytes));
}

Expected<void> RecordReader::readPacket() {
    if (end_ - at_ < packetHeadBytes) {
        if (file_->recovers()) {
            stopped_ = true;
            return {};
        }
        return fail(ErrorCode::Truncated,
                    fmt::format("byte {}: {}: its points end here: {} are promised, there are {}",
                                grouped(PagedFile::physicalOffset(at_)), called_, grouped(records_),
                                grouped(taken_ + available(records_ - taken_))));
    }
    auto* const packet = packet_.data();
    if (auto ok = readSound(at_, std::span(packet_).first(packetHeadBytes)); !ok) return ok;
    if (!lostBytes_.empty()) {
        stopAt(at_ + lostBytes_.front().begin);
        return {};
    }
    const auto type = loadLe<std::uint8_t>(packet);
    const std::size_t bytes = std::size_t(loadLe<std::uint16_t>(packet + 2)) + 1;
    if (type > ignoredPacket) return wrong(at_, fmt::format("a packet of type {}, which is not known", type));
    if (bytes < packetHeadBytes || bytes % 4 != 0 || bytes > end_ - at_)
        return wrong(at_, fmt::format("a packet of {} bytes cannot be here", bytes));
    if (type == dataPacket)
        if (auto ok = readStreams(bytes); !ok) return ok;
    at_ += bytes;
    return {};
}

Expected<void> RecordReader::readStreams(std::size_t bytes) {
    if (auto ok = readSound(at_, std::span(packet_).first(bytes)); !ok) return ok;
    const auto* const packet = packet_.data();
    const std::size_t streams = loadLe<std::uint16_t>(packet + 4);
    if (streams != fieldCount_)
        return wrong(at_, fmt::format("a packet with {} bytestreams, and points with {} fields", streams,
                                      fieldCount_));
    std::size_t from = packetHeadBytes + 2 * streams;
    if (!lostBytes_.empty() && lostBytes_.front().begin < from) {
        stopAt(at_ + lostBytes_.front().begin);
        return {};
    }
    std::size_t waiting = 0;
    for (std::size_t i = 0; i < streams; ++i) {
        // Those of a packet that is too short for its lengths are what the buffer held before, and too long.
        const std::size_t length = loadLe<std::uint16_t>(packet + packetHeadBytes + 2 * i);
        if (from + length > bytes) return wrong(at_, "a packet whose bytestreams are longer than it");
        if (wantedOf_[i] >= 0) {
            auto& one = wanted_[static_cast<std::size_t>(wantedOf_[i])];
            append(one, from, length);
            waiting += one.packed.waiting();
        }
        from += length;
    }
    if (waiting > waitingBytes_)
        return fail(ErrorCode::ResourceLimit,
                    fmt::format("{}: some of its fields are more than {} MB ahead of others in the file",
                                called_, waitingBytes_ >> 20));
    return {};
}

void RecordReader::append(Wanted& one, std::size_t from, std::size_t length) {
    const std::uint64_t bits = one.packed.bits();
    for (const auto& lost : lostBytes_) {
        const auto begin = std::max(lost.begin, from), end = std::min(lost.end, from + length);
        if (begin >= end || bits == 0) continue;
        meetLoss(at_ + begin);
        const auto first = (one.bytes + begin - from) * 8 / bits;
        const auto last = ((one.bytes + end - from) * 8 + bits - 1) / bits;
        if (!one.lost.empty() && one.lost.back().end >= first)
            one.lost.back().end = last;
        else
            one.lost.push_back({first, last});
    }
    one.packed.append(std::span(packet_).subspan(from, length));
    one.bytes += length;
}

std::uint64_t RecordReader::available(std::uint64_t most) const {
    for (const auto& one : wanted_) most = std::min(most, one.packed.available());
    return most;
}

Expected<std::size_t> RecordReader::takeBlock(bool decode) {
    do {
        block_ = 0;
        auto most = std::min<std::uint64_t>(readable_ - taken_, blockRecords);
        while (!stopped_ && available(most) < most)
            if (auto ok = readPacket(); !ok) return passOn(ok);
        most = available(most);
        if (most == 0) return std::size_t(0);
        block_ = static_cast<std::size_t>(most);
        for (auto& one : wanted_) {
            if (decode)
                one.packed.take(std::span(one.values).first(block_));
            else
                one.packed.skip(block_);
        }
        taken_ += block_;
        leaveOutLost(decode);
    } while (block_ == 0);
    return block_;
}

void RecordReader::leaveOutLost(bool decode) {
    const auto first = taken_ - block_;
    const auto touched = [&](const Wanted& one) {
        return !one.lost.empty() && one.lost.front().begin < taken_;
    };
    if (std::none_of(wanted_.begin(), wanted_.end(), touched)) return;
    whole_.assign(block_, true);
    for (auto& one : wanted_)
        while (touched(one)) {
            const auto [begin, end] = one.lost.front();
            for (auto record = std::max(begin, first); record < std::min(end, taken_); ++record)
                whole_[static_cast<std::size_t>(record - first)] = false;
            if (end > taken_) break;
            one.lost.pop_front();
        }
    const auto count = static_cast<std::size_t>(std::count(whole_.begin(), whole_.end(), true));
    for (auto& one : wanted_) {
        std::size_t to = 0;
        for (std::size_t i = 0; decode && i < block_; ++i)
            if (whole_[i]) one.values[to++] = one.values[i];
    }
    block_ = count;
}

Expected<std::uint64_t> RecordReader::countWhole() {
    std::uint64_t whole = 0;
    for (;;) {
        const auto records = takeBlock(false);
        if (!records) return passOn(records);
        if (*records == 0) return whole;
        whole += *records;
    }
}

std::span<const double> RecordReader::column(int field) const {
    if (field < 0 || wantedOf_[static_cast<std::size_t>(field)] < 0) return {};
    return std::span(wanted_[static_cast<std::size_t>(wantedOf_[static_cast<std::size_t>(field)])].values)
        .first(block_);
}

}  // namespace scancast::import_e57
