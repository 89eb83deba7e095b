#include "client/cpp/program/points/points_flags.hpp"

#include <cstdio>

#include "client/cpp/program/say.hpp"

namespace scancast::client {

Expected<std::optional<PointsFormat>> formatOfPoints(const std::string& given, const std::string& output) {
    std::string word = given;
    if (word.empty()) {
        const auto dot = output.rfind('.');
        if (dot != std::string::npos) word = output.substr(dot + 1);
        for (char& c : word)
            if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
        if (word == "xyz") word = "txt";
    }
    if (word == "png") return std::optional<PointsFormat>();
    if (const auto format = pointsFormatOf(word)) return std::optional(*format);
    if (word == "laz")
        return fail(
            ErrorCode::Unsupported,
            output +
                ": servers do not write LAZ. Ask for LAS, and compress it: pdal translate out.las out.laz");
    return fail(ErrorCode::InvalidArgument,
                "the name " + output +
                    " does not tell the format; end it in .las, .ply, .csv, .txt or .xyz, or give "
                    "--format");
}

TakeBytes into(OutputFile& file) {
    return [&file](std::span<const std::byte> bytes) { return file.write(bytes); };
}

void tellOfPoints(const std::string& output, const PointsAnswer& answer) {
    const std::string points = answer.points ? std::to_string(*answer.points) + " points, " : "";
    sayOn(stderr, "%s: %s%llu bytes\n", output == "-" ? "standard output" : output.c_str(), points.c_str(),
          static_cast<unsigned long long>(answer.bytes));
    for (const std::string& loss : answer.losses) sayOn(stderr, "Not as the scan was: %s.\n", loss.c_str());
}

}  // namespace scancast::client
