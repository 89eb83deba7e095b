#include "renderer/cloud/import/text/obj_source.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "renderer/cloud/import/printable_text.hpp"
#include "renderer/cloud/import/text/text_fields.hpp"
#include "renderer/cloud/import/text/text_head.hpp"

namespace scancast {

namespace {

/// First words of lines, by the format's specification (Wavefront, Advanced Visualizer, appendix B1).
constexpr std::array<std::string_view, 36> objWords{
    "v",    "vt",    "vn",   "vp",       "f",        "fo",     "l",      "p",          "o",
    "g",    "s",     "mg",   "usemtl",   "mtllib",   "cstype", "deg",    "bmat",       "step",
    "curv", "curv2", "surf", "parm",     "trim",     "hole",   "scrv",   "sp",         "end",
    "con",  "bevel", "lod",  "d_interp", "c_interp", "usemap", "maplib", "shadow_obj", "trace_obj"};

/// x y z, a weight, a colour.
constexpr std::size_t mostNumbers = 7;

/// Takes the first word off, with the blanks around it.
std::string_view takeWord(std::string_view& line) {
    const auto begin = line.find_first_not_of(" \t");
    if (begin == line.npos) {
        line = {};
        return {};
    }
    line.remove_prefix(begin);
    const auto word = line.substr(0, line.find_first_of(" \t"));
    line.remove_prefix(word.size());
    return word;
}

/// A comment is not: it may end with the path of a folder.
bool isContinued(std::string_view line) {
    return line.ends_with('\\') && !isComment(line);
}

struct VertexNumbers {
    std::array<double, mostNumbers> value{};
    std::size_t count = 0;

