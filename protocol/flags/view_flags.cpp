#include "protocol/flags/view_flags.hpp"

#include "protocol/nearest_name.hpp"
#include "protocol/view/view_words.hpp"

namespace scancast {

void ViewFlags::addTo(CLI::App& app) {
    for (const auto& word : viewWords()) {
        const auto flag = word.flag();
        const auto help = word.description() + " Example: " + flag + " " + std::string(word.example);
        CLI::Option* option = nullptr;
        if (flag == "--param")
            option = app.add_option(flag, parameters_, help)
                         ->expected(1)
                         ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
                         ->allow_extra_args(false);
        else
            option = app.add_option_function<std::string>(
                flag,
                [this, name = word.word](const std::string& value) { given_.emplace_back(name, value); },
                help);
        option->type_name(std::string(word.shape))->group("The view");
    }
}

Expected<WordValues> ViewFlags::words() const {
    WordValues words = given_;
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

}  // namespace scancast
