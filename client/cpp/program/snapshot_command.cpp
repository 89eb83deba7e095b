// `scancast-client snapshot`: one picture of full quality, by HTTP.
#include <cstdio>

#include "client/cpp/program/command.hpp"
#include "client/cpp/program/say.hpp"
#include "protocol/flags/view_flags.hpp"

namespace scancast::client {
namespace {

struct SnapshotFlags {
    ServerFlags server;
    ViewFlags view;
    std::string cloud, output, etag;
};

Expected<PictureFormat> formatOf(const std::string& path) {
    const auto ends = [&](std::string_view suffix) { return path.ends_with(suffix); };
    if (ends(".jpg") || ends(".jpeg") || ends(".JPG")) return PictureFormat::Jpeg;
    if (ends(".png") || ends(".PNG")) return PictureFormat::Png;
    return fail(ErrorCode::InvalidArgument,
                "the name " + path + " does not end in .jpg or .png, so its format is not known");
}

/// ", drawn as disc (it has normals)"; empty where the server does not say.
std::string drawnAs(const Snapshot& picture) {
    if (picture.method.empty()) return {};
    const std::string why = picture.methodReason.empty() ? "" : " (" + picture.methodReason + ")";
    return ", drawn as " + picture.method + why;
}

Expected<void> run(const SnapshotFlags& flags) {
    const auto format = formatOf(flags.output);  // sound: the flag's check has said so
    if (!format) return passOn(format);
    const auto words = flags.view.words();
    if (!words) return passOn(words);
    const auto server = flags.server.server();
    if (!server) return passOn(server);
    const auto cloud = chooseCloud(*server, flags.cloud);
    if (!cloud) return passOn(cloud);
    const auto picture = server->snapshot(*cloud, *words, *format, flags.etag);
    if (!picture) return passOn(picture);
    if (picture->notModified) {
        sayOn(stdout, "%s is still the same: nothing written\n", cloud->c_str());
        return {};
    }
    if (auto ok = writeFile(flags.output, picture->bytes); !ok) return ok;
    if (picture->damaged > 0) {
        sayOn(
            stderr,
            "scancast-client: %llu %s of this cloud cannot be read; coarser points are shown in the picture "
            "in their place\n",
            static_cast<unsigned long long>(picture->damaged), picture->damaged == 1 ? "block" : "blocks");
        sayOn(stdout, "%s: %zu bytes of %s, damaged\n", flags.output.c_str(), picture->bytes.size(),
              cloud->c_str());
        return {};
    }
    sayOn(stdout, "%s: %zu bytes of %s%s, ETag %s\n", flags.output.c_str(), picture->bytes.size(),
          cloud->c_str(), drawnAs(*picture).c_str(), picture->etag.c_str());
    return {};
}

}  // namespace

void addSnapshot(CLI::App& app, int& exitCode) {
    const auto flags = std::make_shared<SnapshotFlags>();
    auto& command = *app.add_subcommand("snapshot", "Fetch one picture in full quality");
    flags->server.addTo(command);
    command
        .add_option("-o,--output", flags->output,
                    "The picture to write: JPEG or PNG, by the ending of its name")
        ->type_name("FILE.jpg|FILE.png")
        ->check([](const std::string& name) {
            const auto format = formatOf(name);
            return format ? std::string() : format.error().message;
        })
        ->required();
    command.add_option("--cloud", flags->cloud, "ID of the cloud. Default: the server's first one")
        ->type_name("ID");
    command.add_option("--if-none-match", flags->etag, "Write nothing if the picture still has this ETag")
        ->type_name("ETAG");
    flags->view.addTo(command);
    command.footer(
        "Whatever is not given is taken from the cloud's default view. Example:\n"
        "  scancast-client snapshot http://127.0.0.1:8080/ --cloud town --eye 10,0,2 --color elevation "
        "--width 1920 --height 1080 -o town.jpg");
    command.callback([flags, &exitCode] { exitCode = report(run(*flags)); });
}

}  // namespace scancast::client
