#include "renderer/raster/tiff_bytes.hpp"

#include <geotiff/geotiff.h>
#include <geotiff/xtiffio.h>
#include <tiffio.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdio>
#include <utility>

#include "protocol/text/plain_text.hpp"

namespace scancast {
namespace {

static_assert(std::endian::native == std::endian::little, "cells are written as they lie in memory");

// GDAL's own tags, which other programs read, too.
constexpr ttag_t metadataTag = 42112, noDataTag = 42113;
/// The lowest float, which is no height of anything, as digits that give it back.
constexpr const char* noElevationText = "-3.4028234663852886e+38";
constexpr int deflateLevel = 6;

/// What libtiff writes to.
struct Sink {
    WriteAt write;
    std::uint64_t at = 0, end = 0;
    Expected<void> state{};
    std::string complaint{};
};

Expected<void> discard(std::uint64_t, std::span<const std::byte>) {
    return {};
}

Sink& sinkOf(thandle_t handle) {
    return *static_cast<Sink*>(handle);
}

tmsize_t readNothing(thandle_t, void*, tmsize_t) {
    return 0;
}
tmsize_t writeSome(thandle_t handle, void* data, tmsize_t size) {
    Sink& sink = sinkOf(handle);
    if (!sink.state || size < 0) return 0;
    sink.state = sink.write(sink.at, {static_cast<const std::byte*>(data), std::size_t(size)});
    if (!sink.state) return 0;
    sink.at += std::uint64_t(size);
    sink.end = std::max(sink.end, sink.at);
    return size;
}
toff_t seekTo(thandle_t handle, toff_t offset, int whence) {
    Sink& sink = sinkOf(handle);
    sink.at = offset + (whence == SEEK_CUR ? sink.at : whence == SEEK_END ? sink.end : 0);
    return sink.at;
}
int closeNothing(thandle_t) {
    return 0;
}
toff_t sizeSoFar(thandle_t handle) {
    return sinkOf(handle).end;
}

/// Nobody's standard error: what libtiff says is for the error that its call ends with.
int keepComplaint(TIFF*, void* data, const char* module, const char* format, va_list arguments) {
    std::array<char, 200> text{};
    std::vsnprintf(text.data(), text.size(), format, arguments);
    static_cast<Sink*>(data)->complaint = std::string(module ? module : "") + ": " + text.data();
    return 1;
}
int forgetWarning(TIFF*, void*, const char*, const char*, va_list) {
    return 1;
}

void addTags(TIFF* tiff) {
    static std::array<char, 13> metadata{"GDALMetadata"}, noData{"GDALNoData"};
    static const std::array<TIFFFieldInfo, 2> tags{
        TIFFFieldInfo{metadataTag, -1, -1, TIFF_ASCII, FIELD_CUSTOM, 1, 0, metadata.data()},
        TIFFFieldInfo{noDataTag, -1, -1, TIFF_ASCII, FIELD_CUSTOM, 1, 0, noData.data()}};
    TIFFMergeFieldInfo(tiff, tags.data(), std::uint32_t(tags.size()));
}

TIFF* openTiff(Sink& sink, bool big) {
    static const bool extended = [] {
        XTIFFInitialize();  // GeoTIFF's tags, for every file from now on
        return true;
    }();
    (void)extended;
    TIFFOpenOptions* const options = TIFFOpenOptionsAlloc();
    if (options == nullptr) return nullptr;
    TIFFOpenOptionsSetErrorHandlerExtR(options, keepComplaint, &sink);
    TIFFOpenOptionsSetWarningHandlerExtR(options, forgetWarning, nullptr);
    TIFF* const tiff = TIFFClientOpenExt("raster", big ? "w8l" : "wl", &sink, readNothing, writeSome, seekTo,
                                         closeNothing, sizeSoFar, nullptr, nullptr, options);
    TIFFOpenOptionsFree(options);
    return tiff;
}

std::string escaped(std::string_view text) {
    std::string xml;
    for (const char c : plainLine(text)) {
        if (c == '&')
            xml += "&amp;";
        else if (c == '<')
            xml += "&lt;";
        else if (c == '>')
            xml += "&gt;";
        else
            xml += c;
    }
    return xml;
}

/// What GDAL calls a band: its unit and what it is.
std::string metadataOf(const RasterLayout& layout) {
    std::string items;
    const auto add = [&](const char* head, std::string_view text) {
        if (text.empty()) return;
        items += head;
        items += escaped(text);
        items += "</Item>";
    };
    if (layout.kind != CellKind::Color) {
        add("<Item name=\"DESCRIPTION\" sample=\"0\" role=\"description\">", layout.value);
        if (layout.kind == CellKind::Elevation)
            add("<Item name=\"UNITTYPE\" sample=\"0\" role=\"unittype\">", layout.unit);
    }
    add("<Item name=\"RECORDED\">", layout.recorded);
    return items.empty() ? items : "<GDALMetadata>" + items + "</GDALMetadata>";
}

bool setCells(TIFF* tiff, const RasterLayout& layout) {
    const bool color = layout.kind == CellKind::Color, packed = layout.packing == RasterPacking::Deflate;
    const auto set = [&](ttag_t tag, auto... value) { return TIFFSetField(tiff, tag, value...) == 1; };
    bool ok = set(TIFFTAG_IMAGEWIDTH, std::uint32_t(layout.grid.columns)) &&
              set(TIFFTAG_IMAGELENGTH, std::uint32_t(layout.grid.rows)) &&
              set(TIFFTAG_TILEWIDTH, std::uint32_t(layout.grid.tile)) &&
              set(TIFFTAG_TILELENGTH, std::uint32_t(layout.grid.tile)) &&
              set(TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG) && set(TIFFTAG_SAMPLESPERPIXEL, color ? 4 : 1) &&
              set(TIFFTAG_BITSPERSAMPLE, color ? 8 : 32) &&
              set(TIFFTAG_SAMPLEFORMAT,
                  layout.kind == CellKind::Elevation ? SAMPLEFORMAT_IEEEFP : SAMPLEFORMAT_UINT) &&
              set(TIFFTAG_PHOTOMETRIC, color ? PHOTOMETRIC_RGB : PHOTOMETRIC_MINISBLACK) &&
              set(TIFFTAG_COMPRESSION, packed ? COMPRESSION_ADOBE_DEFLATE : COMPRESSION_NONE);
    if (ok && color) {
        const std::array<std::uint16_t, 1> extra{EXTRASAMPLE_UNASSALPHA};
        ok = set(TIFFTAG_EXTRASAMPLES, 1, extra.data());
    }
    if (ok && packed)
        ok = set(TIFFTAG_PREDICTOR,
                 layout.kind == CellKind::Elevation ? PREDICTOR_FLOATINGPOINT : PREDICTOR_HORIZONTAL) &&
             set(TIFFTAG_ZIPQUALITY, deflateLevel);
    if (ok && layout.kind == CellKind::Elevation) ok = set(noDataTag, noElevationText);
    if (const std::string metadata = metadataOf(layout); ok && !metadata.empty())
        ok = set(metadataTag, metadata.c_str());
    const auto say = [&](ttag_t tag, const std::string& text) {
        if (ok && !text.empty()) ok = set(tag, text.c_str());
    };
    say(TIFFTAG_SOFTWARE, "Scancast");
    say(TIFFTAG_IMAGEDESCRIPTION, layout.title);
    say(TIFFTAG_COPYRIGHT, layout.attribution);
    return ok;
}

bool setPlace(TIFF* tiff, const RasterLayout& layout) {
    const std::array<double, 3> scale{layout.grid.cell, layout.grid.cell, 0};
    const std::array<double, 6> corner{0, 0, 0, layout.grid.left, layout.grid.top, 0};
    if (TIFFSetField(tiff, TIFFTAG_GEOPIXELSCALE, int(scale.size()), scale.data()) != 1 ||
        TIFFSetField(tiff, TIFFTAG_GEOTIEPOINTS, int(corner.size()), corner.data()) != 1)
        return false;
    GTIF* const keys = GTIFNew(tiff);
    if (keys == nullptr) return false;
    bool ok = true;
    for (const GeoKey& key : layout.keys) {
        const auto id = geokey_t(key.key);
        if (const auto* number = std::get_if<std::uint16_t>(&key.value))
            ok = GTIFKeySet(keys, id, TYPE_SHORT, 1, int(*number)) != 0 && ok;
        else if (const auto* real = std::get_if<double>(&key.value))
            ok = GTIFKeySet(keys, id, TYPE_DOUBLE, 1, *real) != 0 && ok;
        else
            ok = GTIFKeySet(keys, id, TYPE_ASCII, 0, std::get<std::string>(key.value).c_str()) != 0 && ok;
    }
    ok = GTIFWriteKeys(keys) != 0 && ok;
    GTIFFree(keys);
    return ok;
}

}  // namespace

struct TiffBytes::Open {
    Sink sink;
    TIFF* tiff = nullptr;
    std::vector<std::byte> tile{};  ///< libtiff wants what it may change

