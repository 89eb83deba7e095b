// The body of POST /clouds. Pure function; any thread.
#pragma once

#include <string>
#include <string_view>

#include "protocol/error.hpp"

namespace scancast {

struct AddCloud {
    std::string file;   ///< relative to the server's data root
    std::string id;     ///< empty = made of the file's name
    std::string title;  ///< empty = the cloud's own
    bool operator==(const AddCloud&) const = default;
};

/// Malformed when the text is no JSON; InvalidArgument, with the field, for everything else.
Expected<AddCloud> parseAddCloud(std::string_view text);

}  // namespace scancast
