// What people read when a GPU, a driver or a library is missing: which call failed, how, and the way out.
// Each case in a process of its own, with a libEGL that fails where it is told to, or without its parts.
#include <gmock/gmock.h>
#include <stdio.h>

#include <array>
#include <memory>

#include "tests/support/temporary_folder.hpp"

namespace scancast {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// What `open_backend WORDS` prints in this environment ("NAME=value NAME=value").
std::string opened(const std::string& environment, const std::string& words) {
    const std::string command = "env " + environment + " " SCANCAST_OPEN_BACKEND " " + words + " 2>&1";
    const std::unique_ptr<FILE, int (*)(FILE*)> pipe(::popen(command.c_str(), "r"), &::pclose);
    EXPECT_TRUE(pipe) << command;
    std::string all;
    std::array<char, 4096> part;
    for (std::size_t count; (count = std::fread(part.data(), 1, part.size(), pipe.get())) > 0;)
        all.append(part.data(), count);
    return all;
}

std::string withFake(const std::string& failure) {
    return opened("LD_LIBRARY_PATH=" SCANCAST_FAKE_EGL " FAKE_EGL='" + failure + "'", "egl 0");
}

const auto saysWhatToDo =
    AllOf(HasSubstr("apt install libegl-mesa0 libgl1-mesa-dri"),
          HasSubstr("NVIDIA_DRIVER_CAPABILITIES=graphics,utility"), HasSubstr("/dev/dri"));

struct Failure {
    const char* told;   ///< to the fake
    const char* call;   ///< that the message names
    const char* error;  ///< as EGL calls it
};

class FailingCalls : public testing::TestWithParam<Failure> {};
INSTANTIATE_TEST_SUITE_P(
    Egl, FailingCalls,
    testing::Values(Failure{"eglQueryDevicesEXT 0x3003", "eglQueryDevicesEXT", "EGL_BAD_ALLOC"},
                    Failure{"eglGetPlatformDisplayEXT 0x300C", "eglGetPlatformDisplay", "EGL_BAD_PARAMETER"},
                    Failure{"eglInitialize 0x3001", "eglInitialize", "EGL_NOT_INITIALIZED"},
                    Failure{"eglBindAPI 0x300C", "eglBindAPI(EGL_OPENGL_API)", "EGL_BAD_PARAMETER"},
                    Failure{"eglCreateContext 0x3009", "eglCreateContext(OpenGL 4.5 core)", "EGL_BAD_MATCH"},
                    Failure{"eglMakeCurrent 0x3002", "eglMakeCurrent", "EGL_BAD_ACCESS"},
                    Failure{"eglMakeCurrent 0x300E", "eglMakeCurrent", "EGL_CONTEXT_LOST"}),
    [](const testing::TestParamInfo<Failure>& failure) {
        std::string name(failure.param.told);
        for (char& c : name)
            if (c == ' ') c = '_';
        return name;
    });

TEST_P(FailingCalls, AreNamedWithTheirErrorAndTheWayOut) {
    const std::string message = withFake(GetParam().told);
    EXPECT_THAT(message, HasSubstr(std::string(GetParam().call)));
    EXPECT_THAT(message, HasSubstr(std::string("failed with ") + GetParam().error));
    EXPECT_THAT(message, saysWhatToDo);
}

TEST(MissingBackends, AGpuThatThisProcessCannotOpenIsNamedByItsFile) {
    if (std::filesystem::exists("/dev/dri/renderD128")) GTEST_SKIP() << "this machine has that GPU";
    EXPECT_THAT(withFake("eglInitialize 0x3001"),
                AllOf(HasSubstr("EGL device 0 (/dev/dri/renderD128): "),
                      HasSubstr("There is no /dev/dri/renderD128 here: give the container /dev/dri.")));
}

TEST(MissingBackends, ALibEglWithoutDevicesOrExtensionsOrOpenGlIsTold) {
    EXPECT_THAT(withFake("no-device 0"),
                AllOf(HasSubstr("eglQueryDevicesEXT finds no device"), saysWhatToDo));
    EXPECT_THAT(withFake("no-device-extensions 0"),
                AllOf(HasSubstr("eglQueryDevicesEXT is not offered"), saysWhatToDo));
    EXPECT_THAT(withFake("no-surfaceless 0"), AllOf(HasSubstr("EGL_KHR_surfaceless_context"), saysWhatToDo));
    EXPECT_THAT(withFake("nothing 0"),
                AllOf(HasSubstr("has no function gl"), HasSubstr("apt install libgl1-mesa-dri")));
}

/// A context that tells resets and stays in its buffers is asked for first, and done without where a driver
/// has none: what is missed then is OpenGL, which this library has not.
TEST(MissingBackends, ADriverWithoutRobustnessOpensAllTheSame) {
    for (const char* lacks : {"no-robust-access 0x3004", "no-robustness 0x3004"})
        EXPECT_THAT(withFake(lacks),
                    AllOf(HasSubstr("has no function gl"), Not(HasSubstr("eglCreateContext"))));
}

TEST(MissingBackends, ADeviceBeyondTheListIsAnsweredWithTheList) {
    EXPECT_THAT(
        opened("LD_LIBRARY_PATH=" SCANCAST_FAKE_EGL, "egl 3"),
        AllOf(HasSubstr("There is no EGL device 3; EGL lists 0 to 0 here"), HasSubstr("--list-backends")));
    EXPECT_THAT(opened("", "egl -7"), HasSubstr("--egl-device takes a number from 0"));
}

TEST(MissingBackends, LibrariesThatDoNotOpenAreNamed) {
    const test::TemporaryFolder folder;
    folder.write("libEGL.so.1", "no library");
    folder.write("libOSMesa.so.8", "no library");
    const std::string environment = "LD_LIBRARY_PATH=" + folder.path().string();
    EXPECT_THAT(opened(environment, "egl"),
                AllOf(HasSubstr("dlopen of libEGL.so.1 failed: "),
                      HasSubstr("apt install libegl1 libgl1-mesa-dri"), HasSubstr("--backend=cpu")));
    EXPECT_THAT(opened(environment, "osmesa"),
                AllOf(HasSubstr("dlopen of libOSMesa.so.8 failed: "), HasSubstr("apt install libosmesa6"),
                      HasSubstr("--backend=cpu")));
    EXPECT_EQ(opened(environment, "auto"), "opened cpu\n");
    EXPECT_EQ(opened(environment, "cpu"), "opened cpu\n");
}

/// With the machine's own libEGL, if it has one (glvnd), told of no driver at all.
TEST(MissingBackends, WithoutADriverTheWayToOneIsTold) {
    const std::string without =
        opened("__EGL_VENDOR_LIBRARY_FILENAMES=/nowhere.json LIBGL_DRIVERS_PATH=/nowhere", "egl");
    if (without.find("dlopen of libEGL.so.1") != std::string::npos) GTEST_SKIP() << "MISSING BACKEND egl";
    EXPECT_THAT(without, Not(HasSubstr("opened")));
    EXPECT_THAT(without, saysWhatToDo);
}

}  // namespace
}  // namespace scancast
