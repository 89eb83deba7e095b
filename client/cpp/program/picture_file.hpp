// The file that `snapshot` and `map` write: a picture, in the format that its name says.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "client/cpp/server.hpp"

namespace scancast::client {

/// By the end of its name, small letters or large. InvalidArgument for any other.
Expected<PictureFormat> pictureFormatOf(const std::string& name);

/// A flag with such a file. `output` must outlive the parse.
CLI::Option* addPictureFile(CLI::App& command, const std::string& flag, std::string& output,
                            const std::string& what);

}  // namespace scancast::client
