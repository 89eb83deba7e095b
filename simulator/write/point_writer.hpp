// Writes a point source to a file as it flows: PLY and LAS, in memory that does not grow with the scan.
#pragma once

#include <memory>
#include <optional>
#include <string_view>

#include "files/output_file.hpp"
#include "renderer/cloud/point_batch.hpp"

namespace scancast {

enum class WrittenFormat : std::uint8_t {
    Ply,    ///< binary little-endian: positions, normals, colour, intensity, classification
    Las12,  ///< LAS 1.2, point format 2: at most 4 294 967 295 points
    Las14,  ///< LAS 1.4, point format 7
};

class PointWriter {
  public:
    virtual ~PointWriter() = default;
    virtual Expected<void> write(const PointBatch& batch) = 0;
    /// After the last batch: completes the header and gives the file its name.
    virtual Expected<void> finish() = 0;
    virtual std::uint64_t bytesWritten() const = 0;
};

/// The header must declare the number of points and bounds that hold; the batches must have all columns.
/// Errors: Io; InvalidArgument when the format cannot hold the scan.
Expected<std::unique_ptr<PointWriter>> createPointWriter(WrittenFormat format, OutputFile output,
                                                         const ScanHeader& header);

/// By the ending of a file name; nullopt when it tells nothing.
std::optional<WrittenFormat> formatOfName(std::string_view fileName);

}  // namespace scancast
