// A page of what S3 answers to "which objects are there" (ListObjectsV2), read by a reader of our own for the few elements that
// matter: no document types, no entities but the five of XML and numbers, bounded depth. Pure functions; any thread. Place:
// requests → **object list** → clouds that come and go.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "protocol/error.hpp"

namespace scancast {

struct ListedObject {
    std::string key;
    /// Of another object under that key another text: its ETag, size and date, as they were sent.
    std::string state;
    bool operator==(const ListedObject&) const = default;
};

struct ObjectPage {
    std::vector<ListedObject> objects;  ///< 1,000 at most
    std::string next;                   ///< what asks for the next page; empty: this is the last one
};

/// Malformed, with the byte, for what is no such answer from its first byte to its last, and for one that says there is more and
/// not how to ask for it: half an answer is never taken for all there is.
Expected<ObjectPage> parseObjectPage(std::string_view xml);

}  // namespace scancast
