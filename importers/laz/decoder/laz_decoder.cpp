#include <algorithm>
#include <cstring>

#include "files/bytes.hpp"
#include "importers/laz/decoder/items/item_decoder.hpp"
#include "importers/laz/decoder/laz_file.hpp"

namespace scancast::laz {

namespace {

// A chunk of up to so many bytes is read at once; of a longer one, each stream on its own, so much together.
constexpr std::uint64_t streamBytes = 1U << 20;
constexpr std::size_t leastWindow = 256, mostWindow = 65536;
// Points between two looks at whether the streams are still sound.
constexpr std::uint64_t stride = 256;

tl::unexpected<Error> damaged(const Chunk& chunk, std::uint64_t point, const std::string& reason) {
    return fail(ErrorCode::Malformed, "the chunk of " + grouped(chunk.points) + " points at byte " +
                                          grouped(chunk.at) + " (" + grouped(chunk.bytes) +
                                          " bytes) is damaged near its point " + grouped(point) + ": " +
                                          reason);
}

}  // namespace

/// What Pointwise, layered and plain records have in common: pieces that start with a whole record.
class LazDecoder::Work {
  public:
    explicit Work(const LazFile& file) : file_(file), recordBytes_(file.shape().recordBytes) {}
    virtual ~Work() = default;

    Expected<void> start(const Chunk& chunk) {
        chunk_ = chunk;
        done_ = 0;
        pieceLeft_ = 0;
        pieceAt_ = chunk.at;
        return open();
    }
    std::uint64_t left() const { return chunk_.points - done_; }
    virtual bool ranDry() const { return false; }

    Expected<void> read(std::span<std::byte> records) {
        for (std::uint64_t count = std::min(records.size() / recordBytes_, left()); count > 0;) {
            if (pieceLeft_ == 0) {
                pieceLeft_ = chunk_.restart > 0 ? std::min(chunk_.restart, left()) : left();
                if (const auto ok = begin(records.first(recordBytes_)); !ok) return ok;
                records = advance(records, 1);
                --count;
            }
            const std::uint64_t now = std::min({count, pieceLeft_, stride});
            if (now > 0) decode(records.data(), static_cast<std::size_t>(now));
            records = advance(records, now);
            count -= now;
            if (const auto ok = check(); !ok) return ok;
        }
        return {};
    }

  protected:
    virtual Expected<void> open() { return {}; }
    /// Begins a piece of pieceLeft_ points at pieceAt_, and reads its first record.
    virtual Expected<void> begin(std::span<std::byte> record) = 0;
    virtual void decode(std::byte* records, std::size_t count) = 0;
    virtual Expected<void> check() = 0;

    std::uint64_t limit() const { return chunk_.at + chunk_.bytes; }
    tl::unexpected<Error> damagedHere(const std::string& reason) const {
        return damaged(chunk_, done_, reason);
    }
    /// Of a stream: what has become known against it.
    Expected<void> checkStream(const ArithmeticDecoder& stream) const {
        if (stream.feed.failure()) return tl::unexpected<Error>(*stream.feed.failure());
        if (const char* const damage = stream.damage()) return damagedHere(damage);
        return {};
    }

    const LazFile& file_;
    const std::size_t recordBytes_;
    Chunk chunk_{};
    std::uint64_t done_ = 0, pieceLeft_ = 0;
    std::uint64_t pieceAt_ = 0;  // of the file

  private:
    std::span<std::byte> advance(std::span<std::byte> records, std::uint64_t count) {
        done_ += count;
        pieceLeft_ -= count;
        return records.subspan(static_cast<std::size_t>(count) * recordBytes_);
    }
};

/// Records that are not compressed.
class LazDecoder::PlainWork final : public LazDecoder::Work {
  public:
    using Work::Work;

  private:
    Expected<void> open() override {
        feed_.open(file_.bytes(), chunk_.at, limit(), mostWindow);
        return {};
    }
    Expected<void> begin(std::span<std::byte> record) override {
        feed_.take(record);
        return check();
    }
    void decode(std::byte* records, std::size_t count) override {
        feed_.take({records, count * recordBytes_});
    }
    Expected<void> check() override {
        if (feed_.failure()) return tl::unexpected<Error>(*feed_.failure());
        return {};
    }

    ByteFeed feed_;
};

/// All items in one stream.
class LazDecoder::PointwiseWork final : public LazDecoder::Work {
  public:
    explicit PointwiseWork(const LazFile& file) : Work(file) {
        for (const Item& item : file.compression().items) {
            items_.push_back({makeItemDecoder(item, stream_), bytes_});
            bytes_ += item.bytes;
        }
    }

    bool ranDry() const override { return stream_.feed.beyond() > 0; }

  private:
    struct Placed {
        std::unique_ptr<ItemDecoder> decoder;
        std::size_t at;
    };

    Expected<void> open() override {
        stream_.feed.open(file_.bytes(), chunk_.at, limit(), mostWindow);
        return {};
    }
    Expected<void> begin(std::span<std::byte> record) override {
        stream_.feed.take(record);
        for (auto& item : items_) item.decoder->start(record.data() + item.at);
        stream_.start();
        return check();
    }
    void decode(std::byte* records, std::size_t count) override {
        for (; count > 0; --count, records += recordBytes_)
            for (auto& item : items_) item.decoder->decode(records + item.at);
    }
    Expected<void> check() override {
        if (const auto ok = checkStream(stream_); !ok) return ok;
        if (left() > 0 || !chunk_.exact || stream_.feed.position() == limit()) return {};
        return damagedHere("its points end after " + grouped(stream_.feed.position() - chunk_.at) + " bytes");
    }

