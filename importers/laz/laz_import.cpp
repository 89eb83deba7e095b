#include "importers/laz/laz_import.hpp"

#include <algorithm>
#include <atomic>
#include <optional>

#include "files/bytes.hpp"
#include "importers/in_order.hpp"
#include "renderer/cloud/import/las/las_header.hpp"
#include "renderer/cloud/import/lost_points.hpp"

namespace scancast::import_laz {

namespace {

using laz::Chunk;
using laz::LazDecoder;
using laz::LazFile;
using laz::Wanted;

// Chunks across the file that a reader gets the first points of, to look at while the scan is decoded.
constexpr std::size_t glances = 256;
constexpr std::uint64_t pointsOfGlance = 200;
// Colours with a number above it have 16 bits.
constexpr std::uint16_t highestOf8Bits = 255;

class Import {
  public:
    /// `whole`: as many points are there, and not those that the header promises.
    Import(const LazFile& file, std::optional<std::uint64_t> whole, const ImportLimits& limits,
           PointStreamWriter& writer)
        : file_(file),
          whole_(whole),
          limits_(limits),
          writer_(writer),
          recordBytes_(file.shape().recordBytes),
          pieceBytes_(std::max<std::size_t>(
                          1, std::min<std::size_t>(limits.piece / recordBytes_, point_stream::chunkPoints)) *
                      recordBytes_),
          colorAt_(lasRecordLayout(file.shape().pointFormat).color) {}

    Expected<void> run() {
        if (auto ok = writeHead(); !ok) return ok;
        if (file_.shape().points >= limits_.fewestToGlanceAt)
            if (auto ok = writeGlances(); !ok) return ok;
        if (colorAt_ >= 0) {
            if (peak_ <= highestOf8Bits)
                if (auto ok = lookThroughColors(); !ok) return ok;
            if (auto ok = writer_.writePeak(peak_); !ok) return ok;
        }
        if (auto ok = writeAll(); !ok) return ok;
        return writer_.finish(0);
    }

  private:
    Expected<void> writeHead() {
        const auto& shape = file_.shape();
        point_stream::LasPreamble las;
        las.format = "LAZ 1." + std::to_string(shape.minorVersion) + ", point format " +
                     std::to_string(shape.pointFormat);
        if (!whole_) las.points = shape.points;
        las.head = file_.head();
        las.evlrs = file_.extendedRecords();
        if (auto ok = writer_.writeLasHeader(las); !ok || !whole_) return ok;
        return writer_.writeNote(lostPoints("it", shape.points, *whole_));
    }

    InOrderLimits threadsFor(std::size_t jobs) const {
        return {.threads = std::clamp<std::size_t>(jobs, 1, limits_.threads)};
    }

    void see(std::span<const std::byte> records) {
        std::uint16_t highest = 0;
        for (std::size_t at = static_cast<std::size_t>(colorAt_); at < records.size(); at += recordBytes_)
            for (std::size_t i = 0; i < 6; i += 2)
                highest = std::max(highest, loadLe<std::uint16_t>(records.data() + at + i));
        for (std::uint16_t before = peak_;
             before < highest && !peak_.compare_exchange_weak(before, highest);) {
        }
    }

    /// The first points of chunks that are as far apart as they can be.
    Expected<void> writeGlances() {
        const auto& chunks = file_.chunks();
        const std::size_t step = (chunks.size() - 1) / glances + 1;
        const std::size_t jobs = (chunks.size() - 1) / step + 1;
        const auto decode = [&]() -> JobWorker {
            return [&, decoder = std::make_shared<LazDecoder>(file_)](
                       std::size_t job, const GivePiece& give) -> Expected<void> {
                const Chunk& chunk = chunks[job * step];
                if (auto ok = decoder->start(chunk); !ok) return ok;
                Piece piece(static_cast<std::size_t>(std::min(chunk.points, pointsOfGlance)) * recordBytes_);
                if (auto ok = decoder->read(piece); !ok) return ok;
                if (colorAt_ >= 0) see(piece);
                give(std::move(piece));
                return {};
            };
        };
        const auto done = runInOrder(0, jobs, threadsFor(jobs), decode,
                                     [&](std::size_t, const Piece& piece) -> Expected<bool> {
                                         if (auto ok = writer_.writeGlanceOfRecords(piece); !ok)
                                             return passOn(ok);
                                         return true;
                                     });
        if (!done) return done;
        return writer_.endGlance();
    }

