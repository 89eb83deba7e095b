// A query to a service of maps, taken apart: words of its standard, whose names come in any case, and words of a view; and what values of
// the former are. Outside bytes; pure functions; any thread. Pipeline: query → **words** → map request.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "protocol/view/query.hpp"
#include "protocol/view/view.hpp"
#include "server/scheduler/picture_order.hpp"

namespace scancast {

struct MapWords {
    std::vector<std::pair<std::string, std::string>> standard;  ///< names in capitals, each once
    WordValues view;

    /// nullptr: it is not given.
    const std::string* find(std::string_view name) const;
    std::string text(std::string_view name) const;
};

/// Words of a view are judged one by one; those of its camera are none here. Errors: InvalidArgument, with the word as field.
Expected<MapWords> mapWords(std::string_view query);

std::string inCapitals(std::string_view text);
/// InvalidArgument: "NAME must …".
tl::unexpected<Error> wrongWord(std::string_view name, std::string_view must);

/// Digits alone, 0 to `most`.
std::optional<std::uint32_t> mapWholeOf(std::string_view text, std::uint32_t most);
/// Of BBOX, of WIDTH and HEIGHT, of FORMAT and of BGCOLOR. InvalidArgument.
Expected<std::array<double, 4>> mapBoxOf(const MapWords& words);
Expected<int> mapSideOf(const MapWords& words, std::string_view name);
Expected<PictureFormat> mapFormatOf(const MapWords& words);
Expected<Rgb8> mapColorOf(const MapWords& words);

}  // namespace scancast
