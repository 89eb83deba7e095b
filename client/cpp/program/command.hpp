// The subcommands of `scancast-client`. Each file in this folder adds one, with its help and its example.
#pragma once

#include <CLI/CLI.hpp>
#include <memory>

#include "client/cpp/server.hpp"
#include "protocol/frame_header.hpp"

namespace scancast::client {

/// Each adds its subcommand to `app`; when it is the one called, its callback runs it and sets `exitCode`
/// (0 = done, 1 = failed with an error on standard error).
void addSnapshot(CLI::App& app, int& exitCode);
void addOrbit(CLI::App& app, int& exitCode);
void addInfo(CLI::App& app, int& exitCode);
void addBench(CLI::App& app, int& exitCode);
void addPath(CLI::App& app, int& exitCode);
void addPoints(CLI::App& app, int& exitCode);
void addProfile(CLI::App& app, int& exitCode);
void addView(CLI::App& app, int& exitCode);
void addPick(CLI::App& app, int& exitCode);
void addMeasure(CLI::App& app, int& exitCode);
void addMap(CLI::App& app, int& exitCode);
void addLonLat(CLI::App& app, int& exitCode);
void addRasters(CLI::App& app, int& exitCode);  ///< dem and ortho

/// What every subcommand needs to know.
struct ServerFlags {
    std::string url;
    std::filesystem::path tokenFile, caFile;
    double connectSeconds = 5, answerSeconds = 60;

    void addTo(CLI::App& app);
    Expected<Server> server() const;
};

/// A server, and one of its clouds.
struct ServedCloud {
    Server server;
    std::string id;

    Expected<CloudInfo> info() const { return server.cloud(id); }
};

/// What every subcommand about one cloud needs to know. The cloud stands behind all else that has no flag, or behind --cloud:
/// `points URL town`, `measure URL distance town`, `path URL flight.json --cloud town`.
struct CloudFlags {
    ServerFlags server;
    std::string id;  ///< as given; empty = the server's first one

    /// Both at once, for who has no positional of its own between them.
    void addTo(CLI::App& app, const std::string& otherwise = "the server's first one");
    void addCloudTo(CLI::App& app, const std::string& otherwise = "the server's first one");
    /// The cloud as given, else `otherwise`, else the server's first one. Errors: ServerFlags::server()'s; NotFound where a server has none.
    Expected<ServedCloud> choose(const std::string& otherwise = {}) const;
};

/// How moving frames travel, of subcommands that show them.
struct CodecFlag {
    std::string name = "jpeg";

    void addTo(CLI::App& app);
    /// For hello. Unavailable: there is no OpenH264 here.
    Expected<std::vector<Codec>> codecs() const;
};

/// Runs a subcommand: prints the error, if it ends with one, and returns the exit code.
int report(const Expected<void>& result);

/// Says on standard error, the first time that it is called with a frame that lacks blocks, or is coarser because a part of the
/// server is away, what such pictures are.
class FrameWarnings {
  public:
    void look(const FrameHeader& header);

  private:
    bool saidDamage_ = false, saidAway_ = false;
};

/// The whole file or an Io error that names it.
Expected<void> writeFile(const std::string& path, const std::vector<std::uint8_t>& bytes);

}  // namespace scancast::client
