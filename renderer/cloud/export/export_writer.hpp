// Writes points into one file of a format that others read. Pipeline: points → **writer** → file. Owned and used by one
// thread; numbers become bytes on several, and the bytes are the same with any number of them.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "files/output_file.hpp"
#include "protocol/points/points_request.hpp"
#include "renderer/cloud/point_batch.hpp"

namespace scancast {

using ExportFormat = PointsFormat;

/// What heads of files say of all points together.
struct PointSurvey {
    std::uint64_t points = 0;
    glm::dvec3 low{std::numeric_limits<double>::max()}, high{std::numeric_limits<double>::lowest()};
    std::array<std::uint64_t, 15>
        returns{};  ///< points by return_number 1-15, or all of them as first without
    std::optional<std::uint8_t> highestClass{};  ///< nullopt: not known

    /// `header` is the scan's.
    void add(const PointBatch& batch, const ScanHeader& header);
};

class ExportWriter {
  public:
    virtual ~ExportWriter() = default;
    virtual Expected<void> write(const PointBatch& batch) = 0;
    /// `survey`: of what was written. The file gets its name.
    virtual Expected<void> finish(const PointSurvey& survey) = 0;
    virtual std::uint64_t bytesWritten() const = 0;
    /// What of the points this format could not take, one sentence each without an end. Complete after finish().
    virtual std::vector<std::string> losses() const = 0;
};

/// `ahead` is what is known before: of formats whose head says it, all of it where the output is not seekable; else
/// bounds where the scan has no grid, and the highest class where it is known. Errors: InvalidArgument for columns that no record
/// has room for; Io and ResourceLimit, the output's.
Expected<std::unique_ptr<ExportWriter>> createLasExport(OutputFile output, const ScanHeader& header,
                                                        const PointSurvey& ahead);
Expected<std::unique_ptr<ExportWriter>> createPlyExport(OutputFile output, const ScanHeader& header,
                                                        const PointSurvey& ahead);
/// `separator`: ',' or ' '. With blanks, names stand behind "//".
Expected<std::unique_ptr<ExportWriter>> createTextExport(OutputFile output, const ScanHeader& header,
                                                         char separator);

/// The one of that format.
Expected<std::unique_ptr<ExportWriter>> createExport(ExportFormat format, OutputFile output,
                                                     const ScanHeader& header, const PointSurvey& ahead);

}  // namespace scancast
