// Runs while Scancast is built: turns files into a C++ source with them, plain and compressed, so that the server carries
// them in its binary and has nothing to compress (page.hpp says what comes out).
//
//   scancast-pack-files OUTPUT FUNCTION ROOT FILE...
//
// The same files give the same source, byte for byte. In HTML, `href` and `src` that name one of the files are made to
// name it by its content: `assets/HASH/main.js`. What modules and style sheets name from there, they name relatively.
#include <brotli/encode.h>
#include <xxhash.h>
#include <zlib.h>

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace {

struct File {
    std::string path;  ///< from the root: "view/camera.js"
    std::string bytes, gzip, brotli;
    bool isHtml() const { return path.ends_with(".html"); }
};

std::string contentOf(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    if (!file) throw std::runtime_error("cannot read " + path.string());
    return {std::istreambuf_iterator<char>(file), {}};
}

/// Of all files together: names and bytes.
std::string hashOf(const std::vector<File>& files) {
    std::string all;
    for (const File& file : files)
        all += file.path + '\0' + std::to_string(file.bytes.size()) + '\0' + file.bytes;
    char text[17];
    std::snprintf(text, sizeof text, "%016llx",
                  static_cast<unsigned long long>(XXH3_64bits(all.data(), all.size())));
    return text;
}

std::string gzip(std::string_view bytes) {
    z_stream stream{};
    constexpr int gzipWindow = 15 + 16, memoryLevel = 9;  // its header has neither name nor time
    if (deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, gzipWindow, memoryLevel, Z_DEFAULT_STRATEGY) !=
        Z_OK)
        throw std::runtime_error("zlib does not start");
    std::string packed(deflateBound(&stream, uLong(bytes.size())), '\0');
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
    stream.avail_in = uInt(bytes.size());
    stream.next_out = reinterpret_cast<Bytef*>(packed.data());
    stream.avail_out = uInt(packed.size());
    const int ended = deflate(&stream, Z_FINISH);
    packed.resize(stream.total_out);
    deflateEnd(&stream);
    if (ended != Z_STREAM_END) throw std::runtime_error("zlib does not end");
    return packed;
}

std::string brotli(std::string_view bytes) {
    std::size_t size = BrotliEncoderMaxCompressedSize(bytes.size());
    std::string packed(size, '\0');
    if (!BrotliEncoderCompress(BROTLI_MAX_QUALITY, BROTLI_MAX_WINDOW_BITS, BROTLI_MODE_TEXT, bytes.size(),
                               reinterpret_cast<const std::uint8_t*>(bytes.data()), &size,
                               reinterpret_cast<std::uint8_t*>(packed.data())))
        throw std::runtime_error("brotli does not end");
    packed.resize(size);
    return packed;
}

/// What a reference in that file names, from the root: "../a/b.css" in "x/y.html" is "a/b.css".
std::string named(const std::string& reference, const std::string& inFile) {
    const std::filesystem::path path = reference.starts_with("/")
                                           ? std::filesystem::path(reference.substr(1))
                                           : std::filesystem::path(inFile).parent_path() / reference;
    return path.lexically_normal().generic_string();
}

/// The same HTML, with files named by content. Relative all the same: the page may lie beneath a proxy's folder.
std::string byContent(const File& html, const std::vector<File>& files, const std::string& hash) {
    std::string up;
    for (const char c : html.path)
        if (c == '/') up += "../";
    std::string result;
    std::size_t done = 0;
    for (std::size_t at = 0; (at = html.bytes.find("=\"", at)) != std::string::npos;) {
        const std::string_view before(html.bytes.data(), at);
        const std::size_t begin = at + 2, end = html.bytes.find('"', begin);
        at = begin;
        if (end == std::string::npos) break;
        if (!before.ends_with(" href") && !before.ends_with(" src")) continue;
        const std::string target = named(html.bytes.substr(begin, end - begin), html.path);
        for (const File& file : files) {
            if (file.path != target || file.isHtml()) continue;
            result += html.bytes.substr(done, begin - done) + up + "assets/" + hash + "/" + target;
            done = end;
        }
    }
    return result + html.bytes.substr(done);
}

void writeArray(std::ostream& out, const std::string& name, std::string_view bytes) {
    static constexpr char digits[] = "0123456789abcdef";
    out << "const unsigned char " << name << "[] = {";
    std::string text;
    for (const char c : bytes) {
        const auto byte = static_cast<unsigned char>(c);
        text += {'0', 'x', digits[byte >> 4], digits[byte & 15], ','};
    }
    out << text << "0};\n";
}

void write(std::ostream& out, const std::string& function, const std::string& hash,
           const std::vector<File>& files) {
    out << "// Generated by server/net/page/pack_files.cpp.\n#include \"server/net/page/page.hpp\"\n\n"
           "namespace scancast {\nnamespace {\n";
    std::string table;
    for (std::size_t i = 0; i < files.size(); ++i) {
        table += "    {\"/" + files[i].path + '"';
        for (const auto& [kind, bytes] : {std::pair<std::string, const std::string&>{"plain", files[i].bytes},
                                          {"gzip", files[i].gzip},
                                          {"brotli", files[i].brotli}}) {
            const std::string name = kind + std::to_string(i);
            writeArray(out, name, bytes);
            table += ", {reinterpret_cast<const char*>(" + name + "), " + std::to_string(bytes.size()) + "}";
        }
        table += "},\n";
    }
    out << "const Asset table[] = {\n"
        << table << "};\n}  // namespace\n\nPackedFiles " << function << "() { return {\"" << hash
        << "\", table}; }\n\n}  // namespace scancast\n";
}

int pack(const std::vector<std::string>& arguments) {
    const std::string &output = arguments[0], &function = arguments[1];
    std::vector<File> files;
    for (std::size_t i = 3; i < arguments.size(); ++i)
        files.push_back(
            {arguments[i], contentOf(std::filesystem::path(arguments[2]) / arguments[i]), {}, {}});
    const std::string hash = hashOf(files);
    for (File& file : files)
        if (file.isHtml()) file.bytes = byContent(file, files, hash);
    for (File& file : files) {
        file.gzip = gzip(file.bytes);
        file.brotli = brotli(file.bytes);
        // What does not become smaller - a picture - is served as it is.
        if (file.gzip.size() >= file.bytes.size()) file.gzip.clear();
        if (file.brotli.size() >= file.bytes.size()) file.brotli.clear();
    }
    std::ofstream out(output, std::ios::binary | std::ios::trunc);
    write(out, function, hash, files);
    if (!out.flush()) throw std::runtime_error("cannot write " + output);
    return 0;
}

}  // namespace

int main(int argc, char** argv) try {
    if (argc < 5) throw std::runtime_error("OUTPUT FUNCTION ROOT FILE...");
    return pack({argv + 1, argv + argc});
} catch (const std::exception& error) {
    std::fprintf(stderr, "scancast-pack-files: %s\n", error.what());
    return 1;
}
