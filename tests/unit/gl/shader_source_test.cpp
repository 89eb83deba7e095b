#include "renderer/device/gl/shader_source.hpp"

#include <gmock/gmock.h>

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

}  // namespace
}  // namespace scancast::gl
