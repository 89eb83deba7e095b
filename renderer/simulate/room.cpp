#include "renderer/simulate/materials.hpp"
namespace scancast {
Model makeRoom() {
    return makePlane();
}
}  // namespace scancast
