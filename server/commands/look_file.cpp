#include "server/commands/look_file.hpp"

#include <limits>
#include <nlohmann/json.hpp>

#include "files/input_file.hpp"
#include "protocol/json_text.hpp"

namespace scancast {
namespace {

constexpr std::uint64_t longestLook = 1 << 20;

/// One that any change fits which fits some look.
Look mostTolerant() {
    constexpr double most = std::numeric_limits<double>::max();
    Look look;
    look.bounds = {glm::dvec3(-most), glm::dvec3(most)};
    return look;
}

}  // namespace

Expected<nlohmann::json> readLookFile(const std::string& file) {
    const auto input = InputFile::open(file);
    if (!input) return passOn(input);
    if (input->bytes() > longestLook)
        return fail(ErrorCode::ResourceLimit, file + " is too long for a look.");
    std::string text(input->bytes(), '\0');
    const auto got = input->readAt(0, std::as_writable_bytes(std::span(text)));
    if (!got) return passOn(got);
    text.resize(*got);
    auto json = parseJson(text);
    if (json)
        if (const auto fits = applyLook(mostTolerant(), *json); !fits) json = passOn(fits);
    if (!json) json.error().message = file + ": " + json.error().message;
    return json;
}

Expected<Look> changedLook(const Look& base, const std::string& file) {
    const auto changes = readLookFile(file);
    if (!changes) return passOn(changes);
    auto look = applyLook(base, *changes);
    if (look)
        if (auto ok = validate(*look); !ok) look = passOn(ok);
    if (!look) look.error().message = file + ": " + look.error().message;
    return look;
}

}  // namespace scancast
