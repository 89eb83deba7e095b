// openapi.json is what programs are written from: it has the words of the table, and nothing else of a view.
// What its examples do is tests/integration/openapi_test.cpp's.
#include <gmock/gmock.h>

#include <fstream>
#include <map>
#include <set>

#include "protocol/json_text.hpp"
#include "protocol/view/view_words.hpp"
#include "tests/support/json_schema.hpp"
#include "word_text.hpp"

namespace scancast {
namespace {

using nlohmann::json;
using Names = std::set<std::string>;

json openApi() {
    std::ifstream file(SCANCAST_SOURCE_DIR "/protocol/openapi.json");
    return parseJson(std::string{std::istreambuf_iterator<char>(file), {}}).value();
}

bool isParameter(const ViewWord& word) {
    return word.path == "param";
}

/// Every method has others; one stands for all.
std::string parameterName(const ViewWord& word) {
    return isParameter(word) ? "param.sizePx" : std::string(word.word);
}

Names keysOf(const json& object) {
    Names keys;
    for (const auto& item : object.items()) keys.insert(item.key());
    return keys;
}

/// Whether the schema lets numbers of the range in, and no others near its ends.
void expectRange(const json& schema, const ViewRange& range) {
    const auto fits = [&](double value) { return test::schemaErrors({}, schema, value).empty(); };
    EXPECT_TRUE(fits(range.least));
    EXPECT_FALSE(fits(range.least - 1));
    if (range.most > 1e11) return;  // as far as numbers go
    EXPECT_TRUE(fits(range.most));
    EXPECT_FALSE(fits(range.most + 1));
}

TEST(OpenApiWords, ParametersAreTheTables) {
    const json document = openApi();
    Names words;
    for (const auto& word : viewWords()) {
        const auto name = parameterName(word);
        SCOPED_TRACE(name);
        words.insert(name);
        const auto description =
            word.description() +
            (isParameter(word) ? " GET /api/v1/methods lists those of every method: param.NAME." : "");
        const json expected{{"name", name}, {"in", "query"}, {"description", description}};
        const json parameter = document["components"]["parameters"].value(name, json());
        if (parameter.is_null()) {
            ADD_FAILURE() << "components.parameters lacks " << expected.dump(2) << " with example and schema";
            continue;
        }
        for (const auto& [key, value] : expected.items()) EXPECT_EQ(parameter.value(key, json()), value);
        const std::string example(isParameter(word) ? word.example.substr(word.example.find('=') + 1)
                                                    : word.example);
        EXPECT_EQ(test::textOf(parameter.value("example", json())), example);
        const json schema = parameter.value("schema", json::object());
        if (word.value.range) expectRange(schema, *word.value.range);
        // The camera is the cloud's to choose; parameters are the method's.
        const bool fixed = !word.path.starts_with("camera.") && !isParameter(word);
        EXPECT_EQ(schema.contains("default"), fixed);
        if (fixed) {
            EXPECT_EQ(test::textOf(schema.value("default", json())), test::textOf(word.value.print(View{})));
        }
    }
    for (const auto& [name, parameter] : document["components"]["parameters"].items())
        if (parameter["in"] == "query") {
            EXPECT_TRUE(words.contains(name)) << name;
        }
}

TEST(OpenApiWords, PicturesTakeAllOfThem) {
    const json document = openApi();
    for (const auto* address : {"snapshot.jpg", "snapshot.png", "stream.mjpg"}) {
        Names taken;
        for (const json& parameter :
             document["paths"][std::string("/api/v1/clouds/{id}/") + address]["get"]["parameters"])
            taken.insert(test::resolved(document, parameter)["name"]);
        for (const auto& word : viewWords())
            EXPECT_TRUE(taken.contains(parameterName(word)))
                << "openapi.json: the parameters of " << address << " lack the $ref of " << word.word;
    }
}

TEST(OpenApiWords, TheJsonViewHasTheTablesFields) {
    const json document = openApi();
    const json& schemas = document["components"]["schemas"];
    std::map<std::string, Names> fields;  // by schema
    for (const auto& word : viewWords()) {
        SCOPED_TRACE(word.path);
        const auto dot = word.path.find('.');
        const bool inObject = dot != std::string_view::npos;
        const std::string object(inObject ? word.path.substr(0, dot) : "");
        const std::string key(inObject ? word.path.substr(dot + 1) : word.path);
        const std::string schema = object == "camera" ? "Camera" : object == "light" ? "Light" : "View";
        if (inObject) fields["View"].insert(object);
        fields[schema].insert(key);
        const json& properties = schemas[schema]["properties"];
        if (!properties.contains(key)) {
            ADD_FAILURE() << "openapi.json: components.schemas." << schema << ".properties lacks " << key;
            continue;
        }
        if (word.value.range) expectRange(properties[key], *word.value.range);
        if (!inObject) {
            EXPECT_EQ(schemas["ViewChange"]["properties"].value(key, json()), properties[key]);
        }
    }
    for (const auto& [schema, names] : fields)
        EXPECT_EQ(keysOf(schemas[schema]["properties"]), names) << schema;
}

}  // namespace
}  // namespace scancast