    ArithmeticDecoder stream_;
    std::vector<Placed> items_;
    std::size_t bytes_ = 0;
};

/// A stream for each field: one whole record, the number of points, the bytes of every layer, the layers.
class LazDecoder::LayeredWork final : public LazDecoder::Work {
  public:
    LayeredWork(const LazFile& file, Wanted wanted) : Work(file) {
        std::size_t at = 0, layers = 0;
        for (const Item& item : file.compression().items) {
            items_.push_back({makeLayeredItemDecoder(item), at, layers});
            const bool isColor = item.kind == ItemKind::Rgb14 || item.kind == ItemKind::RgbNir14;
            const std::size_t count = items_.back().decoder->layers();
            for (std::size_t i = 0; i < count; ++i)
                wanted_.push_back(wanted == Wanted::Everything || isColor || items_.back().decoder->leads(i));
            at += item.bytes;
            layers += count;
        }
        layers_ = std::vector<ArithmeticDecoder>(layers);
        head_.resize(recordBytes_ + 4 + 4 * layers);
    }

  private:
    struct Placed {
        std::unique_ptr<LayeredItemDecoder> decoder;
        std::size_t at, firstLayer;
    };

    Expected<void> begin(std::span<std::byte> record) override {
        if (limit() - pieceAt_ < head_.size())
            return damagedHere("it is shorter than the " + grouped(head_.size()) + " bytes of its head");
        if (const auto ok = readAll(file_.bytes(), pieceAt_, head_, "a chunk"); !ok) return ok;
        std::memcpy(record.data(), head_.data(), recordBytes_);
        const std::uint64_t points = loadLe<std::uint32_t>(head_.data() + recordBytes_);
        if (points != pieceLeft_) return damagedHere("it says that it has " + grouped(points) + " points");
        if (const auto ok = openLayers(); !ok) return ok;
        std::size_t channel = 0;
        for (auto& item : items_)
            item.decoder->start(record.data() + item.at,
                                std::span(layers_).subspan(item.firstLayer, item.decoder->layers()), channel);
        return {};
    }

    std::uint64_t bytesOf(std::size_t layer) const {
        return loadLe<std::uint32_t>(head_.data() + recordBytes_ + 4 + 4 * layer);
    }

    Expected<void> openLayers() {
        std::uint64_t at = pieceAt_ + head_.size();
        std::uint64_t end = at;
        std::size_t open = 0;
        for (std::size_t i = 0; i < layers_.size(); ++i) {
            end += bytesOf(i);
            if (bytesOf(i) > 0) ++open;
        }
        const bool fits = chunk_.exact ? end == limit() : end <= limit();
        if (!fits) return damagedHere("its layers would end after " + grouped(end - chunk_.at) + " bytes");
        const bool atOnce = end - at <= streamBytes;
        if (atOnce) {
            bytes_.resize(static_cast<std::size_t>(end - at));
            if (const auto ok = readAll(file_.bytes(), at, bytes_, "a chunk"); !ok) return ok;
        }
        const std::size_t window =
            std::clamp<std::size_t>(streamBytes / std::max<std::size_t>(open, 1), leastWindow, mostWindow);
        for (std::size_t i = 0; i < layers_.size(); at += bytesOf(i++)) {
            ArithmeticDecoder& layer = layers_[i];
            const std::uint64_t bytes = bytesOf(i);
            if (bytes == 0 || !wanted_[i]) {
                layer.close();
                continue;
            }
            const std::uint64_t place = at - pieceAt_ - head_.size();
            if (atOnce)
                layer.feed.open(std::span(bytes_).subspan(static_cast<std::size_t>(place),
                                                          static_cast<std::size_t>(bytes)),
                                at);
            else
                layer.feed.open(file_.bytes(), at, at + bytes, window);
            layer.start();
        }
        pieceAt_ = end;
        return {};
    }

    void decode(std::byte* records, std::size_t count) override {
        for (; count > 0; --count, records += recordBytes_) {
            std::size_t channel = 0;
            for (auto& item : items_) item.decoder->decode(records + item.at, channel);
        }
    }

    Expected<void> check() override {
        for (const ArithmeticDecoder& layer : layers_)
            if (const auto ok = checkStream(layer); !ok) return ok;
        return {};
    }

    std::vector<Placed> items_;
    std::vector<bool> wanted_;  // of layers
    std::vector<ArithmeticDecoder> layers_;
    std::vector<std::byte> head_, bytes_;
};

LazDecoder::LazDecoder(const LazFile& file, Wanted wanted) {
    switch (file.compression().compressor) {
        case Compressor::None:
            work_ = std::make_unique<PlainWork>(file);
            break;
        case Compressor::Layered:
            work_ = std::make_unique<LayeredWork>(file, wanted);
            break;
        default:
            work_ = std::make_unique<PointwiseWork>(file);
    }
}

LazDecoder::~LazDecoder() = default;
LazDecoder::LazDecoder(LazDecoder&&) noexcept = default;

Expected<void> LazDecoder::start(const Chunk& chunk) {
    return work_->start(chunk);
}
std::uint64_t LazDecoder::left() const {
    return work_->left();
}
bool LazDecoder::ranDry() const {
    return work_->ranDry();
}
Expected<void> LazDecoder::read(std::span<std::byte> records) {
    return work_->read(records);
}

Expected<void> decodeChunk(const LazFile& file, const Chunk& chunk, std::span<std::byte> records) {
    LazDecoder decoder(file);
    if (const auto ok = decoder.start(chunk); !ok) return ok;
    return decoder.read(records);
}

}  // namespace scancast::laz
