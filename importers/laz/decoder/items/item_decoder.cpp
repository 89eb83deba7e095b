#include "importers/laz/decoder/items/item_decoder.hpp"

#include "importers/laz/decoder/items/colors.hpp"
#include "importers/laz/decoder/items/extra_bytes.hpp"
#include "importers/laz/decoder/items/gps_time.hpp"
#include "importers/laz/decoder/items/layered_items.hpp"
#include "importers/laz/decoder/items/point10.hpp"
#include "importers/laz/decoder/items/point14.hpp"
#include "importers/laz/decoder/items/wave_packets.hpp"

namespace scancast::laz {

std::unique_ptr<ItemDecoder> makeItemDecoder(const Item& item, ArithmeticDecoder& decoder) {
    const bool first = item.version == 1;
    switch (item.kind) {
        case ItemKind::Point10:
            if (first) return std::make_unique<Point10V1>(decoder);
            return std::make_unique<Point10V2>(decoder);
        case ItemKind::GpsTime11:
            if (first) return std::make_unique<GpsTime11V1>(decoder);
            return std::make_unique<GpsTime11V2>(decoder);
        case ItemKind::Rgb12:
            if (first) return std::make_unique<Rgb12V1>(decoder);
            return std::make_unique<Rgb12V2>(decoder);
        case ItemKind::WavePacket13:
            return std::make_unique<WavePacket13>(decoder);
        default:
            if (first) return std::make_unique<ExtraBytesV1>(decoder, item.bytes);
            return std::make_unique<ExtraBytesV2>(decoder, item.bytes);
    }
}

std::unique_ptr<LayeredItemDecoder> makeLayeredItemDecoder(const Item& item) {
    switch (item.kind) {
        case ItemKind::Point14:
            return std::make_unique<Point14>(item.version);
        case ItemKind::Rgb14:
            return std::make_unique<LayeredItem<ColorFields>>(item.bytes, item.version);
        case ItemKind::RgbNir14:
            return std::make_unique<LayeredItem<ColorInfraredFields>>(item.bytes, item.version);
        case ItemKind::WavePacket14:
            return std::make_unique<LayeredItem<WavePacketFields>>(item.bytes, item.version);
        default:
            return std::make_unique<LayeredItem<ExtraFields>>(item.bytes, item.version);
    }
}

}  // namespace scancast::laz
