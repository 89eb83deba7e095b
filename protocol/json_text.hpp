// JSON text in and out, within limits: every JSON byte that reaches the program from outside passes here.
//
// Pure functions without state; any thread. Pipeline: socket → **parseJson** → messages and views.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "protocol/error.hpp"

namespace scancast {

/// Arrays and objects inside each other, at most.
inline constexpr int maxJsonDepth = 32;

/// Malformed for what is no JSON (with the byte where it stops being some), numbers beyond a double, invalid
/// UTF-8, nesting deeper than maxJsonDepth, or one key twice in an object. The caller limits the length of
/// `text`.
Expected<nlohmann::json> parseJson(std::string_view text);

/// Empties it, from the innermost on. A destructor of the library asks for memory wherever there is anything in it, and a program
/// ends that has none: for JSON that is read where memory may be short.
void dismantle(nlohmann::json& value) noexcept;

/// Compact text, keys in alphabetical order, numbers as short as reads back exactly. Never throws: bytes that
/// are no UTF-8 are replaced. Whoever shows it on a terminal is safe: what a terminal obeys is escaped.
std::string printJson(const nlohmann::json& value);

}  // namespace scancast
