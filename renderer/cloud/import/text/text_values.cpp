#include "renderer/cloud/import/text/text_values.hpp"

namespace scancast {

std::optional<ColorScale> colorScale(const SeenValues& seen) {
    if (seen.fractions && seen.within(0, 1)) return ColorScale::Unit;
    if (seen.within(0, 255)) return ColorScale::Byte;
    if (!seen.parts && seen.within(0, 65535)) return ColorScale::Word;
    return std::nullopt;
}

IntensityScale intensityScale(const SeenValues& seen, bool pts) {
    if (seen.fractions && seen.within(0, 1)) return IntensityScale::Unit;
    if (seen.within(-2048, 2047) && (pts || seen.least < 0)) return IntensityScale::Signed;
    return IntensityScale::Plain;
}

}  // namespace scancast
