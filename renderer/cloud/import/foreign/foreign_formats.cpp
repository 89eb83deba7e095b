#include "renderer/cloud/import/foreign/foreign_formats.hpp"

#include <algorithm>
#include <array>

#include "renderer/cloud/import/foreign/foreign_table.hpp"

namespace scancast {

namespace {

using namespace std::string_view_literals;
using Format = const ForeignFormat*;

struct Signature {
    std::string_view bytes;
    Format format;
    std::size_t at = 0;  ///< where they stand
};

// What begins alike stands with the longer one first.
constexpr Signature signatures[] = {
    {"version https://git-lfs"sv, &foreign::lfsPointer},
    {"CCB2"sv, &foreign::cloudCompare},
    {"CXYZ"sv, &foreign::terraScan, 12},
    {"wild::geosystems"sv, &foreign::leicaProject},
    {"BPF!"sv, &foreign::bpf},
    {"LASX"sv, &foreign::lasIndex},
    {"glTF"sv, &foreign::gltf},
    {"pnts"sv, &foreign::tiles},
    {"b3dm"sv, &foreign::tiles},
    {"i3dm"sv, &foreign::tiles},
    {"cmpt"sv, &foreign::tiles},
    {"NGSP"sv, &foreign::spz},
    {"DRACO"sv, &foreign::draco},
    {"solid "sv, &foreign::stl},
    {"OFF\n"sv, &foreign::off},
    {"OFF\r"sv, &foreign::off},
    {"COFF\n"sv, &foreign::off},
    {"NOFF\n"sv, &foreign::off},
    {"Kaydara FBX"sv, &foreign::fbx},
    {"; FBX"sv, &foreign::fbx},
    {"#VRML"sv, &foreign::vrml},
    {"# vtk DataFile"sv, &foreign::vtk},
    {"ISO-10303-21"sv, &foreign::ifc},
    {"AutoCAD Binary DXF"sv, &foreign::dxf},
    {"AC10"sv, &foreign::dwg},
    {"GRID1."sv, &foreign::binaryGrid},
    {"II*\0"sv, &foreign::tiff},
    {"II+\0"sv, &foreign::tiff},
    {"MM\0*"sv, &foreign::tiff},
    {"MM\0+"sv, &foreign::tiff},
    {"\x00\x00\x27\x0a\x00\x00\x00\x00"sv, &foreign::shapefile},
    {"SQLite format 3\0"sv, &foreign::geoPackage},
    {"\x89HDF\r\n"sv, &foreign::hdf5},
    {"CDF\x01"sv, &foreign::netCdf},
    {"CDF\x02"sv, &foreign::netCdf},
    {"CDF\x05"sv, &foreign::netCdf},
    {"\x93NUMPY"sv, &foreign::numpy},
    {"PAR1"sv, &foreign::parquet},
    {"#ROSBAG"sv, &foreign::rosBag},
    {"\x89MCAP"sv, &foreign::rosBag},
    {"PK\x03\x04"sv, &foreign::zip},
    {"PK\x05\x06"sv, &foreign::zip},
    {"\x1f\x8b"sv, &foreign::gzip},
    {"BZh"sv, &foreign::bzip2},
    {"\xfd"
     "7zXZ"sv,
     &foreign::xz},
    {"\x28\xb5\x2f\xfd"sv, &foreign::zstd},
    {"7z\xbc\xaf"sv, &foreign::sevenZip},
    {"Rar!"sv, &foreign::rar},
    {"ustar"sv, &foreign::tar, 257},
    {"\xff\xd8\xff"sv, &foreign::picture},
    {"\x89PNG"sv, &foreign::picture},
    {"GIF8"sv, &foreign::picture},
    {"WEBP"sv, &foreign::picture, 8},
    {"%PDF"sv, &foreign::pdf},
    {"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1"sv, &foreign::ole},
    {"\x7f"
     "ELF"sv,
     &foreign::program},
};

struct Extension {
    std::string_view extension;
    Format format;
};

// Those whose content says nothing, or only what it is packed in.
constexpr Extension extensions[] = {
    {".rcp", &foreign::recap},
    {".rcs", &foreign::recap},
    {".fls", &foreign::faro},
    {".fws", &foreign::faro},
    {".lsproj", &foreign::faro},
    {".lsprojx", &foreign::faro},
    {".zfs", &foreign::zollerFroehlich},
    {".zfprj", &foreign::zollerFroehlich},
    {".zfc", &foreign::zollerFroehlich},
    {".rxp", &foreign::rieglRxp},
    {".3dd", &foreign::rieglRxp},
    {".rdbx", &foreign::rieglRdb},
    {".rdb", &foreign::rieglRdb},
    {".ptg", &foreign::leicaPtg},
    {".lgs", &foreign::leicaProject},
    {".lgsx", &foreign::leicaProject},
    {".imp", &foreign::leicaProject},
    {".tzf", &foreign::trimble},
    {".tzs", &foreign::trimble},
    {".rwp", &foreign::trimble},
    {".clr", &foreign::topcon},
    {".cl3", &foreign::topcon},
    {".pod", &foreign::pointools},
    {".bpf", &foreign::bpf},
    {".wdp", &foreign::waveform},
    {".lax", &foreign::lasIndex},
    {".spz", &foreign::spz},
    {".splat", &foreign::splat},
    {".ksplat", &foreign::splat},
    {".sog", &foreign::splat},
    {".slpk", &foreign::slpk},
    {".gltf", &foreign::gltf},
    {".glb", &foreign::gltf},
    {".pnts", &foreign::tiles},
    {".b3dm", &foreign::tiles},
    {".drc", &foreign::draco},
    {".stl", &foreign::stl},
    {".off", &foreign::off},
    {".fbx", &foreign::fbx},
    {".dae", &foreign::collada},
    {".wrl", &foreign::vrml},
    {".x3d", &foreign::vrml},
    {".vtk", &foreign::vtk},
    {".vtp", &foreign::vtk},
    {".vtu", &foreign::vtk},
    {".ifc", &foreign::ifc},
    {".dxf", &foreign::dxf},
    {".dwg", &foreign::dwg},
    {".adf", &foreign::binaryGrid},
    {".shp", &foreign::shapefile},
    {".gpkg", &foreign::geoPackage},
    {".h5", &foreign::hdf5},
    {".hdf5", &foreign::hdf5},
    {".nc", &foreign::netCdf},
    {".bag", &foreign::rosBag},
    {".mcap", &foreign::rosBag},
    {".npy", &foreign::numpy},
    {".parquet", &foreign::parquet},
};

constexpr std::array everything{&foreign::cloudCompare,
                                &foreign::terraScan,
                                &foreign::recap,
                                &foreign::faro,
                                &foreign::zollerFroehlich,
                                &foreign::rieglRxp,
                                &foreign::rieglRdb,
                                &foreign::leicaPtg,
                                &foreign::leicaProject,
                                &foreign::trimble,
                                &foreign::topcon,
                                &foreign::pointools,
                                &foreign::bpf,
                                &foreign::lasIndex,
                                &foreign::waveform,
                                &foreign::gltf,
                                &foreign::tiles,
                                &foreign::spz,
                                &foreign::splat,
                                &foreign::slpk,
                                &foreign::draco,
                                &foreign::stl,
                                &foreign::off,
                                &foreign::fbx,
                                &foreign::collada,
                                &foreign::vrml,
                                &foreign::vtk,
                                &foreign::ifc,
                                &foreign::dxf,
                                &foreign::dwg,
                                &foreign::asciiGrid,
                                &foreign::binaryGrid,
                                &foreign::tiff,
                                &foreign::shapefile,
                                &foreign::geoPackage,
                                &foreign::hdf5,
                                &foreign::netCdf,
                                &foreign::numpy,
                                &foreign::parquet,
                                &foreign::rosBag,
                                &foreign::zip,
                                &foreign::gzip,
                                &foreign::bzip2,
                                &foreign::xz,
                                &foreign::zstd,
                                &foreign::sevenZip,
                                &foreign::rar,
                                &foreign::tar,
                                &foreign::picture,
                                &foreign::pdf,
                                &foreign::webPage,
                                &foreign::xml,
                                &foreign::json,
                                &foreign::ole,
                                &foreign::lfsPointer,
                                &foreign::program};

bool beginsWith(std::string_view text, std::string_view lowerCase) {
    if (text.size() < lowerCase.size()) return false;
    return std::equal(lowerCase.begin(), lowerCase.end(), text.begin(), [](char wanted, char c) {
        return wanted == (c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c);
    });
}

bool holds(std::string_view text, std::string_view word) {
    return text.find(word) != std::string_view::npos;
}

std::string_view withoutBlanks(std::string_view text) {
    if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
    const auto begin = text.find_first_not_of(" \t\r\n");
    return begin == std::string_view::npos ? std::string_view() : text.substr(begin);
}

/// Packed files of many programs: what they pack is known by the name.
Format inPacking(Format packing, std::string_view start, std::string_view extension) {
    const bool isZip = packing == &foreign::zip;
    if (isZip && (holds(start, "3dSceneLayer") || holds(start, "@specialIndexFileHASH128@")))
        return &foreign::slpk;
    if (isZip || packing == &foreign::gzip || packing == &foreign::ole || packing == &foreign::geoPackage ||
        packing == &foreign::hdf5)
        if (const auto named = foreignByName(extension)) return named;
    return packing;
}

/// Text that is no points, whatever numbers stand in it.
Format inText(std::string_view start, std::string_view extension) {
    const auto text = withoutBlanks(start);
    if (beginsWith(text, "<!doctype html") || beginsWith(text, "<html") || beginsWith(text, "<head"))
        return &foreign::webPage;
    if (beginsWith(text, "<?xml") || beginsWith(text, "<!doctype")) {
        if (holds(text, "<COLLADA")) return &foreign::collada;
        if (holds(text, "<VTKFile")) return &foreign::vtk;
        const auto named = foreignByName(extension);
        return named ? named : &foreign::xml;
    }
    if (beginsWith(text, "<vtkfile")) return &foreign::vtk;
    if (text.starts_with("{")) {
        if (holds(text, "\"asset\"") && (holds(text, "\"geometricError\"") || holds(text, "\"root\"")))
            return &foreign::tiles;
        if (holds(text, "\"asset\"") && (holds(text, "\"buffers\"") || extension == ".gltf"))
            return &foreign::gltf;
        return &foreign::json;
    }
    if (beginsWith(text, "ncols") || beginsWith(text, "nrows")) return &foreign::asciiGrid;
    if (text.starts_with("0\n") || text.starts_with("0\r\n"))
        if (withoutBlanks(text.substr(1)).starts_with("SECTION")) return &foreign::dxf;
    return nullptr;
}

}  // namespace

Format foreignByContent(std::string_view start, std::string_view extension) {
    for (const auto& signature : signatures)
        if (start.size() > signature.at && start.substr(signature.at).starts_with(signature.bytes))
            return inPacking(signature.format, start, extension);
    return inText(start, extension);
}

Format foreignByName(std::string_view extension) {
    const auto found = std::ranges::find(extensions, extension, &Extension::extension);
    return found == std::end(extensions) ? nullptr : found->format;
}

std::string sentence(const ForeignFormat& format) {
    return "it is " + std::string(format.what) + ": " + std::string(format.wayOut);
}

std::span<const Format> foreignFormats() {
    return everything;
}

}  // namespace scancast
