// An answer's values for people, one a line: "position  389412.12 5819700.5 38.1". Used by `pick` and `measure`.
#pragma once

#include <nlohmann/json_fwd.hpp>

namespace scancast::client {

/// On standard output. Members of objects stand as "crs.name"; lists of numbers on one line; of lists of objects each has lines of its own,
/// numbered from 0. Numbers have all their digits.
void sayValues(const nlohmann::json& object);

}  // namespace scancast::client
