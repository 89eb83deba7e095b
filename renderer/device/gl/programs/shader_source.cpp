#include "renderer/device/gl/programs/shader_source.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

namespace scancast::gl {
namespace {

constexpr int deepestInclude = 8;

/// Takes the first line off `rest`, without its end.
std::string_view takeLine(std::string_view& rest) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    const std::string_view line = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    return line;
}

/// NAME of a line `#include "NAME"`, else empty.
std::string_view includedName(std::string_view line) {
    constexpr std::string_view start = "#include \"";
    if (!line.starts_with(start)) return {};
    line.remove_prefix(start.size());
    return line.substr(0, std::min(line.find('"'), line.size()));
}

struct Assembly {
    std::span<const EmbeddedShader> library;
    std::string version, body;

    Expected<void> add(std::string_view name, int depth) {
        const auto found = std::ranges::find(library, name, &EmbeddedShader::name);
        if (found == library.end())
            return fail(ErrorCode::Internal, fmt::format("There is no shader text named {}.", name));
        if (depth > deepestInclude)
            return fail(ErrorCode::Internal,
                        fmt::format("Shader includes are nested too deeply at {}.", name));
        for (std::string_view rest = found->text; !rest.empty();) {
            const std::string_view line = takeLine(rest);
            if (const std::string_view included = includedName(line); !included.empty()) {
                if (auto ok = add(included, depth + 1); !ok) return ok;
            } else if (line.starts_with("#version")) {
                version.append(line).append("\n");
            } else {
                body.append(line).append("\n");
            }
        }
        return {};
    }
};

}  // namespace

Expected<std::string> assembleShader(std::string_view name, std::span<const Define> defines,
                                     std::span<const EmbeddedShader> library) {
    Assembly assembly{library, {}, {}};
    if (auto ok = assembly.add(name, 0); !ok) return passOn(ok);
    if (assembly.version.empty())
        return fail(ErrorCode::Internal, fmt::format("The shader {} has no #version line.", name));
    std::string text = std::move(assembly.version);
    for (const Define& define : defines) text += fmt::format("#define {} {}\n", define.name, define.value);
    return text + assembly.body;
}

Expected<std::string> assembleShader(std::string_view name, std::span<const Define> defines) {
    return assembleShader(name, defines, std::span(embeddedShaders, embeddedShaderCount));
}

std::string withLineNumbers(std::string_view text) {
    std::string out;
    for (int number = 1; !text.empty(); ++number) {
        char prefix[16];
        std::snprintf(prefix, sizeof prefix, "%4d: ", number);
        out.append(prefix).append(takeLine(text)).append("\n");
    }
    return out;
}

}  // namespace scancast::gl
