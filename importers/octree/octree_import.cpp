#include "importers/octree/octree_import.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "importers/octree/ept/ept_octree.hpp"
#include "importers/octree/potree/potree_octree.hpp"
#include "renderer/cloud/import/printable_text.hpp"

namespace scancast::import_octree {

namespace {

// Pieces across the octree where a first look at the colours is taken; any 16-bit scan is found out by it.
constexpr std::size_t firstLooks = 16;
constexpr std::uint64_t firstLookPoints = 256;

/// What the colours of some pieces say, until it is certain.
Expected<LasColorDepth> lookAt(const Octree& octree, const std::vector<std::size_t>& pieces,
                               std::uint64_t points, unsigned threads) {
    LasColorDepth depth = LasColorDepth::Unknown;
    using Runner = PieceRunner<LasColorDepth>;
    Runner::Work work;
    work.pieces = pieces.size();
    work.memory = [&](std::size_t i) { return octree.memoryOf(pieces[i]); };
    work.decode = [&](std::size_t i, const Runner::Give& give) -> Expected<void> {
        LasColorDepth found = LasColorDepth::Unknown;
        auto done = octree.read(
            pieces[i], {points, true},
            [&](const RecordDecoder& decoder, std::span<const std::byte> records) -> Expected<bool> {
                found = std::max(found, decoder.colorDepth(records));
                return found != LasColorDepth::SixteenBits;
            });
        give(found);
        return done;
    };
    work.take = [&](LasColorDepth found) -> Expected<bool> {
        depth = std::max(depth, found);
        return depth != LasColorDepth::SixteenBits;
    };
    if (auto ok = Runner::run(work, threads); !ok) return passOn(ok);
    return depth;
}

/// The same rule as for LAS: 8 bits only if no number in the whole scan is above 255.
Expected<LasColorDepth> judgeColors(const Octree& octree, unsigned threads) {
    if (!octree.mayHaveWideColors()) return LasColorDepth::EightBits;
    std::vector<std::size_t> some, all;
    const auto step = std::max<std::size_t>(1, octree.pieces() / firstLooks);
    for (std::size_t piece = 0; piece < octree.pieces(); ++piece) {
        if (piece % step == 0) some.push_back(piece);
        all.push_back(piece);
    }
    const auto first = lookAt(octree, some, firstLookPoints, threads);
    if (!first || *first == LasColorDepth::SixteenBits) return first;
    return lookAt(octree, all, Wanted{}.points, threads);
}

std::unique_ptr<TreeFiles> filesOf(InputFolder folder) {
    return std::make_unique<FolderFiles>(std::move(folder));
}

/// The description that a folder has.
Expected<std::string> descriptionIn(const TreeFiles& files) {
    for (const char* name : descriptions)
        if (files.has(name)) return std::string(name);
    return fail(
        ErrorCode::Unsupported,
        "it is a folder without ept.json, metadata.json or cloud.js, so it is no octree of EPT or Potree");
}

}  // namespace

Expected<std::unique_ptr<Octree>> openOctree(const TreeFiles& files, const std::string& description,
                                             bool keepAttributes) {
    if (description == "ept.json") return openEpt(files, keepAttributes);
    if (description == "metadata.json") return openPotree2(files, keepAttributes);
    return openPotree1(files, keepAttributes);
}

Expected<void> writeOctree(const Octree& octree, PointStreamWriter& writer, unsigned threads) {
    const auto depth = judgeColors(octree, threads);
    if (!depth) return passOn(depth);
    if (auto ok = octree.areSteps() ? writer.writeHeaderOfSteps(octree.header())
                                    : writer.writeHeader(octree.header());
        !ok)
        return ok;
    for (const auto& note : octree.notes())
        if (auto ok = writer.writeNote(note); !ok) return ok;

    std::uint64_t dropped = 0, outside = 0;
    using Runner = PieceRunner<DecodedPoints>;
    Runner::Work work;
    work.pieces = octree.pieces();
    work.memory = [&](std::size_t piece) { return octree.memoryOf(piece); };
    work.decode = [&](std::size_t piece, const Runner::Give& give) {
        return octree.read(piece, {}, [&](const RecordDecoder& decoder, std::span<const std::byte> records) {
            DecodedPoints points;
            decoder.decode(records, *depth, points);
            return Expected<bool>(give(std::move(points)));
        });
    };
    work.take = [&](DecodedPoints points) -> Expected<bool> {
        dropped += points.dropped;
        outside += points.outside;
        if (auto ok = writer.writeChunk(points.batch); !ok) return passOn(ok);
        return true;
    };
    if (auto ok = Runner::run(work, threads); !ok) return ok;
    if (outside > 0)
        if (auto ok = writer.writeNote(
                fmt::format("{} of its numbers are outside of what is kept of them (intensities and "
                            "colours of 0 to 65,535, classes of 0 to 255)",
                            grouped(outside)));
            !ok)
            return ok;
    if (writer.points() == 0) return fail(ErrorCode::Empty, "none of its points has finite coordinates");
    return writer.finish(dropped);
}

Expected<void> importOctree(const std::filesystem::path& path, bool keepAttributes,
                            PointStreamWriter& writer) {
    const auto name = path.filename().string();
    const bool isDescription =
        std::find(descriptions.begin(), descriptions.end(), name) != descriptions.end();
    auto folder = InputFolder::open(!isDescription           ? path
                                    : path.has_parent_path() ? path.parent_path()
                                                             : ".");
    if (!folder) return fail(ErrorCode::Io, "its folder cannot be opened");
    const auto files = filesOf(std::move(*folder));
    const auto description = isDescription ? Expected<std::string>(name) : descriptionIn(*files);
    if (!description) return passOn(description);
    const auto octree = openOctree(*files, *description, keepAttributes);
    if (!octree) return passOn(octree);
    return writeOctree(**octree, writer);
}

}  // namespace scancast::import_octree
