// What the server carries of the page: the right bytes in every encoding, small, under addresses that fit together.
#include <brotli/decode.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <iostream>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "server/net/page/file_answer.hpp"
#include "server/net/page/page.hpp"

namespace scancast {
namespace {

std::string unbrotli(std::string_view packed, std::size_t size) {
    std::string bytes(size, '\0');
    EXPECT_EQ(BrotliDecoderDecompress(packed.size(), reinterpret_cast<const std::uint8_t*>(packed.data()),
                                      &size, reinterpret_cast<std::uint8_t*>(bytes.data())),
              BROTLI_DECODER_RESULT_SUCCESS);
    bytes.resize(size);
    return bytes;
}

std::string gunzip(std::string_view packed, std::size_t size) {
    z_stream stream{};
    EXPECT_EQ(inflateInit2(&stream, 15 + 16), Z_OK);
    std::string bytes(size + 1, '\0');
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
    stream.avail_in = uInt(packed.size());
    stream.next_out = reinterpret_cast<Bytef*>(bytes.data());
    stream.avail_out = uInt(bytes.size());
    EXPECT_EQ(inflate(&stream, Z_FINISH), Z_STREAM_END);
    bytes.resize(stream.total_out);
    inflateEnd(&stream);
    return bytes;
}

HttpResponse get(std::string_view path, const std::string& codings, const std::string& tag = {}) {
    const auto asset = findAsset(path);
    EXPECT_TRUE(asset) << path;
    return fileAnswer({"GET", std::string(path), {{"accept-encoding", codings}, {"if-none-match", tag}}},
                      *asset);
}

std::string inFolder(const std::string& file) {
    return "/assets/" + std::string(pageFiles().hash) + file;
}

// Right because other functions of the libraries, those that browsers have too, unpack what was packed.
TEST(PageFiles, EveryEncodingIsTheFile) {
    for (const PackedFiles& packed : {pageFiles(), apiDescription()}) {
        ASSERT_FALSE(packed.files.empty());
        for (const Asset& file : packed.files) {
            EXPECT_FALSE(file.bytes.empty()) << file.path;
            if (!file.brotli.empty()) {
                EXPECT_EQ(unbrotli(file.brotli, file.bytes.size()), file.bytes) << file.path;
            }
            if (!file.gzip.empty()) {
                EXPECT_EQ(gunzip(file.gzip, file.bytes.size()), file.bytes) << file.path;
            }
        }
    }
}

/// What a file's text names where `pattern` matches, from the root: "../a/b.css" in "/x/y.js" is "/a/b.css".
std::vector<std::string> namesIn(const std::string& path, const std::regex& pattern) {
    const std::string text(findAsset(path)->file->bytes);
    std::vector<std::string> named;
    for (std::sregex_iterator at(text.begin(), text.end(), pattern), end; at != end; ++at) {
        std::string name = (*at)[1].str(), folder = path.substr(0, path.rfind('/'));
        EXPECT_TRUE(name.starts_with("./") || name.starts_with("../")) << path << ": " << name;
        while (name.starts_with("./") || name.starts_with("../")) {
            if (name.starts_with("../")) folder = folder.substr(0, folder.rfind('/'));
            name = name.substr(name.find('/') + 1);
        }
        named.push_back(folder + "/" + name);
    }
    return named;
}

/// What the page's HTML names, by content.
std::set<std::string> namedByThePage() {
    const std::string page(findAsset("/")->file->bytes);
    const std::regex attribute("(?:href|src)=\"([^\"#][^\"]*)\"");
    std::set<std::string> named;
    for (std::sregex_iterator at(page.begin(), page.end(), attribute), end; at != end; ++at) {
        const std::string path = "/" + (*at)[1].str();
        if (path.find("//") == std::string::npos) named.insert(path);
    }
    return named;
}

/// All modules that these lead to, by names that `import` matches.
std::set<std::string> modulesFrom(const std::set<std::string>& files, const std::regex& import) {
    std::set<std::string> modules;
    for (const std::string& path : files)
        if (path.ends_with(".js")) modules.insert(path);
    for (std::set<std::string> next = modules; !next.empty();) {
        const std::string path = *next.begin();
        next.erase(next.begin());
        for (const std::string& named : namesIn(path, import)) {
            const auto asset = findAsset(named);
            EXPECT_TRUE(asset && asset->forever) << path << " imports " << named;
            if (asset && modules.insert(named).second) next.insert(named);
        }
    }
    return modules;
}

const std::regex imports("(?:from|import)\\s*\\(?\\s*'([^']+)'");
/// Those that a browser follows at once; the others, `import('…')`, when somebody uses what is behind them.
const std::regex importsAtOnce("(?:from|import)\\s*'([^']+)'");

std::size_t sizeOf(const Asset& file) {
    return file.brotli.empty() ? file.bytes.size() : file.brotli.size();
}

// The first load is what everybody waits for before he sees anything; the rest comes with the tool that is used.
TEST(PageFiles, AreSmall) {
    // 2.4 kB of it are video, of which 1.1 come with the first moving frame.
    constexpr std::size_t mostAtFirst = 149'000, most = 270'400;
    std::size_t all = 0, gzip = 0, first = sizeOf(*findAsset("/")->file);
    for (const Asset& file : pageFiles().files) {
        gzip += file.gzip.empty() ? file.bytes.size() : file.gzip.size();
        all += sizeOf(file);
    }
    std::set<std::string> atFirst = namedByThePage();
    atFirst.merge(modulesFrom(atFirst, importsAtOnce));
    for (const std::string& path : atFirst) first += sizeOf(*findAsset(path)->file);
    std::cout << "The page: " << atFirst.size() + 1 << " files at first, as br " << first << " bytes of "
              << mostAtFirst << "; " << pageFiles().files.size() << " files in all, as br " << all << " of "
              << most << ", as gzip " << gzip << "\n";
    EXPECT_LE(first, mostAtFirst);
    EXPECT_LE(all, most);
    EXPECT_LT(all, gzip);
    EXPECT_LT(first, all) << "tools are loaded when they are first used";
}

// A browser that follows every name from `/` on gets every file by its content, so that it keeps all of them.
TEST(PageFiles, ThePageNamesItsPartsByContent) {
    const std::set<std::string> files = namedByThePage();
    for (const std::string& path : files) {
        const auto asset = findAsset(path);
        ASSERT_TRUE(asset) << path;
        EXPECT_TRUE(asset->forever) << path;
    }
    const std::set<std::string> modules = modulesFrom(files, imports);
    EXPECT_GT(modules.size(), modulesFrom(files, importsAtOnce).size());
    // Style sheets of tools, by their names in styles/ (client/web/page/lazy_tools.js).
    const std::regex sheet("'([a-z_]+\\.css)'");
    std::set<std::string> sheets;
    for (const std::string& path : modules) {
        const std::string text(findAsset(path)->file->bytes);
        for (std::sregex_iterator at(text.begin(), text.end(), sheet), end; at != end; ++at)
            sheets.insert(inFolder("/styles/" + (*at)[1].str()));
    }
    EXPECT_TRUE(sheets.contains(inFolder("/styles/measure.css")));
    for (const std::string& path : sheets) EXPECT_TRUE(findAsset(path)) << path;
    // And nothing is carried that nothing leads to.
    for (const Asset& file : pageFiles().files) {
        const std::string path = inFolder(std::string(file.path));
        if (file.path == "/index.html") continue;
        EXPECT_TRUE(files.contains(path) || modules.contains(path) || sheets.contains(path)) << file.path;
    }
}

TEST(PageFiles, AddressesOfContentLastAndOthersAreAskedAgain) {
    const std::string script = "/main.js";
    EXPECT_FALSE(findAsset(script)->forever);
    EXPECT_TRUE(findAsset(inFolder(script))->forever);
    EXPECT_EQ(findAsset(inFolder(script))->file, findAsset(script)->file);
    // A tab from before an upgrade: today's file, and nothing that would be kept under that name.
    ASSERT_TRUE(findAsset("/assets/0123456789abcdef/main.js"));
    EXPECT_FALSE(findAsset("/assets/0123456789abcdef/main.js")->forever);
    for (const std::string& path :
         {std::string("/assets"), std::string("/assets/"), std::string("/assets//main.js"), inFolder(""),
          inFolder("/"), inFolder("/nothing.js"), inFolder("/index.html"), std::string("main.js"),
          std::string()})
        EXPECT_FALSE(findAsset(path)) << path;

    EXPECT_EQ(*get("/", "br").find("Cache-Control"), "no-cache");
    EXPECT_EQ(*get(script, "br").find("Cache-Control"), "no-cache");
    EXPECT_EQ(*get("/assets/old/main.js", "br").find("Cache-Control"), "no-cache");
    EXPECT_EQ(*get(inFolder(script), "br").find("Cache-Control"), "public, max-age=31536000, immutable");
}

TEST(PageFiles, EachEncodingHasItsTag) {
    std::set<std::string> tags;
    for (const auto& [asked, coding] : {std::pair<const char*, const char*>{"gzip, deflate, br, zstd", "br"},
                                        {"gzip", "gzip"},
                                        {"identity", nullptr}}) {
        const HttpResponse first = get("/main.js", asked);
        EXPECT_EQ(first.status, 200);
        EXPECT_EQ(*first.find("Content-Type"), "text/javascript; charset=utf-8");
        EXPECT_EQ(*first.find("Vary"), "Accept-Encoding");
        const std::string* encoded = first.find("Content-Encoding");
        ASSERT_EQ(encoded != nullptr, coding != nullptr) << asked;
        if (coding != nullptr) {
            EXPECT_EQ(*encoded, coding);
        }
        const std::string tag = *first.find("ETag");
        EXPECT_TRUE(tags.insert(tag).second) << asked;
        const HttpResponse again = get("/main.js", asked, tag);
        EXPECT_EQ(again.status, 304) << asked;
        EXPECT_TRUE(again.body().empty());
        EXPECT_EQ(*again.find("ETag"), tag);
        EXPECT_EQ(*again.find("Vary"), "Accept-Encoding");
    }
    EXPECT_EQ(get("/main.js", "gzip", *get("/main.js", "br").find("ETag")).status, 200);
}

}  // namespace
}  // namespace scancast
