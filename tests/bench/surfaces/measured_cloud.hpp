// The cloud that a benchmark is told to measure: a file, or a generated scene; and its camera from nearer.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <memory>
#include <string>

#include "renderer/cloud/build/build_cloud.hpp"
#include "renderer/cloud/import/open_scan.hpp"
#include "renderer/residency/open_cloud.hpp"
#include "simulator/scene.hpp"
#include "tests/bench/bench_tools.hpp"

namespace scancast::bench {

/// `name`: a scan or a cloud file, or SCENE:POINTS. Cloud files share the cache, which is made with the first of them.
/// Importers lie in `importers`. Exits with a sentence where it cannot be opened.
inline std::shared_ptr<const Cloud> measuredCloud(const std::string& name, int threads, const char* importers,
                                                  std::shared_ptr<BlockCache>& cache) {
    const std::size_t colon = name.find(':');
    if (colon == std::string::npos && isCloudFileAt(name)) {
        if (!cache) {
            BlockCacheOptions options;
            options.memoryLimit = std::uint64_t{4} << 30;
            cache = BlockCache::create(options);
        }
        return orExit(openCloud(name, cache));
    }
    BuildOptions build;
    build.threads = threads;
    build.shape.surfels = true;
    ImportOptions import;
    import.importerDirectory = importers;
    SceneOptions scene;
    scene.scene = name.substr(0, colon);
    if (colon != std::string::npos) scene.points = std::strtoull(name.c_str() + colon + 1, nullptr, 10);
    auto source = orExit(colon == std::string::npos ? openScan(name, import) : simulate(scene));
    return orExit(buildCloud(*source, build));
}

/// For a camera at `factor` of its distance. From close by it looks at the middle: the whole view looks past it, to fit the
/// picture.
inline void aimFrom(double factor, const Cloud& cloud, Camera& camera) {
    if (factor == 1) return;
    const glm::dvec3 middle = (cloud.bounds[0] + cloud.bounds[1]) * 0.5;
    camera.eye += middle - camera.target;
    camera.target = middle;
}

}  // namespace scancast::bench
