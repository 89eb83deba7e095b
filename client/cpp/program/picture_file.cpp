#include "client/cpp/program/picture_file.hpp"

namespace scancast::client {

Expected<PictureFormat> pictureFormatOf(const std::string& name) {
    std::string small = name;
    for (char& c : small)
        if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
    if (small.ends_with(".jpg") || small.ends_with(".jpeg")) return PictureFormat::Jpeg;
    if (small.ends_with(".png")) return PictureFormat::Png;
    return fail(ErrorCode::InvalidArgument,
                "the name " + name + " does not end in .jpg or .png, so its format is not known");
}

CLI::Option* addPictureFile(CLI::App& command, const std::string& flag, std::string& output,
                            const std::string& what) {
    return command.add_option(flag, output, what)
        ->type_name("FILE.jpg|FILE.png")
        ->check([](const std::string& name) {
            const auto format = pictureFormatOf(name);
            return format ? std::string() : format.error().message;
        });
}

}  // namespace scancast::client
