// What whoever reads an E57 file should hear of it before its points: sentences of a description. Pure functions.
// Pipeline: description → **notes** → point stream.
#pragma once

#include <string>
#include <vector>

#include "importers/e57/file_description.hpp"
#include "renderer/cloud/point_batch.hpp"

namespace scancast::import_e57 {

/// "3 scans".
std::string countedScans(std::uint64_t count);

/// `has`: what the stream's points have, of whichever scan.
void noteWhatIsInIt(const PagedFile& file, const FileDescription& description, const Attributes& has,
                    std::vector<std::string>& notes);

}  // namespace scancast::import_e57