    bool hasColor() const { return count >= 6; }
    /// Some programs write "nan" where they know none.
    bool isColorNumber() const {
        const auto c = color();
        return !std::isnan(c[0]) && !std::isnan(c[1]) && !std::isnan(c[2]);
    }
    std::span<const double> color() const { return std::span(value).subspan(count - 3, 3); }
};

/// nullptr, or why they are none: the end of a sentence.
const char* readVertex(std::string_view text, VertexNumbers& vertex) {
    const char* const end = text.data() + text.size();
    const char* at = skipBlanks(text.data(), end);
    vertex.count = 0;
    while (at != end && *at != '#') {  // many a program comments on a line
        if (vertex.count == mostNumbers) return "a vertex has more than 7 numbers";
        if (!readNumber(at, end, vertex.value[vertex.count])) return "a vertex has a value that is no number";
        ++vertex.count;
        const char* const behind = at;
        at = skipBlanks(at, end);
        if (at == behind && at != end) return "a vertex has a value that is no number";
    }
    if (vertex.count < 3) return "a vertex has less than 3 numbers";
    return vertex.count == 5 ? "a vertex has 5 numbers: neither x y z, nor with a weight, nor with a colour"
                             : nullptr;
}

}  // namespace

bool looksLikeObj(std::string_view start, bool named) {
    const char lineEnd = start.find('\n') == start.npos ? '\r' : '\n';
    bool vertex = false, continued = false;
    std::size_t lines = 0;
    while (!start.empty()) {
        const bool whole = start.find(lineEnd) != start.npos || lines == 0;
        auto line = takeLine(start, lineEnd);
        if (!whole) break;
        ++lines;
        const bool joins = std::exchange(continued, isContinued(line));
        if (joins || isComment(line)) continue;
        const auto word = takeWord(line);
        if (std::find(objWords.begin(), objWords.end(), word) == objWords.end()) return false;
        VertexNumbers numbers;
        vertex = vertex || (word == "v" && (continued || readVertex(line, numbers) == nullptr));
    }
    return vertex || named;
}

Expected<std::unique_ptr<ObjSource>> ObjSource::create(std::unique_ptr<ByteSource> bytes, std::string name) {
    TextLines lines(std::move(bytes), name);
    if (auto ok = lines.open(); !ok) return passOn(ok);
    std::unique_ptr<ObjSource> source(new ObjSource(std::move(lines), std::move(name)));
    if (auto ok = source->findColors(); !ok) return passOn(ok);
    source->scan_.format = source->scan_.attributes.color ? "OBJ, vertices with colours" : "OBJ, vertices";
    return source;
}

/// Whether vertices have colours, and of which range, is told by those at the beginning and at places all over the file.
Expected<void> ObjSource::findColors() {
    std::vector<std::string_view> looked;
    auto start = lines_.start();
    for (std::size_t passed = 0;
         !start.empty() && looked.size() < lookedAtLines && passed < 16 * lookedAtLines; ++passed)
        looked.push_back(takeLine(start, lines_.lineEnd()));
    const auto elsewhere = lines_.samples(lookedAtPlaces, lookedAtBytes);
    if (!elsewhere) return passOn(elsewhere);
    looked.insert(looked.end(), elsewhere->begin(), elsewhere->end());
    SeenValues seen;
    for (auto line : looked) {
        VertexNumbers vertex;
        // What is wrong with a line is said when it is its turn.
        if (takeWord(line) != "v" || readVertex(line, vertex) != nullptr || !vertex.hasColor() ||
            !vertex.isColorNumber())
            continue;
        for (const double value : vertex.color()) seen.see(value, value != std::floor(value));
        scan_.attributes.color = true;
    }
    if (!scan_.attributes.color) return {};
    // As good as all programs write 0 to 1, also where all of them are 0 or 1.
    const auto scale = seen.within(0, 1) ? ColorScale::Unit : colorScale(seen);
    if (!scale)
        return fail(
            ErrorCode::Malformed,
            fmt::format(
                "{}: the colours of its vertices go from {:f} to {:f}; colours are 0 to 1, 0 to 255 or "
                "0 to 65535",
                name_, seen.least, seen.most));
    colorScale_ = *scale;
    return {};
}

/// With what is joined to it.
Expected<bool> ObjSource::nextLine(std::string_view& line) {
    const auto more = lines_.next(line);
    if (!more || !*more || !isContinued(line)) return more;
    joined_.clear();
    for (;;) {
        const bool continued = line.ends_with('\\');
        joined_ += line.substr(0, line.size() - (continued ? 1 : 0));
        if (joined_.size() > TextLines::longestLine)
            return fail(ErrorCode::Malformed,
                        lines_.place() + "the line with those that are joined to it is longer than " +
                            grouped(TextLines::longestLine) + " bytes");
        if (!continued) break;
        joined_ += ' ';
        const auto next = lines_.next(line);
        if (!next) return next;
        if (!*next) break;
    }
    line = joined_;
    return true;
}

Expected<bool> ObjSource::read(PointBatch& batch) {
    batch.clear();
    std::string_view line;
    while (batch.size() < batchPoints) {
        const auto more = nextLine(line);
        if (!more) return passOn(more);
        if (!*more) {
            if (auto ok = endOfFile(); !ok) return passOn(ok);
            return batch.size() > 0;
        }
        if (line.starts_with("v ")) {  // almost all of them
            if (auto ok = addVertex(line.substr(2), batch); !ok) return passOn(ok);
            continue;
        }
        if (isComment(line)) continue;
        const auto word = takeWord(line);
        if (word == "v") {
            if (auto ok = addVertex(line, batch); !ok) return passOn(ok);
        } else {
            ++(word == "f" || word == "fo" ? faces_
               : word == "vn"              ? normals_
               : word == "vt"              ? textures_
                                           : others_);
        }
    }
    return true;
}

Expected<void> ObjSource::addVertex(std::string_view numbers, PointBatch& batch) {
    VertexNumbers vertex;
    if (const char* why = readVertex(numbers, vertex); why != nullptr)
        return fail(ErrorCode::Malformed, lines_.place() + why);
    ++vertices_;
    const glm::dvec3 position(vertex.value[0], vertex.value[1], vertex.value[2]);
    if (!std::isfinite(position.x) || !std::isfinite(position.y) || !std::isfinite(position.z)) {
        ++dropped_;
        return {};
    }
    batch.position.push_back(position);
    if (!scan_.attributes.color) {
        colorsLeftOut_ += vertex.hasColor();
        return {};
    }
    std::array<std::uint8_t, 3> color{255, 255, 255};
    withoutColor_ += !vertex.hasColor();
    if (vertex.hasColor() && !vertex.isColorNumber()) {
        ++badColors_;
        batch.color.push_back({});
        return {};
    }
    for (std::size_t i = 0; vertex.hasColor() && i < 3; ++i)
        if (!toColor(vertex.color()[i], colorScale_, color[i]))
            return fail(
                ErrorCode::Malformed,
                fmt::format("{}the colour {:g} is outside of the range that the file's other colours have",
                            lines_.place(), vertex.color()[i]));
    batch.color.push_back(color);
    return {};
}

Expected<void> ObjSource::endOfFile() const {
    if (vertices_ == 0)
        return fail(ErrorCode::Empty,
                    name_ + (faces_ > 0 ? ": there are " + grouped(faces_) + " faces, but no vertex"
                                        : ": there is no vertex"));
    if (vertices_ == dropped_)
        return fail(ErrorCode::Empty,
                    name_ + ": none of its " + grouped(vertices_) + " vertices has finite coordinates");
    return {};
}

std::vector<std::string> ObjSource::notes() const {
    std::vector<std::string> notes;
    std::string left;
    const auto count = [&](std::uint64_t number, const char* one, const char* many) {
        if (number > 0)
            left += (left.empty() ? "" : ", ") + grouped(number) + " " + (number == 1 ? one : many);
    };
    count(faces_, "face", "faces");
    count(normals_, "normal of corners", "normals of corners");
    count(textures_, "texture coordinate", "texture coordinates");
    count(others_, "other line", "other lines");
    if (!left.empty()) notes.push_back(name_ + ": vertices are read as points; left out are " + left);
    if (withoutColor_ > 0)
        notes.push_back(name_ + ": " + grouped(withoutColor_) + " vertices have no colour; they are white");
    if (badColors_ > 0)
        notes.push_back(name_ + ": " + grouped(badColors_) + (badColors_ == 1 ? " point" : " points") +
                        " with a colour that is no number, black here");
    if (colorsLeftOut_ > 0)
        notes.push_back(name_ + ": the colours of " + grouped(colorsLeftOut_) +
                        " vertices are left out, for those that were looked at first have none");
    return notes;
}

}  // namespace scancast
