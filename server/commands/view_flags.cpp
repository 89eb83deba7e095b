#include "server/commands/view_flags.hpp"

namespace scancast {

namespace {

/// `--param sizePx=5` is the word `param.sizePx` with the value `5`.
void addParameterFlag(CLI::App& app, const ViewWord& word, WordValues& words) {
    app.add_option_function<std::vector<std::string>>(
           std::string(word.flag),
           [&words](const std::vector<std::string>& settings) {
               for (const auto& setting : settings) {
                   const auto equals = setting.find('=');
                   if (equals == std::string::npos) {
                       throw CLI::ValidationError("--param",
                                                  "expects NAME=VALUE, for example --param sizePx=5");
                   }
                   words.emplace_back("param." + setting.substr(0, equals), setting.substr(equals + 1));
               }
           },
           std::string(word.meaning))
        ->type_name("NAME=VALUE")
        ->expected(1)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
        ->group("The view");
}

}  // namespace

void addViewFlags(CLI::App& app, WordValues& words) {
    for (const auto& word : viewWords()) {
        if (word.flag == "--param") {
            addParameterFlag(app, word, words);
            continue;
        }
        app.add_option_function<std::string>(
               std::string(word.flag),
               [&words, name = std::string(word.word)](const std::string& value) {
                   words.emplace_back(name, value);
               },
               std::string(word.meaning) + " Example: " + std::string(word.example))
            ->type_name(std::string(word.value))
            ->group("The view");
    }
}

}  // namespace scancast
