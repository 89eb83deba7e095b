// `serve` as a part of other programs: the same flags, the same server, with clouds and a painter of theirs. Place: command line →
// **serve** → server. On the main thread.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <memory>
#include <string>

#include "renderer/residency/block_cache.hpp"
#include "server/base/metrics.hpp"
#include "server/commands/serve_options.hpp"
#include "server/scheduler/picture_order.hpp"

namespace scancast {

/// What takes the place of a part of the server's; empty = none does.
struct ServeParts {
    /// Made of the block cache that the clouds would have lived in.
    std::function<std::shared_ptr<BlockCache>(std::shared_ptr<BlockCache>)> clouds;
    std::function<OpenPainter(const DeviceOptions&)> painter;
    std::function<RanksStats()> ranks;  ///< for /metrics
};

/// Serves until it is told to stop; the exit code. Called once at most.
using ServeWith = std::function<int(const ServeParts&)>;
/// What the command does once its flags are read: it may change the options, and serves or does not. The exit code.
using ServeAs = std::function<int(ServeOptions&, const ServeWith&)>;

/// A subcommand of that name that has the flags of serve.
struct ServeCommand {
    std::string name = "serve";
    std::string description;
    ServeAs as;
    /// Adds flags of its own; also to an app that nobody runs, when the configuration is read again.
    std::function<void(CLI::App&)> flags{};
};

/// Without a footer. Its callback sets `exitCode`.
CLI::App* addServeAs(CLI::App& app, int& exitCode, ServeCommand serve);

}  // namespace scancast
