// The flags that say whom to name beside a cloud's pictures and when it was scanned: of `ingest`, and of `label`.
#pragma once

#include <CLI/CLI.hpp>

#include <string>

#include "renderer/cloud/cloud.hpp"

namespace scancast {

/// `Text` is a std::string or an optional one. Values that are none are usage errors.
template <class Text>
void addLabelFlags(CLI::App& command, Text& attribution, Text& recorded) {
    const auto saidBy = [](Expected<void> (*check)(std::string_view)) {
        return [check](const std::string& value) {
            const auto sound = check(value);
            return sound ? std::string() : sound.error().message;
        };
    };
    command
        .add_option(
            "--attribution", attribution,
            "Whom to name beside its pictures, and the licence, at most 512 bytes: 'City of Graz, CC BY 4.0'")
        ->type_name("TEXT")
        ->check(saidBy(checkAttribution));
    command.add_option("--recorded", recorded, "When it was scanned: 2024, 2024-05 or 2024-05-13")
        ->type_name("DATE")
        ->check(saidBy(checkRecorded));
}

}  // namespace scancast
