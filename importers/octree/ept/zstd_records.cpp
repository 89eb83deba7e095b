#include "importers/octree/ept/zstd_records.hpp"

#include <fmt/format.h>
#include <zstd.h>

#include <algorithm>
#include <memory>
#include <utility>

#include "renderer/cloud/import/printable_text.hpp"

namespace scancast::import_octree {

namespace {

constexpr std::size_t inputBytes = std::size_t(128) << 10;
constexpr int largestWindow = 27;  // 128 MiB, as the zstd program takes without being asked

struct FreeContext {
    void operator()(ZSTD_DCtx* context) const { ZSTD_freeDCtx(context); }
};

/// The bytes of one tile, front to back.
class ZstdBytes {
  public:
    ZstdBytes(const TreeFile& file, const std::string& tile)
        : file_(file), tile_(tile), context_(ZSTD_createDCtx()) {
        if (!context_) throw std::bad_alloc();
        ZSTD_DCtx_setParameter(context_.get(), ZSTD_d_windowLogMax, largestWindow);
    }

    /// Fills `into` as far as there are bytes; how many.
    Expected<std::size_t> read(std::span<std::byte> into) {
        ZSTD_outBuffer out{into.data(), into.size(), 0};
        while (out.pos < out.size) {
            if (in_.pos == in_.size && at_ < file_.bytes())
                if (auto ok = refill(); !ok) return passOn(ok);
            const auto before = std::pair(in_.pos, out.pos);
            const auto left = ZSTD_decompressStream(context_.get(), &out, &in_);
            if (ZSTD_isError(left))
                return fail(ErrorCode::Malformed,
                            fmt::format("{} cannot be decompressed: {}", tile_, ZSTD_getErrorName(left)));
            if (std::pair(in_.pos, out.pos) == before) break;  // it is at its end
            inFrame_ = left != 0;
        }
        return out.pos;
    }

    /// At the end of its bytes: whether a frame ended there.
    bool isComplete() const { return !inFrame_; }

  private:
    Expected<void> refill() {
        input_.resize(static_cast<std::size_t>(std::min<std::uint64_t>(inputBytes, file_.bytes() - at_)));
        if (auto ok = file_.read(at_, input_); !ok) return ok;
        at_ += input_.size();
        in_ = {input_.data(), input_.size(), 0};
        return {};
    }

    const TreeFile& file_;
    const std::string& tile_;
    std::unique_ptr<ZSTD_DCtx, FreeContext> context_;
    std::vector<std::byte> input_;
    ZSTD_inBuffer in_{nullptr, 0, 0};
    std::uint64_t at_ = 0;
    bool inFrame_ = true;
};

}  // namespace

Expected<void> readZstdRecords(const TreeFile& file, const std::string& tile, std::uint64_t points,
                               const Wanted& wanted, const RecordDecoder& decoder,
                               const Octree::TakeRecords& take) {
    const std::uint64_t bytes = decoder.recordBytes();
    ZstdBytes unpacked(file, tile);
    std::vector<std::byte> records;
    std::uint64_t done = 0;
    while (done < std::min(points, wanted.points)) {
        const auto count = std::min<std::uint64_t>(sliceRecords(decoder.recordBytes()), points - done);
        records.resize(count * bytes);
        const auto got = unpacked.read(records);
        if (!got) return passOn(got);
        if (*got < records.size()) {
            const auto code = unpacked.isComplete() ? ErrorCode::Malformed : ErrorCode::Truncated;
            return fail(code,
                        fmt::format("{} {} {} bytes; its {} points need {}", tile,
                                    unpacked.isComplete() ? "holds only" : "ends early, after",
                                    grouped(done * bytes + *got), grouped(points), grouped(points * bytes)));
        }
        const auto more = take(decoder, records);
        if (!more) return passOn(more);
        if (!*more) return {};
        done += count;
    }
    if (done < points) return {};
    std::byte further{};
    const auto got = unpacked.read({&further, 1});
    if (!got) return passOn(got);
    if (*got > 0)
        return fail(ErrorCode::Malformed, fmt::format("{} holds more bytes than its {} points need ({})",
                                                      tile, grouped(points), grouped(points * bytes)));
    return {};
}

std::uint64_t zstdMemory(std::uint64_t recordsBytes) {
    // Window, its input and what the library keeps of a frame.
    return std::min(recordsBytes, std::uint64_t(1) << largestWindow) + (std::uint64_t(1) << 20);
}

}  // namespace scancast::import_octree
