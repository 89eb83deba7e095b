// The words of a view as flags of a command line (protocol/view_words.hpp).
//
// Owned by the function that builds the command line; must outlive its parsing. One thread.
#pragma once

#include <CLI/CLI.hpp>
#include <map>
#include <string>
#include <vector>

#include "protocol/query.hpp"
#include "protocol/view.hpp"

namespace scancast::client {

class ViewFlags {
  public:
    /// Registers a flag for every word of the vocabulary, with its meaning and an example in the help.
    void addTo(CLI::App& app);
    /// Those that were given, as words. InvalidArgument for a --param that is not NAME=VALUE.
    Expected<WordValues> words() const;

  private:
    std::map<std::string, std::string> values_;  ///< word → value; addresses stay
    std::map<std::string, CLI::Option*> options_;
    std::vector<std::string> parameters_;
};

}  // namespace scancast::client
