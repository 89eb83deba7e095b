// Every variant of every shader compiles as OpenGL 4.5, by a compiler that is none of the drivers': also
// those that need 64-bit atomics, which software drivers lack. What a driver accepts beyond the language
// would fail on another one.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>

#include "renderer/device/gl/programs/arithmetic.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/gl/every_splat_variant.hpp"

namespace scancast::gl {
namespace {

namespace fs = std::filesystem;

constexpr const char* compiler = "glslangValidator";

/// Those of splats, and of the shaders that have few.
std::vector<ShaderVariant> allVariants() {
    std::vector<ShaderVariant> all = everySplatVariant();
    std::set<std::string_view> known;
    for (const ShaderVariant& variant : all) known.insert(variant.shader);
    for (const EmbeddedShader& shader : std::span(embeddedShaders, embeddedShaderCount)) {
        if (!shader.name.ends_with(".comp") || known.contains(shader.name)) continue;
        if (shader.name == "glass.comp") {
            for (const int through : {0, 1}) all.push_back({shader.name, {{"THROUGH", through}}});
        } else {
            all.push_back({shader.name, {}});
        }
    }
    return all;
}

/// The lines of a log that tell what is wrong.
std::string errorsIn(const std::string& log) {
    std::istringstream lines(log);
    std::string errors, file;
    for (std::string line; std::getline(lines, line) && errors.size() < 4000;) {
        if (line.ends_with(".comp")) file = line;
        if (line.starts_with("ERROR")) errors += file + ": " + line + "\n";
    }
    return errors;
}

class Shaders : public testing::Test {
  protected:
    void SetUp() override {
        if (std::system((std::string(compiler) + " --version > /dev/null 2>&1").c_str()) != 0)
            GTEST_SKIP() << "MISSING: " << compiler << " (Debian's glslang-tools)";
    }

    const test::TemporaryFolder folder_;
};

TEST_F(Shaders, CompileInEveryVariantAsOpenGl45) {
    std::set<std::string> sources;
    std::ofstream list(folder_ / "list");
    bool atomics64 = false;
    for (const ShaderVariant& variant : allVariants()) {
        // Corrected by fma(): what a graphics card will most likely compile.
        std::vector<Define> defines = variant.defines;
        std::ranges::copy(definesOf({.rounding = Rounding::ByFma}), std::back_inserter(defines));
        const auto source = assembleShader(variant.shader, defines);
        ASSERT_TRUE(source) << source.error().message;
        if (!sources.insert(*source).second) continue;
        const std::string stem(variant.shader.substr(0, variant.shader.find('.')));
        const std::string name = stem + "_" + std::to_string(sources.size()) + ".comp";
        std::ofstream(folder_ / name) << *source;
        list << name << "\n";
        atomics64 |= source->find("#define KEYS64 1") != std::string::npos;
    }
    list.close();
    EXPECT_TRUE(atomics64);
    std::printf("    %zu variants\n", sources.size());
    const std::string command =
        "cd '" + folder_.path().string() + "' && xargs -n 200 -P 2 " + compiler + " < list > log 2>&1";
    const int status = std::system(command.c_str());
    EXPECT_EQ(status, 0) << errorsIn(test::contentOf(folder_ / "log"));
}

}  // namespace
}  // namespace scancast::gl
