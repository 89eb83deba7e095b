// The file that `snapshot` and `map` write: a picture, in the format that its name says.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "client/cpp/server.hpp"

namespace scancast::client {

/// By the end of its name, small letters or large. InvalidArgument for any other.
Expected<PictureFormat> pictureFormatOf(const std::string& name);

/// -o, --output, which has to be given. `what`: "picture". `output` must outlive the parse.
void addPictureFile(CLI::App& command, std::string& output, const std::string& what);

}  // namespace scancast::client
