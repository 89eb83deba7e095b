#include "transport/secret_file.hpp"

#include <sys/stat.h>

#include "files/input_file.hpp"
#include "protocol/bearer.hpp"

namespace scancast {

Expected<std::string> readSecretFile(const std::filesystem::path& path, std::size_t most) {
    const auto file = InputFile::open(path);
    if (!file) return passOn(file);
    if ((file->permissions() & (S_IWGRP | S_IRWXO)) != 0) {
        return fail(ErrorCode::InvalidArgument,
                    path.string() +
                        " is a secret that others can read or change; make it yours alone: chmod 600 " +
                        path.string());
    }
    return file->text(most);
}

Expected<std::string> readTokenFile(const std::filesystem::path& path) {
    // Longer than any token, with room for white space.
    const auto text = readSecretFile(path, 2 * longestToken);
    if (!text) return passOn(text);
    auto token = parseToken(*text);
    if (!token) token.error().message = path.string() + ": " + token.error().message + ".";
    return token;
}

}  // namespace scancast
