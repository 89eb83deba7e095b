#include "server/commands/open_any.hpp"

#include <filesystem>

#include "files/machine.hpp"
#include "renderer/cloud/build/build_cloud.hpp"
#include "renderer/cloud/file/cloud_file.hpp"
#include "renderer/cloud/import/open_scan.hpp"
#include "renderer/residency/open_cloud.hpp"
#include "server/base/byte_size.hpp"
#include "server/catalog/damage_reports.hpp"
#include "server/commands/importer_flags.hpp"
#include "server/terminal/progress_bar.hpp"
#include "server/terminal/terminal.hpp"

namespace scancast {
namespace {

namespace fs = std::filesystem;

Expected<std::shared_ptr<const Cloud>> openFile(const ScanInput& input, const OpenOptions& options) {
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
    auto file = input.file().share();
    if (!file) return passOn(file);
    return openCloud(std::move(*file), BlockCache::create(cache));
}

}  // namespace

Expected<std::shared_ptr<const Cloud>> openAny(const std::string& file, const OpenOptions& options) {
    auto input = ScanInput::open(file);
    if (!input) return passOn(input);
    auto crs = assumedCrs(options.assumeCrs);
    if (!crs) return passOn(crs);
    if (isCloudFile(input->file())) {
        if (*crs)
            tell(
                "{} is a cloud file, which keeps its coordinate reference system; --assume-crs is for "
                "scans\n",
                file);
        return openFile(*input, options);
    }
    auto source = openScan(*input, {.assumeCrs = std::move(*crs)});
    if (!source) return passOn(source);
    BuildOptions build;
    build.title = fs::path(file).filename().string();
    build.threads = options.threads;
    build.shape.surfels = options.surfels;
    auto mirrors = input->mirrors();
    if (!mirrors) return passOn(mirrors);
    build.mirrors = std::move(*mirrors);
    ProgressBar bar;
    auto cloud = buildCloud(**source, build, bar.sink());
    bar.clear();
    if (cloud)
        for (const std::string& remark : remarksOn(**cloud)) tell("{}\n", remark);
    return cloud;
}

}  // namespace scancast
