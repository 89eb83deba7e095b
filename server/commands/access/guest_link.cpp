// `scancast guest-link`: a link by which somebody without a token looks at one cloud for a while. Needs no server: it signs with
// the key that the server has.
#include <memory>

#include "protocol/guests/guest.hpp"
#include "server/access/guest_keys.hpp"
#include "server/access/guest_token.hpp"
#include "server/access/token_file.hpp"
#include "server/commands/access/access_commands.hpp"
#include "server/terminal/terminal.hpp"

namespace scancast {
namespace {

struct LinkArguments {
    std::filesystem::path keyFile;
    std::string cloud, expires = "7d", url;
};

/// Without the slash at its end; a path before it is a proxy's.
Expected<std::string> addressOf(std::string url) {
    const bool web = url.starts_with("http://") || url.starts_with("https://");
    if (!web || url.find_first_of("#? \t") != std::string::npos || url.find("://") + 3 >= url.size())
        return fail(ErrorCode::InvalidArgument,
                    "--url: must be the server's address, like https://scans.example.org/", "url");
    while (url.ends_with('/')) url.pop_back();
    return url;
}

Expected<void> runGuestLink(const LinkArguments& arguments) {
    if (!canBeCloudId(arguments.cloud))
        return fail(ErrorCode::InvalidArgument,
                    "--cloud: must be an id as /api/v1/clouds lists it: letters, digits, '.', '_' and '-'",
                    "cloud");
    const auto seconds = parseGuestTime(arguments.expires);
    if (!seconds) return fail(seconds.error().code, "--expires: " + seconds.error().message, "expires");
    const auto address = addressOf(arguments.url);
    if (!address) return passOn(address);
    const auto keys = readTokens(arguments.keyFile, "guests");
    if (!keys) return fail(keys.error().code, "--key-file: " + keys.error().message, "key-file");
    const auto link = GuestKeys(*keys, {}).link(arguments.cloud, std::chrono::seconds(*seconds),
                                                std::chrono::system_clock::now());
    if (!link) return passOn(link);
    if (auto printed = print(*address + guestPath(link->token) + "\n"); !printed) return printed;
    tell("good until {}; who has it sees {} and nothing else\n", utcText(link->until), arguments.cloud);
    return {};
}

}  // namespace

void addGuestLink(CLI::App& app, int& exitCode) {
    const auto arguments = std::make_shared<LinkArguments>();
    auto* command =
        app.add_subcommand("guest-link", "Make a link that shows one cloud to a guest for a while");
    command->footer(
        "The server must know the key: serve --guest-key-file. What lets a guest in stands after the # of "
        "the link, which browsers never send anywhere. Remove the key, and all links that it signed are "
        "void.\n"
        "Example: (umask 077; scancast token guests-2026 > guest-keys)\n"
        "         scancast serve town.scan --auth-token-file tokens --guest-key-file guest-keys\n"
        "         scancast guest-link --key-file guest-keys --cloud town --expires 7d --url "
        "https://scans.example.org/");
    command->add_option("--key-file", arguments->keyFile, "File with the keys; the first one signs")
        ->required()
        ->type_name("FILE");
    command->add_option("--cloud", arguments->cloud, "ID of the cloud that the guest sees")
        ->required()
        ->type_name("ID");
    command->add_option("--expires", arguments->expires, "How long the link works: 90m, 12h, 7d")
        ->type_name("TIME")
        ->capture_default_str();
    command->add_option("--url", arguments->url, "The server, as the guest's browser reaches it")
        ->required()
        ->type_name("URL");
    command->callback([arguments, &exitCode] {
        if (auto done = runGuestLink(*arguments); !done) {
            tell("scancast guest-link: {}\n", done.error().message);
            exitCode = 1;
        }
    });
}

}  // namespace scancast
