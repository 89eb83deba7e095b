#include "ranks/draw/packed_drawing.hpp"

#include <span>

#include "ranks/draw/packing.hpp"

namespace scancast {
namespace {

/// Of a run, what devices look at.
struct PackedRun {
    std::uint32_t node = 0, firstOrdinal = 0;
    double share = 1;
};

/// Of a drawing, what is a value.
struct PackedFlags {
    std::uint8_t surfels, oriented, orientedNodes, curvatures, depth, sun;  // 0 or 1
    std::uint32_t cuts;
    ColorRule color;
    Background background;
    Window window;
};

void pack(const CutView& view, Packer& out) {
    out.put(view.viewpoint);
    out.put(view.filter.classes);
    out.put(view.filter.clip);
    out.putFlag(view.filter.outliers);
    out.putAll(std::span<const Region>(view.filter.shapes.kept));
    out.putAll(std::span<const Region>(view.filter.shapes.dropped));
    out.putAll(std::span<const Region>(view.filter.dropped));
    out.put(view.glass);
    out.put(view.cut.samples);
    out.putFlag(view.cut.beside);
    std::vector<PackedRun> runs;
    runs.reserve(view.cut.runs.size());
    for (const CutRun& run : view.cut.runs) runs.push_back({run.nodeIndex, run.firstOrdinal, run.share});
    out.putAll(std::span<const PackedRun>(runs));
}

void unpack(Unpacker& in, CutView& view) {
    in.get(view.viewpoint);
    in.get(view.filter.classes);
    in.get(view.filter.clip);
    in.getFlag(view.filter.outliers);
    for (auto* const regions :
         {&view.filter.shapes.kept, &view.filter.shapes.dropped, &view.filter.dropped}) {
        in.getAll(*regions);
        for (const Region& region : *regions)
            if (region.count < 0 || region.count > Region::mostPlanes) in.fail();
    }
    in.get(view.glass);
    in.get(view.cut.samples);
    in.getFlag(view.cut.beside);
    std::vector<PackedRun> runs;
    in.getAll(runs);
    for (const PackedRun& packed : runs) {
        CutRun& run = view.cut.runs.emplace_back();
        run.nodeIndex = packed.node;
        run.firstOrdinal = packed.firstOrdinal;
        run.share = packed.share;
    }
}

}  // namespace

RankBytes packDrawing(const CloudPlace& cloud, const Drawing& drawing) {
    Packer out;
    out.putText(cloud.path);
    out.putText(cloud.revision);
    out.put(PackedFlags{
        std::uint8_t(drawing.surfels), std::uint8_t(drawing.oriented), std::uint8_t(drawing.orientedNodes),
        std::uint8_t(drawing.curvatures), std::uint8_t(drawing.depth), std::uint8_t(drawing.sun != nullptr),
        std::uint32_t(drawing.cuts.size()), drawing.color, drawing.background, drawing.window});
    out.putAll(drawing.passes);
    out.putAll(drawing.jitter);
    for (const CutView& view : drawing.cuts) pack(view, out);
    if (drawing.sun != nullptr) pack(*drawing.sun, out);
    return std::move(out.bytes);
}

Expected<std::unique_ptr<UnpackedDrawing>> unpackDrawing(std::span<const std::byte> bytes) {
    auto out = std::make_unique<UnpackedDrawing>();
    Unpacker in(bytes);
    in.getText(out->cloud.path);
    in.getText(out->cloud.revision);
    PackedFlags flags{};
    in.get(flags);
    for (const std::uint8_t flag :
         {flags.surfels, flags.oriented, flags.orientedNodes, flags.curvatures, flags.depth, flags.sun})
        if (flag > 1) in.fail();
    in.getAll(out->passes);
    in.getAll(out->jitter);
    for (std::uint32_t i = 0; i < flags.cuts && !in.failed(); ++i) unpack(in, out->cuts.emplace_back());
    if (flags.sun != 0 && !in.failed()) unpack(in, out->sun.emplace());
    for (const Pass& pass : out->passes)
        if (pass.index() >= std::variant_size_v<Pass>) in.fail();
    if (!in.sound() || out->cuts.empty())
        return fail(ErrorCode::Internal,
                    "What a rank was told to draw is no drawing; are all ranks of one version?");
    Drawing& d = out->drawing;
    d.cuts = out->cuts;
    if (out->sun) d.sun = &*out->sun;
    d.surfels = flags.surfels != 0;
    d.oriented = flags.oriented != 0;
    d.orientedNodes = flags.orientedNodes != 0;
    d.curvatures = flags.curvatures != 0;
    d.depth = flags.depth != 0;
    d.color = flags.color;
    d.background = flags.background;
    d.window = flags.window;
    d.passes = out->passes;
    d.jitter = out->jitter;
    return out;
}

std::vector<CutView*> UnpackedDrawing::allCuts() {
    std::vector<CutView*> all;
    for (CutView& view : cuts) all.push_back(&view);
    if (sun) all.push_back(&*sun);
    return all;
}

Expected<void> UnpackedDrawing::findNodes(const Octree& octree) {
    for (CutView* const view : allCuts()) {
        view->cut.source = octree.source();
        for (CutRun& run : view->cut.runs) {
            if (run.nodeIndex >= octree.nodes().size())
                return fail(
                    ErrorCode::InvalidArgument,
                    cloud.path + " has other nodes on one of the ranks; it must be the same file on all.");
            run.node = &octree.node(run.nodeIndex);
        }
    }
    return {};
}

}  // namespace scancast
