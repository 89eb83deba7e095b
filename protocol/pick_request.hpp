// The body of POST /clouds/{id}/pick. Pure functions; any thread.
#pragma once

#include <nlohmann/json.hpp>
#include <string_view>

#include "protocol/error.hpp"

namespace scancast {

struct PickRequest {
    nlohmann::json view = nlohmann::json::object();  ///< any subset of a view; checked when it is applied
    double x = 0, y = 0;                             ///< px from the top left corner of the view's picture
};

/// Malformed when the text is no JSON; InvalidArgument, with the path as field, for everything else.
Expected<PickRequest> parsePickRequest(std::string_view text);

}  // namespace scancast
