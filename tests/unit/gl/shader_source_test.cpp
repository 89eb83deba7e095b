#include "renderer/device/gl/programs/shader_source.hpp"

#include <gmock/gmock.h>

#include <regex>
#include <set>
#include <sstream>

namespace scancast::gl {
namespace {

using testing::HasSubstr;

const EmbeddedShader library[] = {
    {"main.comp", "// why\n#version 450 core\n#include \"parts.glsl\"\nvoid main() {}\n"},
    {"parts.glsl", "float half_(float x) { return x * HALF; }"},
    {"loop.comp", "#version 450 core\n#include \"loop.comp\"\n"},
    {"lost.comp", "#version 450 core\n#include \"nowhere.glsl\"\n"},
    {"bare.comp", "void main() {}\n"},
};

TEST(ShaderSource, VersionComesFirstThenDefinesThenTheText) {
    const Define defines[] = {{"HALF", 2}, {"STAGE", -1}};
    const auto text = assembleShader("main.comp", defines, library);
    ASSERT_TRUE(text) << text.error().message;
    EXPECT_EQ(*text,
              "#version 450 core\n#define HALF 2\n#define STAGE -1\n// why\n"
              "float half_(float x) { return x * HALF; }\nvoid main() {}\n");
}

TEST(ShaderSource, WhatIsMissingIsNamed) {
    EXPECT_THAT(assembleShader("none.comp", {}, library).error().message, HasSubstr("none.comp"));
    EXPECT_THAT(assembleShader("lost.comp", {}, library).error().message, HasSubstr("nowhere.glsl"));
    EXPECT_THAT(assembleShader("bare.comp", {}, library).error().message, HasSubstr("#version"));
    EXPECT_THAT(assembleShader("loop.comp", {}, library).error().message, HasSubstr("nested"));
}

TEST(ShaderSource, LinesAreNumberedFromOne) {
    EXPECT_EQ(withLineNumbers("a\n\nb"), "   1: a\n   2: \n   3: b\n");
    EXPECT_EQ(withLineNumbers(""), "");
}

TEST(ShaderSource, EveryEmbeddedShaderAssembles) {
    ASSERT_GT(embeddedShaderCount, 0u);
    for (std::size_t i = 0; i < embeddedShaderCount; ++i) {
        const std::string_view name = embeddedShaders[i].name;
        if (!name.ends_with(".comp")) continue;
        const auto text = assembleShader(name, {});
        ASSERT_TRUE(text) << text.error().message;
        EXPECT_TRUE(text->starts_with("#version 450 core\n")) << name;
        EXPECT_THAT(*text, testing::Not(HasSubstr("#include"))) << name;
    }
}

/// A shader without its comments and preprocessor lines.
std::string codeOf(std::string_view text) {
    std::string code;
    std::istringstream lines{std::string(text)};
    for (std::string line; std::getline(lines, line);) {
        if (!line.starts_with('#')) code += line.substr(0, line.find("//")) + "\n";
    }
    return code;
}

/// Drivers round quotients, roots and powers as they like; shaders leave them to exact.glsl and formulas/powers.inl,
/// or pictures are no longer the cpu device's. What divides integers is named here.
TEST(ShaderSource, QuotientsAndRootsAreLeftToWhatRoundsThem) {
    const std::set<std::string> integers{"2u",        "3",       "5",       "18",
                                         "255u",      "divisor", "height",  "part.frames.x",
                                         "part.side", "side",    "visible", "width"};
    const std::regex division(R"(/\s*([\w.]+))"),
        inexact(
            R"([^.\w](sqrt|inversesqrt|normalize|length|distance|pow|exp2?|log2?|sin|cos|mix|smoothstep|reflect)\()");
    for (const EmbeddedShader& shader : std::span(embeddedShaders, embeddedShaderCount)) {
        if (shader.name == "exact.glsl") continue;
        const std::string code = codeOf(shader.text);
        for (std::sregex_iterator at(code.begin(), code.end(), division), end; at != end; ++at)
            EXPECT_TRUE(integers.contains((*at)[1])) << shader.name << ": " << at->str();
        for (std::sregex_iterator at(code.begin(), code.end(), inexact), end; at != end; ++at)
            ADD_FAILURE() << shader.name << ": " << at->str();
    }
}

}  // namespace
}  // namespace scancast::gl
