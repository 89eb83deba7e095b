// What Scancast does not read is refused by its name, with a way to something that is read.
#include "renderer/cloud/import/foreign/foreign_formats.hpp"

#include <gmock/gmock.h>

#include <fstream>
#include <set>

#include "renderer/cloud/import/scan_format.hpp"

namespace scancast::test {

using ::testing::HasSubstr;
using ::testing::StartsWith;
using namespace std::string_literals;

namespace {

std::string reasonOf(const std::string& content, const char* extension) {
    const auto found = identifyScan(std::as_bytes(std::span(content)), extension);
    EXPECT_EQ(found.format, ScanFormat::Unknown) << content << extension;
    return found.reason;
}

const std::string noise = "\x01\x02\x03\x04\x05\xff\xfe"s + std::string(600, '\x9d');

}  // namespace

TEST(ForeignFormats, ByContent) {
    struct Case {
        std::string content;
        const char* extension;
        const char* words;
    };
    const std::string tar = std::string(257, 'a') + "ustar\0"s;
    for (const auto& [content, extension, words] :
         {Case{"CCB2" + noise, "", "CloudCompare BIN"},
          {"\x38\0\0\0\xd5\x28\x31\x01\xa1\xce\x0e\0"s + "CXYZ" + noise, ".bin", "TerraScan"},
          {"wild::geosystems" + noise, ".lgs", "Leica project"},
          {"glTF\x02\0\0\0"s, ".glb", "assimp export"},
          {R"({"asset":{"version":"2.0"},"buffers":[]})", ".gltf", "glTF model"},
          {R"( {"asset":{"version":"1.0"},"geometricError":5,"root":{}})", ".json", "3D Tiles"},
          {"pnts" + noise, ".pnts", "3D Tiles"},
          {"b3dm" + noise, "", "3D Tiles"},
          {"NGSP" + noise, "", "splat-transform"},
          {"\x1f\x8b\x08\0"s, ".spz", "SPZ"},
          {"\x1f\x8b\x08\0"s, ".gz", "gunzip"},
          {"PK\x03\x04" + noise, ".zip", "a ZIP archive"},
          {"PK\x03\x04" + noise, ".slpk", "SLPK"},
          {"PK\x03\x04" + noise + "3dSceneLayer.json.gz", ".zip", "SLPK"},
          {"PK\x03\x04" + noise, ".rcp", "ReCap"},
          {"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1"s, ".fls", "FARO SCENE"},
          {"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1"s, ".lsproj", "FARO SCENE"},
          {"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1"s, ".doc", "OLE compound"},
          {"II*\0"s, ".tif", "gdal_translate"},
          {"MM\0*"s, ".tif", "gdal_translate"},
          {"ncols 4\nnrows 2\nxllcorner 0\n1 2 3 4\n5 6 7 8\n", ".asc", "Esri ASCII grid"},
          {"NCOLS 4\nNROWS 2\n1 2 3 4\n", ".txt", "Esri ASCII grid"},
          {"GRID1.2\0"s + noise, ".adf", "Esri binary grid"},
          {"\x89HDF\r\n\x1a\n"s, ".h5", "HDF5"},
          {"\x89HDF\r\n\x1a\n"s, ".nc", "NetCDF"},
          {"CDF\x01" + noise, ".nc", "NetCDF"},
          {"  0\nSECTION\n  2\nHEADER\n", ".dxf", "DXF"},
          {"AutoCAD Binary DXF\r\n", "", "DXF"},
          {"AC1027" + noise, ".dwg", "DWG"},
          {"solid part\nfacet normal 0 0 1\n", ".stl", "STL"},
          {"Kaydara FBX Binary", ".fbx", "FBX"},
          {"\0\0\x27\x0a\0\0\0\0\0\0\0\0"s, ".shp", "ogr2ogr"},
          {"SQLite format 3\0"s, ".gpkg", "GeoPackage"},
          {"7z\xbc\xaf\x27\x1c", ".7z", "7z x"},
          {"Rar!\x1a\x07", ".rar", "unrar"},
          {tar, ".tar", "tar -xf"},
          {"\xff\xd8\xff\xe0", ".jpg", "a picture"},
          {"%PDF-1.7", ".pdf", "PDF"},
          {"<!DOCTYPE html>", ".laz", "a web page"},
          {"<?xml version=\"1.0\"?><a/>", ".xml", "XML"},
          {"<html>", ".las", "a web page"},
          {"<?xml version=\"1.0\"?><COLLADA/>", "", "COLLADA"},
          {"ISO-10303-21;\n", ".ifc", "IFC"},
          {"BPF!0003", ".bpf", "BPF"},
          {"version https://git-lfs.github.com/spec/v1\n", ".laz", "git lfs pull"},
          {"LASX" + noise, ".lax", "LAX"},
          {"\x93NUMPY\x01\0"s, ".npy", "numpy.savetxt"},
          {"#ROSBAG V2.0\n", ".bag", "ROS"},
          {"\x89PNG\r\n\x1a\n", ".png", "a picture"}}) {
        EXPECT_THAT(reasonOf(content, extension), HasSubstr(words)) << extension;
        EXPECT_THAT(reasonOf(content, extension), StartsWith("it is ")) << extension;
    }
}

TEST(ForeignFormats, ByNameWhereContentSaysNothing) {
    for (const auto& [extension, words] : {std::pair(".rcs", "ReCap"),
                                           {".rcp", "ReCap"},
                                           {".zfs", "Z+F LaserControl"},
                                           {".rxp", "RiSCAN PRO"},
                                           {".rdbx", "readers.rdb"},
                                           {".ptg", "Leica Cyclone"},
                                           {".tzf", "Trimble RealWorks"},
                                           {".clr", "Topcon"},
                                           {".cl3", "Topcon"},
                                           {".fls", "FARO"},
                                           {".stl", "STL"},
                                           {".splat", "splat"},
                                           {".pod", "Pointools"}})
        EXPECT_THAT(reasonOf(noise, extension), HasSubstr(words)) << extension;
    EXPECT_THAT(reasonOf(noise, ".xyz"), HasSubstr("starts with the bytes 01 02 03 04"));
}

// A name says nothing about content that is read.
TEST(ForeignFormats, WhatIsReadIsRead) {
    const auto format = [](const std::string& content, const char* extension) {
        return identifyScan(std::as_bytes(std::span(content)), extension).format;
    };
    EXPECT_EQ(format("LASF" + noise, ".rcs"), ScanFormat::Laz) << "whatever those bytes say";
    EXPECT_EQ(format("1 2 3\n4 5 6\n", ".fls"), ScanFormat::Text);
    EXPECT_EQ(format("1 2 3\n4 5 6\n", ".asc"), ScanFormat::Text);
    EXPECT_EQ(format("0\n1 2 3\n", ".pts"), ScanFormat::Text);
    EXPECT_EQ(format("ply\nformat ascii 1.0\n", ".stl"), ScanFormat::Ply);
}

TEST(ForeignFormats, EveryOneIsAClearSentence) {
    std::set<std::string_view> seen;
    for (const auto* format : foreignFormats()) {
        EXPECT_TRUE(seen.insert(format->what).second) << format->what;
        const auto text = sentence(*format);
        EXPECT_GT(format->wayOut.size(), 10U) << text;
        for (const char c : text) EXPECT_TRUE(c >= 0x20 && c < 0x7f) << text;
        EXPECT_FALSE(text.ends_with('.')) << text << ": more follows";
    }
    EXPECT_GT(seen.size(), 50U);
}

// docs/formats.md has them all, in the same words.
TEST(ForeignFormats, AreWhatTheDocumentationSays) {
    std::ifstream file(SCANCAST_SOURCE_DIR "/docs/formats.md");
    const std::string page{std::istreambuf_iterator<char>(file), {}};
    for (const auto* format : foreignFormats()) {
        std::string way(format->wayOut);
        // Commands are set as code there.
        for (std::size_t at = 0; (at = way.find('"', at)) != way.npos;) way[at] = '`';
        EXPECT_THAT(page, HasSubstr("| " + std::string(format->what) + " | " + way + " |"));
    }
}

}  // namespace scancast::test
