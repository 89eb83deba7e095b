// What all scans of an E57 file become together: one stream with the columns that any of them has, on one grid if there is
// one. Pure functions of the description; measuring reads the file. Pipeline: description → **plan** → points.
#pragma once

#include <string>
#include <vector>

#include "importers/e57/file_description.hpp"
#include "importers/e57/value_scale.hpp"
#include "renderer/cloud/point_batch.hpp"

namespace scancast::import_e57 {

/// A column beyond the sample's, and where it comes from.
struct KeptColumn {
    enum class From : std::uint8_t { Field, ScanNumber };
    Column column;
    From from = From::Field;
    std::string field;  ///< as it is called in the scans
};

struct ImportPlan {
    ScanHeader header;
    /// Positions are sent as steps of the header's grid: all scans are on it, with 32 bits at most.
    bool asSteps = false;
    std::vector<KeptColumn> kept;  ///< in the order of header.columns
    Scale measuredIntensity, measuredColor;
    std::vector<std::string>
        notes;  ///< known before a point is read; of a file to be recovered, what is lost
};

/// The scan with coordinates as they are stored, where they are sent as steps.
ScanDescription asRead(const ScanDescription& scan, const ImportPlan& plan);

/// Fields of a scan that its points need.
std::vector<int> wantedFields(const ScanDescription& scan, const ImportPlan& plan);

/// `keepAttributes`: with columns for everything else that is a number. Errors: Empty, Unsupported for a file whose points
/// have no coordinates; Malformed, Truncated where no point is whole; those of reading.
Expected<ImportPlan> planImport(PagedFile& file, const FileDescription& description, bool keepAttributes);

}  // namespace scancast::import_e57
