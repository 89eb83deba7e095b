#include "renderer/simulate/materials.hpp"
namespace scancast {
Model makeTown() {
    return makePlane();
}
}  // namespace scancast
