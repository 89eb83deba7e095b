// `scancast-client snapshot`: one picture of full quality, by HTTP.
#include <cstdio>

#include "client/cpp/program/command.hpp"
#include "client/cpp/program/picture_file.hpp"
#include "client/cpp/program/say.hpp"
#include "protocol/flags/view_flags.hpp"

namespace scancast::client {
namespace {

struct SnapshotFlags {
    CloudFlags cloud;
    ViewFlags view;
    std::string output, etag;
};

/// ", drawn as disc (it has normals)"; empty where the server does not say.
std::string drawnAs(const Snapshot& picture) {
    if (picture.method.empty()) return {};
    const std::string why = picture.methodReason.empty() ? "" : " (" + picture.methodReason + ")";
    return ", drawn as " + picture.method + why;
}

Expected<void> run(const SnapshotFlags& flags) {
    const auto format = pictureFormatOf(flags.output);  // sound: the flag's check has said so
    if (!format) return passOn(format);
    const auto words = flags.view.words();
    if (!words) return passOn(words);
    const auto cloud = flags.cloud.choose();
    if (!cloud) return passOn(cloud);
    const auto picture = cloud->server.snapshot(cloud->id, *words, *format, flags.etag);
    if (!picture) return passOn(picture);
    if (picture->notModified) {
        sayOn(stdout, "%s is still the same: nothing written\n", cloud->id.c_str());
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
              cloud->id.c_str());
        return {};
    }
    sayOn(stdout, "%s: %zu bytes of %s%s, ETag %s\n", flags.output.c_str(), picture->bytes.size(),
          cloud->id.c_str(), drawnAs(*picture).c_str(), picture->etag.c_str());
    return {};
}

}  // namespace

void addSnapshot(CLI::App& app, int& exitCode) {
    const auto flags = std::make_shared<SnapshotFlags>();
    auto& command = *app.add_subcommand("snapshot", "Fetch one picture in full quality");
    flags->cloud.addTo(command);
    addPictureFile(command, "-o,--output", flags->output,
                   "The picture to write: JPEG or PNG, by the ending of its name")
        ->required();
    command.add_option("--if-none-match", flags->etag, "Write nothing if the picture still has this ETag")
        ->type_name("ETAG");
    flags->view.addTo(command);
    command.footer(
        "Whatever is not given is taken from the cloud's default view. Example:\n"
        "  scancast-client snapshot http://127.0.0.1:8080/ town --eye 10,0,2 --color elevation "
        "--width 1920 --height 1080 -o town.jpg");
    command.callback([flags, &exitCode] { exitCode = report(run(*flags)); });
}

}  // namespace scancast::client