    ~Open() {
        if (tiff == nullptr) return;
        sink.write = discard;  // nobody wants it any more, nor may be there to take it
        TIFFCleanup(tiff);
    }
    tl::unexpected<Error> failure(const char* what) const {
        if (!sink.state) return tl::unexpected(sink.state.error());
        std::string why(what);
        if (!sink.complaint.empty()) why += " (" + sink.complaint + ")";
        return fail(ErrorCode::Internal, "A TIFF cannot be written: " + why + ".");
    }
};

TiffBytes::TiffBytes(std::unique_ptr<Open> open) : open_(std::move(open)) {}
TiffBytes::TiffBytes(TiffBytes&&) noexcept = default;
TiffBytes& TiffBytes::operator=(TiffBytes&&) noexcept = default;
TiffBytes::~TiffBytes() = default;

Expected<TiffBytes> TiffBytes::create(const RasterLayout& layout, WriteAt write) {
    auto open = std::make_unique<Open>();
    open->sink.write = std::move(write);
    open->tiff = openTiff(open->sink, layout.isBig());
    if (open->tiff == nullptr) return open->failure("it cannot be begun");
    addTags(open->tiff);
    if (!setCells(open->tiff, layout)) return open->failure("its fields are refused");
    if (!setPlace(open->tiff, layout)) return open->failure("its place on earth is refused");
    return TiffBytes(std::move(open));
}

Expected<void> TiffBytes::put(std::int64_t index, std::span<const std::byte> tile, bool raw) {
    const auto number = std::uint32_t(index);
    const auto size = tmsize_t(tile.size());
    tmsize_t done = 0;
    if (raw) {
        // It is written as it is; the interface does not say so.
        done = TIFFWriteRawTile(open_->tiff, number, const_cast<std::byte*>(tile.data()), size);
    } else {
        open_->tile.assign(tile.begin(), tile.end());
        done = TIFFWriteEncodedTile(open_->tiff, number, open_->tile.data(), size);
    }
    if (done != size || !open_->sink.state) return open_->failure("a tile is refused");
    return {};
}

Expected<void> TiffBytes::finish() {
    const bool flushed = TIFFFlush(open_->tiff) == 1;
    if (!flushed || !open_->sink.state) return open_->failure("its directory is refused");
    open_->sink.write = discard;
    TIFFCleanup(std::exchange(open_->tiff, nullptr));
    return {};
}

std::uint64_t TiffBytes::size() const {
    return open_->sink.end;
}

Expected<TiffSkeleton> tiffSkeleton(const RasterLayout& layout, std::span<const std::int64_t> tiles) {
    TiffSkeleton skeleton;
    const std::size_t head = layout.isBig() ? 16 : 8;
    const std::uint64_t end = head + layout.allTiles();
    skeleton.head.resize(head);
    std::uint64_t counted = 0;
    const auto keep = [&](std::uint64_t at, std::span<const std::byte> bytes) -> Expected<void> {
        if (at + bytes.size() <= head) {
            std::ranges::copy(bytes, skeleton.head.begin() + std::ptrdiff_t(at));
        } else if (at >= end) {
            skeleton.tail.resize(std::max<std::size_t>(skeleton.tail.size(), at - end + bytes.size()));
            std::ranges::copy(bytes, skeleton.tail.begin() + std::ptrdiff_t(at - end));
        } else if (at == head + counted && at + bytes.size() <= end) {
            counted += bytes.size();
        } else {
            return fail(ErrorCode::Internal, "A TIFF lies otherwise than it was planned.");
        }
        return {};
    };
    auto tiff = TiffBytes::create(layout, keep);
    if (!tiff) return passOn(std::move(tiff));
    const std::vector<std::byte> nothing(layout.tileBytes());
    for (const std::int64_t tile : tiles)
        if (auto ok = tiff->put(tile, nothing, true); !ok) return passOn(ok);
    if (auto ok = tiff->finish(); !ok) return passOn(ok);
    if (counted != layout.allTiles()) return fail(ErrorCode::Internal, "A TIFF lacks tiles.");
    return skeleton;
}

}  // namespace scancast
