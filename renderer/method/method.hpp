// A rendering method: name, parameters, and the short list of passes that draws it. One file pair per method,
// or for a few that share their parameters. Methods know nothing of devices; the parameter list is the source
// of /methods, of the page's controls and of the documentation.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/view/view.hpp"
#include "renderer/device/pass.hpp"

namespace scancast {

struct Parameter {
    enum class Type : std::uint8_t { Number, Boolean, Choice };
    std::string name;  ///< as in `param.NAME=VALUE`
    Type type = Type::Number;
    ParameterValue defaultValue;
    double min = 0, max = 0;           ///< Number: inclusive
    std::vector<std::string> choices;  ///< Choice
    std::string unit;                  ///< "px", "" …
    std::string meaning;               ///< one sentence for people
};

/// What a method asks of the samples; a request for a cloud that cannot give it is refused with the way to
/// get it.
enum class Needs : std::uint8_t {
    Points,   ///< nothing
    Surfels,  ///< radius, ellipse and normal of every sample
};

/// What a cloud is, as far as methods' passes depend on it.
struct CloudTraits {
    bool surfels = false;   ///< samples carry radius, ellipse and normal
    bool oriented = false;  ///< the normals' sign means something
    bool normals = false;   ///< samples carry normals: surfels, or the scan's own
    bool colors = false;    ///< the scan's own RGB
    double spacing = 0;     ///< s0, cloud units
    double noise = 0;  ///< typical distance of points from their surface, cloud units; 0: unknown, or none
    glm::dvec3 up{0, 0, 1};
};

struct Method;

struct PassRequest {
    const Method& method;
    const ParameterValues& values;  ///< complete and checked (resolveParameters)
    Shading shading = Shading::Unlit;
    CloudTraits cloud{};
    double detail = 1;  ///< τ that the picture is selected with, px
    LightRig light{};
    int height = 720;              ///< of the whole picture, px
    bool visibility = false;       ///< the picture is of what hidden point removal finds (`color=visibility`)
    int samples = defaultSamples;  ///< a pixel: frames that are averaged
};

struct Method {
    std::string name;
    std::string title;
    std::string summary;  ///< one or two sentences: what it shows well
    std::string source;   ///< the paper, or "none" and the section of docs/spec
    std::vector<Parameter> parameters;
    double defaultDetail = 1;  ///< τ, px
    Shading defaultShading = Shading::Unlit;
    Needs needs = Needs::Points;
    /// Lights clouds without normals, too: it makes them itself.
    bool makesNormals = false;
    /// Removes hidden points, and can show which.
    bool findsHidden = false;
    /// Ends with addShading(): a PhongPass or EyeDomePass at the end is the shading's alone.
    PassList (*passes)(const PassRequest& request) = nullptr;
};

/// Every method, in the order in which people should see them.
std::span<const Method> methods();
/// nullptr when there is none of that name.
const Method* findMethod(std::string_view name);
/// Fills in defaults and checks names, types and ranges. Errors: InvalidArgument with field "param.NAME",
/// naming the legal range or the nearest known name.
Expected<ParameterValues> resolveParameters(const Method& method, const ParameterValues& given);

/// The screen passes of the request's shading, at the end of a list (light.hpp).
void addShading(const PassRequest& request, PassList& list);

}  // namespace scancast
