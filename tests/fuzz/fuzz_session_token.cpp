// Sessions' tokens, as any hello may bring them.
#include <cstddef>
#include <cstdint>
#include <string>

#include "server/stream/resume_store.hpp"
#include "server/stream/session_token.hpp"
#include "tests/fuzz/require.hpp"

using namespace scancast;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const std::string key = "q7Rf-2mVbX9_sKd4TzJw81LcNhYpGuEo";
    static ResumeStore store({.unixTime = [] { return std::int64_t(1'700'000'000); }});
    static const bool hasKey = (store.setKeys({key}), true);
    require(hasKey);
    const std::string text(reinterpret_cast<const char*>(data), size);
    const auto claimed = parseSessionToken(text);
    if (claimed) {
        // One token has one spelling.
        const std::string again = signedToken(claimed->token, key);
        require(again.substr(0, again.rfind('.')) == claimed->text);
        require(claimed->isSignedWith(key) == (again == text));
    }
    // Whoever goes on with a session has its token: only what was signed with the key is believed.
    if (const auto resumed = store.resume(text, "anna", {})) {
        require(claimed && claimed->isSignedWith(key) && claimed->token.owner == ownerDigest("anna"));
        require(resumed->id == claimed->token.session && !resumed->saved);
        store.forget(resumed->place);
    }
    require(store.size() == 0);
    return 0;
}
