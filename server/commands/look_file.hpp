// A look from a file that the user wrote: JSON, with all of it or what is to change.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "protocol/look.hpp"

namespace scancast {

/// What the file says, to be applied to a look. Errors name the file: NotFound, Io; Malformed for no JSON;
/// ResourceLimit for a file that is far too long; InvalidArgument with the JSON path for what no look can be.
Expected<nlohmann::json> readLookFile(const std::string& file);

/// `base` with that. Errors: also InvalidArgument for what this look cannot be.
Expected<Look> changedLook(const Look& base, const std::string& file);

}  // namespace scancast
