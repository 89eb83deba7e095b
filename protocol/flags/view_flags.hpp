// The words of a view as flags of a command line, for every program: a flag for each row of the table of
// words, and one for each group of rows (`light.ambient`, `light.sun`: `--light ambient=0.3 --light sun=135,40`).
//
// Owned by whoever builds the command line; stays where it is, and outlives its parsing. One thread.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/view/query.hpp"

namespace scancast {

struct ViewWord;

class ViewFlags {
  public:
    ViewFlags() = default;
    ViewFlags(const ViewFlags&) = delete;
    ViewFlags& operator=(const ViewFlags&) = delete;

    /// Registers a flag for every word, with its meaning and an example in the help, in a group of its own. A value that its
    /// word does not take ends the parsing (CLI::ValidationError), before anything is done.
    void addTo(CLI::App& app) { addTo(app, {}); }
    /// The same of words that `wants` wants; empty = all.
    void addTo(CLI::App& app, const std::function<bool(const ViewWord&)>& wants);
    /// Those that were given, as words; applyWords() checks them. InvalidArgument for a --param, or another
    /// group's flag, that is not NAME=VALUE.
    Expected<WordValues> words() const;

  private:
    WordValues given_;
    std::map<std::string_view, std::vector<std::string>> members_;  ///< by group
};

}  // namespace scancast
