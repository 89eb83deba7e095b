#include "importers/sandbox/allowed_files.hpp"

#include <elf.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace scancast::sandbox {
namespace {

namespace fs = std::filesystem;

constexpr int longestChain = 4;  // a script's interpreter may be a script, as the kernel has it

std::vector<std::string> splitAt(const char* text, char separator) {
    std::vector<std::string> parts;
    std::istringstream words(text ? text : "");
    for (std::string part; std::getline(words, part, separator);)
        if (part.starts_with('/')) parts.push_back(part);
    return parts;
}

std::string onPath(const std::string& program) {
    if (program.find('/') != std::string::npos) return program;
    for (const std::string& folder : splitAt(std::getenv("PATH"), ':'))
        if (const std::string file = folder + "/" + program; ::access(file.c_str(), X_OK) == 0) return file;
    return {};
}

/// Of a script's first line: the interpreter, and for env what it looks for.
std::vector<std::string> startedBy(const std::string& line) {
    std::istringstream words(line.substr(2));
    std::string interpreter;
    words >> interpreter;
    std::vector<std::string> result{interpreter};
    if (fs::path(interpreter).filename() != "env") return result;
    for (std::string word; words >> word;) {
        if (word.starts_with('-') || word.find('=') != std::string::npos) continue;
        result.push_back(onPath(word));
        break;
    }
    return result;
}

/// The loader of shared libraries that an ELF file of this machine names; empty without one.
std::string loaderOf(std::ifstream& file) {
    Elf64_Ehdr header{};
    file.clear();
    file.seekg(0);
    if (!file.read(reinterpret_cast<char*>(&header), sizeof header)) return {};
    if (std::string_view(reinterpret_cast<const char*>(header.e_ident), SELFMAG) != ELFMAG) return {};
    for (int i = 0; i < header.e_phnum; ++i) {
        Elf64_Phdr part{};
        file.seekg(std::streamoff(header.e_phoff) + i * std::streamoff(sizeof part));
        if (!file.read(reinterpret_cast<char*>(&part), sizeof part)) return {};
        if (part.p_type != PT_INTERP || part.p_filesz > 4096) continue;
        std::string loader(part.p_filesz, '\0');
        file.seekg(std::streamoff(part.p_offset));
        if (!file.read(loader.data(), std::streamsize(loader.size()))) return {};
        return loader.c_str();  // it ends with a zero byte
    }
    return {};
}

void addExecutable(AllowedFiles& files, const std::string& name, int depth) {
    std::error_code error;
    if (name.empty() || depth == longestChain) return;
    files.executable.push_back(name);
    const fs::path real = fs::canonical(name, error);
    if (!error && real != name) files.executable.push_back(real.string());
    std::ifstream file(name, std::ios::binary);
    std::string line(256, '\0');
    file.read(line.data(), std::streamsize(line.size()));
    line.resize(std::size_t(file.gcount()));
    if (line.starts_with("#!")) {
        for (const std::string& next : startedBy(line.substr(0, line.find('\n'))))
            addExecutable(files, next, depth + 1);
        if (depth > 0 || real.empty()) return;
        files.readable.push_back(real.parent_path().string());
    } else if (const std::string loader = loaderOf(file); !loader.empty()) {
        files.executable.push_back(loader);
    }
}

}  // namespace

AllowedFiles allowedFor(const std::string& program) {
    AllowedFiles files;
    files.readable = {"/lib", "/lib32", "/lib64", "/libx32", "/usr/lib", "/usr/lib32", "/usr/lib64",
                      "/usr/libx32", "/usr/local/lib", "/usr/share", "/etc/ld.so.cache", "/etc/localtime",
                      "/etc/ssl/openssl.cnf",
                      // How much there is of this machine; Node.js and allocators ask.
                      "/proc/cpuinfo", "/proc/meminfo", "/proc/stat", "/proc/sys/vm/overcommit_memory",
                      "/sys/devices/system/cpu", "/sys/fs/cgroup", "/sys/kernel/mm/transparent_hugepage",
                      "/dev/null", "/dev/random", "/dev/urandom", "/dev/zero",
                      // Of itself: it becomes the program under the same number.
                      "/proc/self"};
    for (std::string& folder : splitAt(std::getenv("LD_LIBRARY_PATH"), ':'))
        files.readable.push_back(std::move(folder));
    addExecutable(files, program, 0);
    return files;
}

}  // namespace scancast::sandbox
