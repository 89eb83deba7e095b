// What a cloud file no longer has of the scan that it was made of, in sentences for people. Pure functions.
#pragma once

#include <string>
#include <vector>

#include "renderer/cloud/export/export_points.hpp"

namespace scancast {

/// Of what is exported by these options; one sentence each without an end.
std::vector<std::string> lossesOf(const CloudFile& file, const ExportOptions& options);
/// Of any scan, by its format as people read it: waveforms, which no reader here keeps.
std::vector<std::string> lossesOfFormat(std::string_view format);

}  // namespace scancast
