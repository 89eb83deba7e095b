#include "renderer/cloud/import/open_scan.hpp"

#include <array>
#include <string_view>
#include <utility>

#include "renderer/cloud/import/byte_source.hpp"
#include "renderer/cloud/import/las/las_source.hpp"
#include "renderer/cloud/import/scan_format.hpp"
#include "renderer/cloud/import/stream/importer_source.hpp"
#include "renderer/cloud/import/text/obj_source.hpp"
#include "renderer/cloud/import/text/ptx_source.hpp"
#include "renderer/cloud/import/text/text_source.hpp"

namespace scancast {

namespace {

const ImporterProgram pclImporter{.name = "scancast-import-pcl", .knowsRecover = true};
const ImporterProgram e57Importer{
    .name = "scancast-import-e57", .knowsKeepAttributes = true, .knowsRecover = true};
const ImporterProgram lazImporter{.name = "scancast-import-laz", .knowsRecover = true};
const ImporterProgram octreeImporter{.name = "scancast-import-octree", .knowsKeepAttributes = true};

/// ".PTS" and ".pts" say the same.
std::string extensionOf(const std::filesystem::path& file) {
    auto extension = file.extension().string();
    for (char& c : extension)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return extension;
}

template <class Source>
Expected<std::unique_ptr<PointSource>> opened(Expected<std::unique_ptr<Source>> source) {
    if (!source) return passOn(source);
    return std::unique_ptr<PointSource>(std::move(*source));
}

struct Looked {
    std::unique_ptr<FileByteSource> bytes;
    std::string extension;
    Identified identified;
};

Expected<Looked> lookAt(const ScanInput& input) {
    const auto name = input.path().string();
    auto file = input.file().share();
    if (!file) return passOn(file);
    auto bytes = FileByteSource::create(std::move(*file).release(), name);
    if (!bytes) return passOn(bytes);
    std::array<std::byte, identifyBytes> start{};
    const auto got = (*bytes)->readAt(0, start);
    if (!got) return passOn(got);
    if (*got == 0) return fail(ErrorCode::Empty, name + " is an empty file (0 bytes)");
    auto extension = extensionOf(input.path());
    auto identified = identifyScan(std::span(start).first(*got), extension);
    return Looked{std::move(*bytes), std::move(extension), std::move(identified)};
}

Expected<std::unique_ptr<PointSource>> openAsItIs(const ScanInput& input, const ImportOptions& options) {
    const auto name = input.path().string();
    if (input.octree()) return opened(ImporterSource::create(octreeImporter, input, options));
    auto looked = lookAt(input);
    if (!looked) return passOn(looked);
    auto& [bytes, extension, identified] = *looked;
    switch (identified.format) {
        case ScanFormat::Las:
            return opened(LasSource::create(std::move(bytes), name, options.keepAttributes, options.recover,
                                            options.exact, options.looksInParts));
        case ScanFormat::Laz:
            return opened(ImporterSource::create(lazImporter, input, options));
        case ScanFormat::E57:
            return opened(ImporterSource::create(e57Importer, input, options));
        case ScanFormat::Ply:
        case ScanFormat::Pcd:
            return opened(ImporterSource::create(pclImporter, input, options));
        case ScanFormat::Text:
            return opened(TextSource::create(std::move(bytes), name,
                                             {.pts = extension == ".pts",
                                              .keepAttributes = options.keepAttributes,
                                              .recover = options.recover}));
        case ScanFormat::Ptx:
            return opened(PtxSource::create(std::move(bytes), name, options.recover));
        case ScanFormat::Obj:
            return opened(ObjSource::create(std::move(bytes), name));
        case ScanFormat::Unknown:
            break;
    }
    return fail(ErrorCode::Unsupported,
                name + ", byte 0: " + identified.reason + ". " + std::string(readableFormats()) + ".");
}

}  // namespace

Expected<std::unique_ptr<PointSource>> openScan(const ScanInput& input, const ImportOptions& options) {
    auto source = openAsItIs(input, options);
    if (!source || !options.assumeCrs) return source;
    return withCrs(std::move(*source), *options.assumeCrs, input.path().string());
}

bool needsImporter(const ScanInput& input) {
    if (input.octree()) return true;
    const auto looked = lookAt(input);
    if (!looked) return false;
    const ScanFormat format = looked->identified.format;
    return format == ScanFormat::Laz || format == ScanFormat::E57 || format == ScanFormat::Ply ||
           format == ScanFormat::Pcd;
}

std::string_view name(ImporterSandbox sandbox) {
    switch (sandbox) {
        case ImporterSandbox::Require:
            return "require";
        case ImporterSandbox::Off:
            return "off";
        case ImporterSandbox::Auto:
            break;
    }
    return "auto";
}

Expected<std::unique_ptr<PointSource>> openScan(const std::filesystem::path& path,
                                                const ImportOptions& options) {
    const auto input = ScanInput::open(path);
    if (!input) return passOn(input);
    return openScan(*input, options);
}

}  // namespace scancast
