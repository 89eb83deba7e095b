#include "renderer/device/gl/programs/programs.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "tests/support/pictures/gl_context_test.hpp"
#include "tests/support/temporary_folder.hpp"

namespace scancast::gl {
namespace {

namespace fs = std::filesystem;
using test::TemporaryFolder;

class ProgramsOnDisk : public WithContext {
  protected:
    void SetUp() override {
        WithContext::SetUp();
        if (!context_) return;
        GLint formats = 0;
        gl().GetIntegerv(GL_NUM_PROGRAM_BINARY_FORMATS, &formats);
        keeps_ = formats > 0;
    }
    std::vector<fs::path> files() const {
        std::vector<fs::path> found;
        for (const auto& entry : fs::directory_iterator(folder_.path())) found.push_back(entry.path());
        return found;
    }
    /// What a first user of the folder leaves there: one program.
    void fillFolder() {
        Programs first(gl(), folder_.path());
        ASSERT_TRUE(first.get("crop.comp", {}));
        ASSERT_EQ(files().size(), keeps_ ? 1u : 0u);
    }

    TemporaryFolder folder_;
    bool keeps_ = false;  ///< the driver gives binaries
};
INSTANTIATE_TEST_SUITE_P(Gl, ProgramsOnDisk, testing::Values("egl", "osmesa"),
                         [](const testing::TestParamInfo<std::string>& c) { return c.param; });

TEST_P(ProgramsOnDisk, AProgramIsCompiledOnce) {
    Programs programs(gl(), {});
    const auto first = programs.get("crop.comp", {});
    ASSERT_TRUE(first) << first.error().message;
    EXPECT_EQ(*programs.get("crop.comp", {}), *first);
    const Define one[] = {{"ANYTHING", 1}}, two[] = {{"ANYTHING", 2}};
    const auto variant = programs.get("crop.comp", one);
    ASSERT_TRUE(variant);
    EXPECT_NE(*variant, *first);
    EXPECT_NE(*programs.get("crop.comp", two), *variant);
    EXPECT_EQ(*programs.get("crop.comp", one), *variant);
    EXPECT_TRUE(checkErrors(gl(), "compiling"));
}

TEST_P(ProgramsOnDisk, AShaderThatIsNoneIsNamed) {
    Programs programs(gl(), {});
    const auto none = programs.get("nothing.comp", {});
    ASSERT_FALSE(none);
    EXPECT_NE(none.error().message.find("nothing.comp"), std::string::npos);
}

TEST_P(ProgramsOnDisk, TheNextRunFindsThem) {
    fillFolder();
    const auto before = files();
    std::vector<fs::file_time_type> written;
    for (const fs::path& file : before) {
        fs::last_write_time(file, fs::file_time_type::clock::now() - std::chrono::hours(1));
        written.push_back(fs::last_write_time(file));
    }
    Programs second(gl(), folder_.path());
    ASSERT_TRUE(second.get("crop.comp", {}));
    EXPECT_EQ(files(), before);
    for (std::size_t i = 0; i < before.size(); ++i)
        EXPECT_EQ(fs::last_write_time(before[i]), written[i]) << "it was read, not compiled and written";
    EXPECT_TRUE(checkErrors(gl(), "loading"));
}

/// A file that passes every check of ours and is no program: the driver must refuse, and we compile.
TEST_P(ProgramsOnDisk, WhatTheDriverRejectsIsCompiledAndWrittenAnew) {
    fillFolder();
    if (!keeps_) GTEST_SKIP() << GetParam() << " gives no program binaries here";
    const fs::path path = files().front();
    const auto whole = fs::file_size(path);
    std::string driver;
    for (const GLenum what : {GL_VENDOR, GL_RENDERER, GL_VERSION, GL_SHADING_LANGUAGE_VERSION})
        driver.append(reinterpret_cast<const char*>(gl().GetString(what))).append("\n");
    const ProgramKey key = ProgramKey::of(*assembleShader("crop.comp", definesOf({})), driver);
    ASSERT_EQ(path.stem(), key.digest);
    for (const std::uint32_t format : {0x1u, 0x875Fu}) {  // unknown; Mesa's
        const ProgramFiles files(folder_.path());
        files.write(key, {format, std::vector<std::byte>(100, std::byte{0x55})});
        Programs programs(gl(), folder_.path());
        ASSERT_TRUE(programs.get("crop.comp", {}));
        EXPECT_EQ(fs::file_size(path), whole);
        EXPECT_TRUE(checkErrors(gl(), "loading"));
    }
}

TEST_P(ProgramsOnDisk, ADamagedFileIsCompiledAndWrittenAnew) {
    fillFolder();
    if (!keeps_) GTEST_SKIP() << GetParam() << " gives no program binaries here";
    const fs::path path = files().front();
    const auto whole = fs::file_size(path);
    fs::resize_file(path, whole / 2);
    Programs programs(gl(), folder_.path());
    ASSERT_TRUE(programs.get("crop.comp", {}));
    EXPECT_EQ(fs::file_size(path), whole);
}

}  // namespace
}  // namespace scancast::gl
