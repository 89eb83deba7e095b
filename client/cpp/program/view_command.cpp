// `scancast-client view`: a cloud in a window.
#include <cstdio>

#include "client/cpp/program/command.hpp"
#include "client/cpp/program/view_window.hpp"
#include "protocol/flags/view_flags.hpp"
#include "protocol/view/view_words.hpp"

namespace scancast::client {
namespace {

struct WindowFlags {
    CloudFlags cloud;
    ViewFlags view;
    CodecFlag codec;
    bool trace = false;
    std::optional<int> finals;
};

Expected<void> run(const WindowFlags& flags) {
    const auto words = flags.view.words();
    if (!words) return passOn(words);
    if (auto ok = checkDisplay(); !ok) return ok;
    const auto from = flags.cloud.choose();
    if (!from) return passOn(from);
    const auto cloud = from->info();
    if (!cloud) return passOn(cloud);
    const auto view = applyWords(cloud->view, *words);
    if (!view) return passOn(view);
    if (view->camera.viewMatrix)
        return fail(ErrorCode::InvalidArgument,
                    "a window is steered by --eye and --target, not by --view-matrix", "viewMatrix");
    const auto methods = from->server.methods();
    if (!methods) return passOn(methods);
    auto codecs = flags.codec.codecs();
    if (!codecs) return passOn(std::move(codecs));
    WindowOptions options{*cloud, *view, {}, flags.trace, flags.finals, std::move(*codecs)};
    for (const auto& method : *methods) options.methods.push_back(method.name);
    return runWindow(from->server, std::move(options));
}

}  // namespace

void addView(CLI::App& app, int& exitCode) {
    const auto flags = std::make_shared<WindowFlags>();
    auto& command = *app.add_subcommand("view", "View a cloud in a window");
    flags->cloud.addTo(command);
    command.add_flag("--trace", flags->trace, "Print what happens on standard output");
    command.add_option("--finals", flags->finals, "Close after this many final stills")->type_name("N");
    flags->codec.addTo(command);
    flags->view.addTo(command);
    command.footer(
        "Drag: orbit; right drag, or Shift and drag: pan; wheel: zoom; W A S D Q E: fly; M, N: next, "
        "previous method;\n"
        "1 2 3: quality while moving (sharp, balanced, fast); C: colours; R: first view; F: full screen; H: "
        "help;\n"
        "Escape: quit. Example:\n"
        "  scancast-client view http://127.0.0.1:8080/ town --method disc");
    command.callback([flags, &exitCode] { exitCode = report(run(*flags)); });
}

}  // namespace scancast::client
