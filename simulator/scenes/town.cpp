// The town: 200 m x 200 m of streets around a square, seen by scanners on its crossings, streets and square.
#include "simulator/scenes/town.hpp"

namespace scancast {

Model makeTown() {
    Model model;
    model.light.kind = Light::Kind::Sun;
    model.light.towards = townSun;
    model.light.color = glm::vec3(1.02F, 0.95F, 0.82F);
    model.light.sky = glm::vec3(0.40F, 0.45F, 0.54F);
    model.light.ground = glm::vec3(0.25F, 0.235F, 0.215F);
    model.largestRelief = 0.7;
    model.defaultOrigin = {389500, 5819800, 34};
    addGround(model);
    addHouses(model);
    addChurch(model, {0, 46, pavementHeight});
    addTrees(model);
    addStreetFurniture(model);
    constexpr double tripod = 1.75;
    for (const double y : {-63.75, -21.25, 21.25, 63.75})
        for (const double x : {-69.75, -25.25, 25.25, 69.75}) model.stations.push_back({x, y, tripod});
    for (const glm::dvec3 at :
         {glm::dvec3(0.6, -13, 0), {-14, 9.5, 0}, {14, 9.5, 0}, {-11, 30, 0}, {11, 30, 0}})
        model.stations.push_back(at + glm::dvec3(0, 0, tripod + pavementHeight));
    return model;
}

}  // namespace scancast
