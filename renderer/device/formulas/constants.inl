// Numbers of the formulas that both devices compute, whose units and reasons stand here alone. Included by host/constants.hpp and by
// gl/shaders/formulas.glsl; CONSTANT is what a constant is in that language.

// ---- What is visible, in 32 bits (host/splat_numbers.hpp)

// A surface: the normal's x, y, z in view space (x right, y up, z towards the viewer), turned to the eye (of an oriented ellipse as it
// is), times normalStepsOfSurface, in signed bytes from the lowest. Above them, of an ellipse the tolerance in px: 5 bits of a float's
// exponent, from 2^-8 on, and 3 of its mantissa; of a disc the way from the pixel to its centre, px to the right and up times
// offsetSteps over its half size, 4 signed bits each; of a cell the px along the ray from what is visible to where its surface lies
// behind a flap, as a tolerance is written.
CONSTANT float normalStepsOfSurface = 127.0f, stepPerNormal = 0.00787401572f;
CONSTANT float leastTolerance = 0.00390625f, largestTolerance = 4194304.0f;
CONSTANT int toleranceBase = 998244352;  // 2^-8 as a float has it: 119 << 23
CONSTANT int toleranceShift = 20;
CONSTANT float offsetSteps = 7.0f, halfPerStep = 0.142857149f;
// Discs of a cell: a gap across the surface is the one along the ray times the cosine, and no less than this much of it.
// docs/spec/voronoi.md section 4.
CONSTANT float leastCosineOfGap = 0.25f;
// Cosine of two discs' normals from which on they are of one surface and not of two sides of a crease; in steps squared.
CONSTANT int sameSide = 8065;
// Half sizes that a centre may lie off a plane and still be on it; and no plane is seen more edge-on than this.
CONSTANT float creaseSlack = 0.125f, leastOpen = 0.03125f;
// On the distances to centres, of those that win over a crease: 1/4096.
CONSTANT float creasePriority = 0.000244140625f;
// Of the cosine c of a fragment's normal and its cell's, what is left of its weight: 2 c - 1/2, at most 1.
CONSTANT float blendPerStep = 0.000124000246f;
// Squared cosine from which on an oriented sprite that faces away is seen from behind.
CONSTANT float farAway = 0.25f;
// What two normals leave of a tolerance, 2 cosine + 1/2 between the least and all of it; and what is visible edge-on, with the z of
// its normal, whatever they say, in the splat's own half sizes: 2 - 4 |z|, at most 1. docs/spec/surfels.md section 4.3.
CONSTANT float leastAgreement = 0.125f, agreementPerStep = 0.000124000246f, edgePerStep = 0.0314960629f;
// Weight of what lies farther behind, but within its own tolerance: it shows where of what is visible there are only borders, as
// beside a crease.
CONSTANT float hiddenShare = 0.03125f;

// ---- Borders that are smoothed (docs/spec/sprites.md section 9)

// Where a pixel lies from its paraboloid's centre, on each axis: 16 bits of px * placeSteps + placeMiddle. No splat is larger than 256 px.
CONSTANT float placeSteps = 256.0f, placeStep = 0.00390625f, placeMiddle = 32768.0f, lastPlace = 65535.0f;
// What two paraboloids differ by is counted in the sum of their rises and in px; less than this is nothing.
CONSTANT float leastRise = 1e-12f, leastSlope = 1e-6f;

// ---- Light (docs/spec/shading.md section 2)

// Where the headlight is: beside the way to the eye, to the left of it and above, 30 degrees seen from the pixel before the viewer.
CONSTANT float lampX = -0.5f, lampY = 0.28867513f;
// It reaches (cos + 0.4) / 1.4 of what faces it, and that softly.
CONSTANT float lampScale = 0.71428571f, lampOffset = 0.28571429f;
