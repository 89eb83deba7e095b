#include "client/cpp/program/command.hpp"
#include "client/cpp/frame_decoder.hpp"
#include "client/cpp/guest.hpp"
#include "client/cpp/program/say.hpp"

#include <cstdio>
#include <utility>

#include "files/output_file.hpp"
#include "transport/secret_file.hpp"

namespace scancast::client {

void ServerFlags::addTo(CLI::App& app) {
    app.add_option("URL", url,
                   "The server, such as http://127.0.0.1:8080/, or a guest's link to it: https://…/#guest=…")
        ->required();
    app.add_option("--token-file", tokenFile, "File with the access token that the server asks for")
        ->type_name("FILE")
        ->envname("SCANCAST_TOKEN_FILE");
    app.add_option("--ca-file", caFile,
                   "For https: certificates to trust, in PEM format, instead of the system's")
        ->type_name("FILE");
    app.add_option("--connect-timeout", connectSeconds, "Seconds to wait for a connection")
        ->type_name("SECONDS")
        ->check(CLI::Range(0.001, 86400.0))
        ->capture_default_str();
    app.add_option("--timeout", answerSeconds, "Seconds to wait for each answer or frame")
        ->type_name("SECONDS")
        ->check(CLI::Range(0.001, 86400.0))
        ->capture_default_str();
}

Expected<Server> ServerFlags::server() const {
    const auto milliseconds = [](double seconds) {
        return std::chrono::milliseconds(static_cast<std::int64_t>(seconds * 1000) + 1);
    };
    const Timeouts timeouts{milliseconds(connectSeconds), milliseconds(answerSeconds)};
    if (isGuestLink(url)) {
        if (!tokenFile.empty())
            return fail(ErrorCode::InvalidArgument,
                        "--token-file: a guest's link needs no token; give the one or the other.");
        auto guest = enterAsGuest(url, timeouts, caFile);
        if (!guest) return passOn(std::move(guest));
        return Server(std::move(guest->url), timeouts, std::move(guest->credentials));
    }
    const auto parsed = parseServerUrl(url);
    if (!parsed) return passOn(parsed);
    Credentials credentials{{}, caFile};
    if (!tokenFile.empty()) {
        auto token = readTokenFile(tokenFile);
        if (!token) return passOn(std::move(token));
        credentials.token = std::move(*token);
    }
    return Server(*parsed, timeouts, std::move(credentials));
}

void CloudFlags::addTo(CLI::App& app, const std::string& otherwise) {
    server.addTo(app);
    addCloudTo(app, otherwise);
}

void CloudFlags::addCloudTo(CLI::App& app, const std::string& otherwise) {
    app.add_option("CLOUD,--cloud", id, "ID of the cloud, with the flag or without. Default: " + otherwise)
        ->type_name("ID");
}

Expected<ServedCloud> CloudFlags::choose(const std::string& otherwise) const {
    auto from = server.server();
    if (!from) return passOn(std::move(from));
    if (const std::string& wanted = id.empty() ? otherwise : id; !wanted.empty())
        return ServedCloud{std::move(*from), wanted};
    const auto clouds = from->clouds();
    if (!clouds) return passOn(clouds);
    if (clouds->empty()) return fail(ErrorCode::NotFound, from->url().authority() + " has no clouds");
    return ServedCloud{std::move(*from), clouds->front().id};
}

void CodecFlag::addTo(CLI::App& app) {
    app.add_option("--codec", name,
                   "How moving frames come, jpeg or h264: as video they take about a third of the bytes, "
                   "where the server has "
                   "a place for it. Stills are JPEG either way. h264 needs libopenh264-7")
        ->type_name("NAME")
        ->check(CLI::IsMember({"jpeg", "h264"}))
        ->capture_default_str();
}

Expected<std::vector<Codec>> CodecFlag::codecs() const {
    if (name == "jpeg") return std::vector{Codec::Jpeg};
    if (auto ok = canReadVideo(); !ok)
        return fail(ok.error().code, "--codec h264: " + ok.error().message, "codec");
    return std::vector{Codec::H264, Codec::Jpeg};
}

int report(const Expected<void>& result) {
    if (result) return 0;
    sayOn(stderr, "scancast-client: %s\n", result.error().message.c_str());
    return 1;
}

void FrameWarnings::look(const FrameHeader& header) {
    if (header.away && !std::exchange(saidAway_, true))
        sayOn(stderr,
              "scancast-client: a part of the server is away; pictures are coarser until it is back\n");
    if (!header.damaged || std::exchange(saidDamage_, true)) return;
    sayOn(stderr,
          "scancast-client: parts of this cloud cannot be read; coarser points are shown in their place\n");
}

Expected<void> writeFile(const std::string& path, const std::vector<std::uint8_t>& bytes) {
    // "-" is a name here, too: standard output is for words.
    return writeWholeFile(path == "-" ? "./-" : path, std::as_bytes(std::span(bytes)));
}

}  // namespace scancast::client
