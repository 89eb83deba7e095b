#include "protocol/flags/view_flags.hpp"

#include "protocol/nearest_name.hpp"
#include "protocol/view/view_words.hpp"

namespace scancast {
namespace {

/// Of one flag for several words, what each of them means and an example of the first.
struct GroupHelp {
    std::string meaning, example;
};

/// "--light ambient=0.3"; `param.NAME` says so itself.
std::string exampleOf(const ViewWord& word) {
    const std::string example(word.example);
    const bool any = word.word.ends_with(".NAME");
    return word.flag() + " " +
           (any ? example : std::string(word.word.substr(word.group().size() + 1)) + "=" + example);
}

GroupHelp helpOf(std::string_view group) {
    GroupHelp help;
    for (const auto& word : viewWords()) {
        if (word.group() != group) continue;
        const auto name = word.word.substr(group.size() + 1);
        if (help.example.empty()) help.example = exampleOf(word);
        if (!help.meaning.empty()) help.meaning += '\n';
        if (name != "NAME") help.meaning += std::string(name) + "=" + std::string(word.shape) + ": ";
        help.meaning += word.description();
    }
    return help;
}

/// One flag for several words: "sun=250,20" of --light is the word light.sun.
Expected<WordValues::value_type> wordOf(std::string_view group, const std::string& member) {
    const auto equals = member.find('=');
    if (equals == std::string::npos || equals == 0)
        return fail(ErrorCode::InvalidArgument,
                    "--" + std::string(group) + " takes NAME=VALUE, such as " + helpOf(group).example +
                        ", not " + quoteText(member),
                    std::string(group));
    return WordValues::value_type(std::string(group) + "." + member.substr(0, equals),
                                  member.substr(equals + 1));
}

/// For CLI11: empty when it is sound.
std::string complaintAbout(std::string_view group, const std::string& member) {
    const auto word = wordOf(group, member);
    if (!word) return word.error().message;
    const auto ok = checkWord(word->first, word->second);
    return ok ? std::string() : ok.error().message;
}

}  // namespace

void ViewFlags::addTo(CLI::App& app, const std::function<bool(const ViewWord&)>& wants) {
    for (const auto& word : viewWords()) {
        if (wants && !wants(word)) continue;
        const auto flag = word.flag();
        CLI::Option* option = nullptr;
        if (word.group().empty()) {
            const auto help = word.description() + " Example: " + flag + " " + std::string(word.example);
            option = app.add_option_function<std::string>(
                flag,
                [this, name = word.word](const std::string& value) {
                    if (auto ok = checkWord(name, value); !ok) throw CLI::ValidationError(ok.error().message);
                    given_.emplace_back(name, value);
                },
                help);
            option->type_name(std::string(word.shape));
        } else {
            const auto [members, isFirst] = members_.try_emplace(word.group());
            if (!isFirst) continue;
            const GroupHelp help = helpOf(word.group());
            option = app.add_option(flag, members->second, help.meaning + "\nExample: " + help.example)
                         ->check([group = word.group()](const std::string& member) {
                             return complaintAbout(group, member);
                         })
                         ->expected(1)
                         ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
                         ->allow_extra_args(false)
                         ->type_name("NAME=VALUE");
        }
        option->group("The view");
    }
}

Expected<WordValues> ViewFlags::words() const {
    WordValues words = given_;
    for (const auto& [group, members] : members_) {
        for (const auto& member : members) {
            auto word = wordOf(group, member);
            if (!word) return passOn(std::move(word));
            words.push_back(std::move(*word));
        }
    }
    return words;
}

}  // namespace scancast
