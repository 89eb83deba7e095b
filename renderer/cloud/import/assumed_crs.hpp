// A coordinate reference system that the user names, in place of what scans say of theirs. Pipeline: reader → **assumed CRS** →
// octree. The source is owned and used by one thread.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "renderer/cloud/point_batch.hpp"

namespace scancast {

struct AssumedCrs {
    std::string wkt;  ///< printable ASCII; empty = there is only the number
    std::optional<int> epsg;
    bool operator==(const AssumedCrs&) const = default;
};

/// "EPSG:25832", or a whole WKT. InvalidArgument for anything else.
Expected<AssumedCrs> parseCrs(std::string_view text);

/// The scan with that CRS, and with a note where it says another of itself. `name` is what messages call it.
std::unique_ptr<PointSource> withCrs(std::unique_ptr<PointSource> source, const AssumedCrs& crs,
                                     const std::string& name);

}  // namespace scancast
