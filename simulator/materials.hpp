// Materials that more than one scene uses.
#pragma once

#include <string>
#include <vector>

#include "simulator/model.hpp"

namespace scancast {

// Classes of ASPRS LAS 1.4 R15, table 17, that more than one scene gives to its points.
inline constexpr std::uint8_t groundClass = 2, buildingClass = 6;

/// One colour with a little life in it: clouds of lighter and darker, and grain.
class PlainMaterial final : public Material {
  public:
    struct Options {
        glm::vec3 color{0.5F};
        float reflectance = 0.5F;
        std::uint8_t classification = 1;
        float variation = 0.06F;     ///< of brightness
        float variationSize = 0.5F;  ///< metres
        std::uint32_t salt = 0;
    };
    explicit PlainMaterial(const Options& options) : options_(options) {}
    void apply(const Patch& patch, SurfacePoint& point) const override;

  private:
    Options options_;
};

/// Stripes across s: awnings, crossings, planks.
class StripedMaterial final : public Material {
  public:
    struct Options {
        glm::vec3 first{0.9F}, second{0.5F};
        float width = 0.3F;
        float reflectance = 0.5F;
        std::uint8_t classification = 1;
    };
    explicit StripedMaterial(const Options& options) : options_(options) {}
    void apply(const Patch& patch, SurfacePoint& point) const override;

  private:
    Options options_;
};

/// A board with lines of text.
class SignMaterial final : public Material {
  public:
    struct Line {
        std::string text;
        double height = 0.5, foot = 0;  ///< metres; foot = above the board's lower edge
        glm::vec3 color{1};
        double boldness = 1;
    };
    struct Options {
        glm::vec3 board{0.1F, 0.2F, 0.4F}, rim{0.9F};
        double rimWidth = 0.08;
        std::vector<Line> lines;
        float reflectance = 0.6F, inkReflectance = 0.9F;
        std::uint8_t classification = 1;
    };
    explicit SignMaterial(Options options) : options_(std::move(options)) {}
    void apply(const Patch& patch, SurfacePoint& point) const override;

  private:
    Options options_;
};

/// Mixes two colours: 0 = a, 1 = b.
inline glm::vec3 blend(const glm::vec3& a, const glm::vec3& b, float part) {
    return a + (b - a) * part;
}

inline glm::vec3 rgb(int hex) {
    return glm::vec3(float((hex >> 16) & 255), float((hex >> 8) & 255), float(hex & 255)) / 255.0F;
}

}  // namespace scancast
