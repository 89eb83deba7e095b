// The words of a view as command-line flags: one table (protocol/view_words.hpp) for URLs, JSON and flags.
#pragma once

#include <CLI/CLI.hpp>

#include "protocol/view_words.hpp"

namespace scancast {

/// Adds a flag per word to `app`, in a help group of their own. What the user gives is appended to `words`,
/// which must outlive the parse; applyWords() checks it.
void addViewFlags(CLI::App& app, WordValues& words);

}  // namespace scancast
