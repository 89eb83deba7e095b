// What our programs exit with, the same for all of them. Plain values.
#pragma once

namespace scancast {

inline constexpr int exitFailed = 1;  ///< it could not be done; standard error says why
/// The command line was not understood: an unknown flag, a value that its flag does not take, nothing to do.
inline constexpr int exitUsage = 2;

/// For the end of --help.
inline constexpr const char* exitCodesText =
    "Exits with 0 when done, 1 when something failed, 2 when the command line is wrong.";

}  // namespace scancast
