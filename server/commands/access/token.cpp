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
    auto* command = app.add_subcommand("token", "Make an access token that nobody can guess");
    command->footer(
        "Prints NAME and 256 random bits, as --auth-token-file and --admin-token-file expect them. The log "
        "names requests by NAME. Remove the line, and that token is no longer accepted.\n"
        "Example: (umask 077; scancast token alice >> tokens)\n"
        "         scancast serve town.scan --auth-token-file tokens");
    command
        ->add_option("NAME", *name, "Whose token it is, or what it is for: letters, digits, '.', '_' and '-'")
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
