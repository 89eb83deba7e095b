#include "server/commands/open_any.hpp"

#include <filesystem>

#include "files/machine.hpp"
#include "renderer/cloud/build/build_cloud.hpp"
#include "renderer/cloud/build/many_scans.hpp"
#include "renderer/cloud/file/cloud_file.hpp"
#include "renderer/cloud/import/open_scan.hpp"
#include "renderer/residency/open_cloud.hpp"
#include "server/base/byte_size.hpp"
#include "server/base/remote_cloud.hpp"
#include "server/catalog/damage_reports.hpp"
#include "server/commands/importer_flags.hpp"
#include "server/commands/scans/found_scans.hpp"
#include "server/commands/scans/open_in_turn.hpp"
#include "server/terminal/progress_bar.hpp"
#include "server/terminal/terminal.hpp"

namespace scancast {
namespace {

namespace fs = std::filesystem;

Expected<std::shared_ptr<const Cloud>> openFile(const ScanInput& input, const OpenOptions& options) {
    const auto cache = cacheFor(options);
    if (!cache) return passOn(cache);
    auto file = input.file().share();
    if (!file) return passOn(file);
    return openCloud(std::move(*file), *cache);
}

Expected<std::shared_ptr<const Cloud>> openAsItIs(const ScanInput& input, const OpenOptions& options) {
    const auto cache = cacheFor(options);
    if (!cache) return passOn(cache);
    auto crs = assumedCrs(options.assumeCrs);
    if (!crs) return passOn(crs);
    auto file = openNative(input, {.crs = *crs, .surfels = options.surfels});
    if (!file) return passOn(std::move(file));
    return openCloud(std::move(*file), *cache);
}

Expected<std::shared_ptr<const Cloud>> openUrl(const std::string& url, const OpenOptions& options) {
    const auto cache = cacheFor(options);
    if (!cache) return passOn(cache);
    RemoteFiles remote{
        {.onNote = [](const std::string& note) { tell("{}\n", note); }, .stopsWithOwner = false}};
    auto opened = openRemoteCloud(remote, url, {.surfels = options.surfels});
    if (!opened) return passOn(std::move(opened));
    return openCloud(std::move(opened->file), *cache);
}

/// What a cloud of these arguments is called: the first one's name, whether that is a file or a folder.
std::string titleOf(const std::vector<std::string>& arguments) {
    const fs::path first = fs::path(arguments.front()).lexically_normal();
    return (first.has_filename() ? first : first.parent_path()).filename().string();
}

/// Of several, the first stays open, the others are opened when their turn comes. Their mirrors are all added.
Expected<std::unique_ptr<PointSource>> openScans(const std::vector<std::string>& files,
                                                 const ImportOptions& import, std::vector<Mirror>& mirrors) {
    std::vector<std::unique_ptr<PointSource>> sources;
    for (const std::string& file : files) {
        if (isRemoteUrl(file))
            return fail(
                ErrorCode::InvalidArgument,
                shownArgument(file) + " is one of several: only scans are put together; name it alone");
        const auto input = ScanInput::open(file);
        if (!input) return passOn(input);
        if (files.size() > 1 && isCloudFile(input->file()))
            return fail(
                ErrorCode::InvalidArgument,
                file + " is a cloud file, and one of several: only scans are put together; name it alone");
        auto source = sources.empty() ? openScan(*input, import) : openInTurn(*input, import);
        if (!source) return source;
        sources.push_back(std::move(*source));
        const auto theirs = input->mirrors();
        if (!theirs) return passOn(theirs);
        mirrors.insert(mirrors.end(), theirs->begin(), theirs->end());
    }
    return sources.size() == 1 ? Expected<std::unique_ptr<PointSource>>(std::move(sources.front()))
                               : manyScans(std::move(sources), files);
}

}  // namespace

Expected<std::shared_ptr<BlockCache>> cacheFor(const OpenOptions& options) {
    if (options.cache) return options.cache;
    BlockCacheOptions cache;
    cache.memoryLimit = machineMemory() / 2;
    if (!options.memoryLimit.empty()) {
        const auto limit = parseByteSize(options.memoryLimit, "memory-limit");
        if (!limit) return passOn(limit);
        cache.memoryLimit = *limit;
    }
    cache.onDamaged = [](const std::shared_ptr<const CloudFile>& file, const Error& error) {
        tell("{}; coarser points are shown in its place\n", damageText(*file, error));
    };
    return BlockCache::create(cache);
}

Expected<std::shared_ptr<const Cloud>> openAny(const std::vector<std::string>& arguments,
                                               const OpenOptions& options) {
    const auto found = findScans(arguments, {.urls = true});
    if (!found) return passOn(found);
    tellLeftOut(*found, options.verbose);
    const std::vector<std::string>& files = found->files();
    auto crs = assumedCrs(options.assumeCrs);
    if (!crs) return passOn(crs);
    if (files.size() == 1 && isRemoteUrl(files.front())) return openUrl(files.front(), options);
    if (files.size() == 1) {
        const auto input = ScanInput::open(files.front());
        if (!input) return passOn(input);
        if (isCloudFile(input->file())) {
            if (*crs)
                tell(
                    "{} is a cloud file, which keeps its coordinate reference system; --assume-crs is for "
                    "scans\n",
                    files.front());
            return openFile(*input, options);
        }
        if (options.native && canBeNative(*input)) return openAsItIs(*input, options);
    }
    if (options.native)
        tell("--native shows one scan in COPC or EPT as it is; what is named here is read as usual\n");
    BuildOptions build;
    build.title = titleOf(arguments);
    build.threads = options.threads;
    build.shape.surfels = options.surfels;
    auto source = openScans(files, {.assumeCrs = std::move(*crs)}, build.mirrors);
    if (!source) return passOn(source);
    ProgressBar bar;
    auto cloud = buildCloud(**source, build, bar.sink());
    bar.clear();
    if (cloud)
        for (const std::string& remark : remarksOn(**cloud)) tell("{}\n", remark);
    return cloud;
}

}  // namespace scancast
