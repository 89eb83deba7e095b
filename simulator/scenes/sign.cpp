// A sign board, 2.4 m x 1.6 m, upright in the plane y = 0 and facing south, with text of eight sizes: what a
// method leaves readable, and at which density of points, is the comparison that the papers make. Points
// stand in shaken rows and carry the texture's own colour: no light, no grain at noise 0.
#include "simulator/materials.hpp"

namespace scancast {

Model makeSign() {
    Model model;
    model.smallestCell = 0.04;
    model.largestCell = 0.5;
    SignMaterial::Options board;
    const glm::vec3 navy = rgb(0x12304f), red = rgb(0xb3202c), black = rgb(0x1b1b1b);
    board.board = rgb(0xf6f2e6);
    board.rim = navy;
    board.rimWidth = 0.03;
    board.lines = {
        {"CHAPEL", 0.30, 1.20, navy, 1.25},
        {"OPEN 9 - 17:30", 0.15, 0.945, red, 1.15},
        {"STONE BY STONE - 1248", 0.09, 0.77, navy},
        {"PLEASE DO NOT TOUCH THE CARVINGS", 0.06, 0.635, black},
        {"THE QUICK BROWN FOX JUMPS OVER THE LAZY DOG", 0.04, 0.53, black},
        {"PACK MY BOX WITH FIVE DOZEN LIQUOR JUGS 0123456789", 0.03, 0.445, black},
        {"SPHINX OF BLACK QUARTZ JUDGE MY VOW: 31 / 12 / 1999 - 24.05.2031", 0.02, 0.38, black},
        {"ABCDEFGHIJKLMNOPQRSTUVWXYZ 0123456789 & - . / : THIS LINE IS 12 MM HIGH", 0.012, 0.33, black},
        {"NORTH AISLE 12 M", 0.12, 0.13, red, 1.15}};
    Patch& face =
        model.add(Patch::trapezoid({-1.2, 0, 0}, {2.4, 0, 0}, {0, 0, 1.6}), model.add<SignMaterial>(board));
    face.regular = true;
    model.stations = {{0, -4, 0.8}};
    return model;
}

}  // namespace scancast
