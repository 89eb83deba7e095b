#include "simulator/write/point_writer.hpp"

#include "simulator/write/las_writer.hpp"
#include "simulator/write/ply_writer.hpp"

namespace scancast {

Expected<std::unique_ptr<PointWriter>> createPointWriter(WrittenFormat format, OutputFile output,
                                                         const ScanHeader& header) {
    if (!header.points || !header.bounds)
        return fail(ErrorCode::InvalidArgument, "Only scans that know their size and bounds can be written.");
    if (format == WrittenFormat::Ply) return createPlyWriter(std::move(output), header);
    return createLasWriter(format == WrittenFormat::Las14, std::move(output), header);
}

std::optional<WrittenFormat> formatOfName(std::string_view fileName) {
    const auto endsWith = [&](std::string_view ending) {
        if (fileName.size() <= ending.size()) return false;
        for (std::size_t i = 0; i < ending.size(); ++i)
            if ((fileName[fileName.size() - ending.size() + i] | 0x20) != (ending[i] | 0x20)) return false;
        return true;
    };
    if (endsWith(".ply")) return WrittenFormat::Ply;
    if (endsWith(".las")) return WrittenFormat::Las12;
    return std::nullopt;
}

}  // namespace scancast