    /// Calls `use` with all records of a chunk, in pieces, until it returns false.
    template <class Use>
    Expected<void> decode(LazDecoder& decoder, const Chunk& chunk, const Use& use) const {
        if (auto ok = decoder.start(chunk); !ok) return ok;
        while (decoder.left() > 0) {
            Piece piece(static_cast<std::size_t>(
                std::min<std::uint64_t>(pieceBytes_, decoder.left() * recordBytes_)));
            if (auto ok = decoder.read(piece); !ok) return ok;
            if (!use(std::move(piece))) break;
        }
        return {};
    }

    /// All colours have 8 bits only if no number in the whole scan is above 255: until one is met, all have to be looked at. What is
    /// decoded for that is kept as far as there is room.
    Expected<void> lookThroughColors() {
        std::atomic<bool> keeps = true;
        std::size_t bytes = 0;
        const auto look = [&]() -> JobWorker {
            struct Decoders {
                explicit Decoders(const LazFile& file) : all(file), colors(file, Wanted::Colors) {}
                LazDecoder all, colors;
            };
            return [&, decoders = std::make_shared<Decoders>(file_)](
                       std::size_t job, const GivePiece& give) -> Expected<void> {
                if (peak_ > highestOf8Bits) return {};
                return decode(keeps ? decoders->all : decoders->colors, file_.chunks()[job],
                              [&](Piece piece) {
                                  see(piece);
                                  return (!keeps || give(std::move(piece))) && peak_ <= highestOf8Bits;
                              });
            };
        };
        const std::size_t jobs = file_.chunks().size();
        const auto done =
            runInOrder(0, jobs, threadsFor(jobs), look, [&](std::size_t job, Piece piece) -> Expected<bool> {
                if (!keeps) return true;
                bytes += piece.size();
                if (job != kept_.size() && job + 1 != kept_.size())
                    keeps = false;  // one of the jobs before kept nothing
                if (bytes > limits_.kept) keeps = false;
                if (!keeps) return true;
                if (job == kept_.size()) kept_.emplace_back();
                kept_.back().push_back(std::move(piece));
                return true;
            });
        // A chunk is kept whole or not at all.
        std::size_t whole = 0;
        while (whole < kept_.size() && isWhole(whole)) ++whole;
        kept_.resize(whole);
        return done;
    }

    bool isWhole(std::size_t chunk) const {
        std::size_t bytes = 0;
        for (const Piece& piece : kept_[chunk]) bytes += piece.size();
        return bytes == file_.chunks()[chunk].points * recordBytes_;
    }

    Expected<void> writeAll() {
        const std::size_t first = kept_.size(), end = file_.chunks().size();
        for (auto& chunk : kept_)
            for (Piece& piece : std::exchange(chunk, {}))
                if (auto ok = writer_.writeRecords(piece); !ok) return ok;
        const auto all = [&]() -> JobWorker {
            return
                [&, decoder = std::make_shared<LazDecoder>(file_)](std::size_t job, const GivePiece& give) {
                    return decode(*decoder, file_.chunks()[job], give);
                };
        };
        if (first == end) return {};
        return runInOrder(first, end, threadsFor(end - first), all,
                          [&](std::size_t, const Piece& piece) -> Expected<bool> {
                              if (auto ok = writer_.writeRecords(piece); !ok) return passOn(ok);
                              return true;
                          });
    }

    const LazFile& file_;
    const std::optional<std::uint64_t> whole_;
    const ImportLimits& limits_;
    PointStreamWriter& writer_;
    const std::size_t recordBytes_, pieceBytes_;
    const int colorAt_;  // in a record; -1: it has none
    std::atomic<std::uint16_t> peak_ = 0;
    std::vector<std::vector<Piece>> kept_;  // of the first chunks
};

}  // namespace

Expected<void> importLaz(std::shared_ptr<const laz::RandomAccess> bytes, const ImportLimits& limits,
                         PointStreamWriter& writer) {
    auto file = LazFile::open(std::move(bytes), limits.recover);
    if (!file) return passOn(file);
    if (!file->shape().compressed)
        return fail(ErrorCode::Unsupported,
                    "byte 104: it is LAS, not LAZ; Scancast reads that without this program");
    std::optional<std::uint64_t> whole;
    if (limits.recover) {
        const auto kept = file->keepWhole();
        if (!kept) return passOn(kept);
        if (*kept < file->shape().points) whole = *kept;
    }
    return Import(*file, whole, limits, writer).run();
}

}  // namespace scancast::import_laz
