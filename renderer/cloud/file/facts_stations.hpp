// The facts' places that the scanner stood at, and photos, as JSON in both directions. Pure functions.
// Pipeline: builder → **facts** → cloud file → residency, info.
#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <vector>

#include "renderer/cloud/cloud.hpp"
#include "renderer/cloud/file/block_place.hpp"
#include "renderer/cloud/file/facts_fields.hpp"

namespace scancast {

/// Only what is there. `photos`: where the bytes of facts.photos are, as many.
void addStations(const CloudFacts& facts, std::span<const BlockPlace> photos, nlohmann::json& json);

/// What is wrong, `fields` know.
void takeStations(FactsFields& fields, CloudFacts& facts);
/// After the stations, whose numbers they have.
void takePhotos(FactsFields& fields, CloudFacts& facts, std::vector<BlockPlace>& places);

}  // namespace scancast
