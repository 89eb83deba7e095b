// PROTOCOL.md is what users read; these tests fail when it and the code part ways.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <sstream>

#include "protocol/frame_header.hpp"
#include "protocol/json_text.hpp"
#include "protocol/messages.hpp"
#include "protocol/problem.hpp"
#include "protocol/view/view_json.hpp"
#include "protocol/view/view_words.hpp"
#include "word_text.hpp"

namespace scancast {
namespace {

std::string protocolPage() {
    std::ifstream file(SCANCAST_SOURCE_DIR "/protocol/PROTOCOL.md");
    EXPECT_TRUE(file) << "protocol/PROTOCOL.md is not there";
    return {std::istreambuf_iterator<char>(file), {}};
}

std::string joined(std::initializer_list<std::string_view> pieces) {
    std::string text;
    for (const auto piece : pieces) text += piece;
    return text;
}

/// The fenced blocks of one language.
std::vector<std::string> blocks(const std::string& page, const std::string& language) {
    std::vector<std::string> found;
    const auto fence = joined({"```", language, "\n"});
    for (auto at = page.find(fence); at != std::string::npos; at = page.find(fence, at + 1)) {
        const auto start = at + fence.size();
        found.push_back(page.substr(start, page.find("```", start) - start));
    }
    return found;
}

std::string code(std::string text) {
    for (auto at = text.find('|'); at != std::string::npos; at = text.find('|', at + 2))
        text.insert(at, "\\");
    return "`" + text + "`";
}

TEST(ProtocolPage, HasARowForEveryWord) {
    std::string table = "| word | flag | value | default | meaning | example |\n|---|---|---|---|---|---|\n";
    for (const auto& word : viewWords()) {
        auto standard = code(test::textOf(word.value.print(View{})));
        if (word.path.starts_with("camera.")) standard = "the cloud's";
        if (word.path == "param") standard = "the method's";
        const auto example = word.path == "param" ? "param." + std::string(word.example)
                                                  : joined({word.word, "=", word.example});
        table += "| " + code(std::string(word.word)) + " | " + code(word.flag()) + " | " +
                 code(std::string(word.shape)) + " | " + standard + " | " + word.description() + " | " +
                 code(example) + " |\n";
    }
    EXPECT_NE(protocolPage().find("\n" + table + "\n"), std::string::npos)
        << "the page's table of words must be\n"
        << table;
}

TEST(ProtocolPage, HasEveryFieldOfTheFrameHeaderWithItsOffset) {
    const auto page = protocolPage();
    for (const auto& field : frameHeaderFields) {
        const auto row = joined({"| ", std::to_string(field.offset), " | ", std::to_string(field.size),
                                 " | `", field.name, "` | "});
        EXPECT_NE(page.find(row), std::string::npos) << row;
    }
    for (const auto& field : frameDepthFields) {
        const auto row = joined({"| ", std::to_string(field.offset), " | ", std::to_string(field.size),
                                 " | `", field.name, "` | "});
        EXPECT_NE(page.find(row), std::string::npos) << row;
    }
}

TEST(ProtocolPage, ItsCanonicalViewIsTheDefault) {
    bool found = false;
    for (const auto& block : blocks(protocolPage(), "json")) {
        const auto value = parseJson(block);
        ASSERT_TRUE(value) << value.error().message << "\n" << block;
        if (value->contains("camera")) {
            EXPECT_EQ(printJson(*value), printJson(toJson(View{})))
                << "PROTOCOL.md's canonical view must be the second of the two.";
            found = true;
        }
    }
    EXPECT_TRUE(found);
}

TEST(ProtocolPage, ItsClientMessagesAreLegal) {
    int legal = 0;
    for (const auto& block : blocks(protocolPage(), "text")) {
        std::istringstream lines(block);
        for (std::string line; std::getline(lines, line);) {
            if (!line.starts_with("client  ")) continue;
            const auto message = parseClientMessage(line.substr(8));
            ASSERT_TRUE(message) << message.error().message;
            if (const auto* view = std::get_if<messages::ViewChange>(&*message)) {
                EXPECT_TRUE(applyJson(View{}, view->changes)) << line;
            }
            ++legal;
        }
    }
    EXPECT_GE(legal, 3);
}

TEST(ProtocolPage, ItsQueriesAreLegal) {
    const auto page = protocolPage();
    int queries = 0;
    for (auto at = page.find("snapshot.jpg?"); at != std::string::npos;
         at = page.find("snapshot.jpg?", at + 1)) {
        const auto start = at + std::string("snapshot.jpg?").size();
        const auto words = parseQuery(page.substr(start, page.find('\'', start) - start));
        ASSERT_TRUE(words) << words.error().message;
        const auto view = applyWords(View{}, *words);
        EXPECT_TRUE(view) << view.error().message;
        ++queries;
    }
    EXPECT_GE(queries, 2);
}

TEST(ProtocolPage, NamesEveryMessageProblemAndCloseCode) {
    const auto page = protocolPage();
    for (const auto* type : {"hello", "view", "quality", "ack", "ping", "pick", "welcome", "stats", "picked",
                             "problem", "bye", "pong"})
        EXPECT_NE(page.find(joined({"| `", type, "` | "})), std::string::npos) << type;
    for (const int code : {1000, 1001, 1002, 1003, 1007, 1008, 1009, 1013})
        EXPECT_NE(page.find(joined({"| ", std::to_string(code), " | "})), std::string::npos) << code;
    for (int code = 0; code <= static_cast<int>(ErrorCode::Internal); ++code) {
        const auto problem = problemOf(Error{static_cast<ErrorCode>(code), "", ""});
        const auto row = page.find(joined({"| ", std::to_string(problem.status), " | "}));
        ASSERT_NE(row, std::string::npos) << problem.status;
        const auto line = page.substr(row, page.find('\n', row) - row);
        EXPECT_NE(line.find(joined({"`", name(static_cast<ErrorCode>(code)), "`"})), std::string::npos)
            << line;
    }
}

}  // namespace
}  // namespace scancast
