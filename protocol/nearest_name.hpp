// "Did you mean …?": names for error messages. Pure functions; any thread.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace scancast {

/// The known name that looks most like `name`, or an empty view when none is near enough to be a typo of it.
/// Of equally near ones the first.
std::string_view nearestName(std::string_view name, std::span<const std::string_view> known);

/// `PATH: unknown; did you mean NAME?`, or, when nothing is near, `PATH: unknown; known are A, B, C`.
std::string unknownName(std::string_view path, std::string_view name,
                        std::span<const std::string_view> known);

/// A piece of outside text as it may stand in a message: quoted, printable, at most 60 characters.
std::string quoteText(std::string_view text);

}  // namespace scancast
