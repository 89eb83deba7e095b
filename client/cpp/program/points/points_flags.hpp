// What `points` and `profile` share: as what points come, and where to.
#pragma once

#include <optional>
#include <string>

#include "client/cpp/server.hpp"
#include "files/output_file.hpp"

namespace scancast::client {

/// By `given`, else by the end of the file's name: nullopt for PNG. InvalidArgument, Unsupported.
Expected<std::optional<PointsFormat>> formatOfPoints(const std::string& given, const std::string& output);

/// Into the file.
TakeBytes into(OutputFile& file);
/// What has been written, and what of it is not as the scan was, on standard error.
void tellOfPoints(const std::string& output, const PointsAnswer& answer);

}  // namespace scancast::client
