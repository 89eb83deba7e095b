#include "renderer/cloud/export/export_writer.hpp"

#include <algorithm>
#include <glm/common.hpp>

namespace scancast {

void PointSurvey::add(const PointBatch& batch, const ScanHeader& header) {
    points += batch.size();
    for (const glm::dvec3& p : batch.position) {
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    std::size_t at = 0;
    bool found = false;
    for (const Column& column : header.columns) {
        found = column.name == "return_number" && column.type == ColumnType::Uint8;
        if (found) break;
        at += bytesOf(column.type);
    }
    if (!found) {
        returns[0] += batch.size();
        return;
    }
    const std::size_t stride = rowBytes(header.columns);
    for (std::size_t i = 0; i < batch.size(); ++i) {
        const auto number = std::to_integer<unsigned>(batch.rows[i * stride + at]);
        if (number >= 1 && number <= returns.size()) ++returns[number - 1];
    }
}

Expected<std::unique_ptr<ExportWriter>> createExport(ExportFormat format, OutputFile output,
                                                     const ScanHeader& header, const PointSurvey& ahead) {
    switch (format) {
        case ExportFormat::Las:
            return createLasExport(std::move(output), header, ahead);
        case ExportFormat::Ply:
            return createPlyExport(std::move(output), header, ahead);
        case ExportFormat::Text:
            return createTextExport(std::move(output), header, ' ');
        case ExportFormat::Csv:
            break;
    }
    return createTextExport(std::move(output), header, ',');
}

}  // namespace scancast
