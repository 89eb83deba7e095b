// `scancast token`: a line for the files of --auth-token-file and --admin-token-file.
#include <memory>

#include "server/access/token_file.hpp"
#include "server/commands/access/access_commands.hpp"
#include "server/terminal/terminal.hpp"

namespace scancast {
namespace {

Expected<void> runToken(const std::string& name) {
    if (!isTokenName(name)) return fail(ErrorCode::InvalidArgument, "NAME: " + tokenNameRule() + ".", "NAME");
    const auto token = newToken();
    if (!token) return passOn(token);
    return print(name + " " + *token + "\n");
}

}  // namespace

void addToken(CLI::App& app, int& exitCode) {
    const auto name = std::make_shared<std::string>();
    auto* command = app.add_subcommand("token", "Make an access token that nobody guesses");
    command->footer(
        "Prints NAME and 256 random bits, as --auth-token-file and --admin-token-file have them. Whose "
        "request "
        "it was stands under that name in the log; take the line away, and that one is let in no more.\n"
        "Example: (umask 077; scancast token alice >> tokens)\n"
        "         scancast serve town.scan --auth-token-file tokens");
    command->add_option("NAME", *name, "Whose it is, or what for: letters, digits, '.', '_' and '-'")
        ->required()
        ->type_name("");
    command->callback([name, &exitCode] {
        if (auto done = runToken(*name); !done) {
            tell("scancast token: {}\n", done.error().message);
            exitCode = 1;
        }
    });
}

}  // namespace scancast
