// How much work a test does under a sanitizer, which is 5 to 20 times as slow and looks at each line of code, not at
// each size: what proves a promise by sheer amount proves it in the other builds.
#pragma once

namespace scancast::test {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool sanitized = true;
#else
inline constexpr bool sanitized = false;
#endif

/// `full`, or `small` under a sanitizer.
template <class T>
constexpr T sized(T full, T small) {
    return sanitized ? small : full;
}

}  // namespace scancast::test
