#include "server/commands/look_file.hpp"

#include <nlohmann/json.hpp>

#include "files/input_file.hpp"
#include "protocol/json_text.hpp"

namespace scancast {
namespace {

constexpr std::uint64_t longestFile = 1 << 20;

}  // namespace

Expected<nlohmann::json> readLookFile(const std::string& file) {
    const auto input = InputFile::open(file);
    if (!input) return passOn(input);
    if (input->bytes() > longestFile) return fail(ErrorCode::ResourceLimit, file + " is too long for a look.");
    std::string text(input->bytes(), '\0');
    const auto got = input->readAt(0, std::as_writable_bytes(std::span(text)));
    if (!got) return passOn(got);
    text.resize(*got);
    auto json = parseJson(text);
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
