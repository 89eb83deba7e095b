#include "client/cpp/program/view_flags.hpp"

#include "protocol/nearest_name.hpp"
#include "protocol/view_words.hpp"

namespace scancast::client {

void ViewFlags::addTo(CLI::App& app) {
    for (const auto& word : viewWords()) {
        const std::string name(word.word), flag(word.flag);
        const auto help = std::string(word.meaning) + " Example: " + flag + " " + std::string(word.example);
        CLI::Option* option = nullptr;
        if (flag == "--param") {
            option = app.add_option(flag, parameters_, help)
                         ->expected(1)
                         ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
                         ->allow_extra_args(false);
        } else {
            option = app.add_option(flag, values_[name], help);
            options_[name] = option;
        }
        option->type_name(std::string(word.value))->group("View");
    }
}

Expected<WordValues> ViewFlags::words() const {
    WordValues words;
    for (const auto& word : viewWords()) {
        const auto option = options_.find(std::string(word.word));
        if (option != options_.end() && option->second->count() > 0)
            words.emplace_back(option->first, values_.at(option->first));
    }
    for (const auto& parameter : parameters_) {
        const auto equals = parameter.find('=');
        if (equals == std::string::npos || equals == 0)
            return fail(ErrorCode::InvalidArgument,
                        "--param takes NAME=VALUE, such as --param sizePx=5, not " + quoteText(parameter),
                        "param");
        words.emplace_back("param." + parameter.substr(0, equals), parameter.substr(equals + 1));
    }
    return words;
}

}  // namespace scancast::client
