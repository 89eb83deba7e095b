#include "renderer/device/gl/memory/layer_memory.hpp"

#include "renderer/device/gl/memory/composed_runs.hpp"

namespace scancast::gl {

Expected<void> LayerMemory::tell(const SampleBatch& told, const BatchTables::Needs& needs) {
    const std::vector<RunFacts>& known = facts.values();
    const BatchTables::MadeOf of{told.version, facts.version(), needs.chunkSamples, needs.extents};
    if (of == batch.madeOf) return {};
    batch.madeOf = {};
    batch.pages.clear();
    chunkList.clear();
    extentList.clear();
    for (const SampleBatch::Page& page : told.pages) {
        BatchTables::PageWork work;
        work.firstChunk = static_cast<std::uint32_t>(chunkList.size());
        work.firstExtent = static_cast<std::uint32_t>(extentList.size());
        for (const Extent& e : page.extents) {
            const std::uint32_t run = needs.runOfCut[e.run];
            if (needs.extents)
                extentList.push_back(
                    {uvec4(known[run].color.z + e.first, e.count, run, e.at), uvec4(e.beside, 0, 0, 0)});
            for (std::uint32_t i = 0; i < e.count; i += needs.chunkSamples)
                chunkList.push_back(
                    {uvec4(e.at + i, std::min(needs.chunkSamples, e.count - i), run, e.first + i),
                     uvec4(e.beside + i, 0, 0, 0)});
        }
        std::sort(extentList.begin() + work.firstExtent, extentList.end(),
                  [](const SplatExtent& a, const SplatExtent& b) { return a.range.x < b.range.x; });
        work.chunks = static_cast<std::uint32_t>(chunkList.size()) - work.firstChunk;
        work.extents = static_cast<std::uint32_t>(extentList.size()) - work.firstExtent;
        batch.pages.push_back(work);
    }
    if (auto ok = fillBuffer(chunks, chunkList, ring); !ok) return ok;
    if (auto ok = fillBuffer(extents, extentList, ring); !ok) return ok;
    batch.madeOf = of;
    return {};
}

Expected<void> LayerMemory::compose(ScreenShaders& shaders, const ComposeParams& params, bool onGpu) {
    const std::vector<RunFacts>& known = facts.values();
    if (onGpu) {
        if (auto ok = runs.reserve(roomFor(known.size() * sizeof(RunParams))); !ok) return ok;
        return composeOnGpu(shaders, facts.buffer(), params, runs);
    }
    runList.resize(known.size());
    std::ranges::transform(known, runList.begin(), [&](const RunFacts& of) { return composed(of, params); });
    return fillBuffer(runs, runList, ring);
}

}  // namespace scancast::gl
