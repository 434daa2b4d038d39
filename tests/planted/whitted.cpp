// Faults of ray trees: branches without their weight, lamps that stand in their own light, shadows of coloured glass without colour.
#include "tests/planted/trial.h"
#include <numbers>

namespace chiaro::test {

namespace {

constexpr double pi64 = std::numbers::pi;

void mirroredLamp(Trial& t) { // a mirror of .8 shows a lamp of radiance 3
    SceneDesc s;
    const int mirror = shapes::add(s, shapes::metal("mirror", Spectrum(.8f), 0)), lamp = shapes::add(s, shapes::lamp("lamp", Spectrum(3)));
    shapes::add(s, "mirror", plate({0, 0, 0}, {0, 1, 0}, .1), mirror);
    shapes::add(s, "lamp", plate({0, 1, 0}, {0, -1, 0}, 1), lamp);
    t.equal(*compiled(std::move(s)), probe({0, 0, 0}, {0, -1, 0}, .5), {4, 4}, 2.4, "whitted");
}

// A lamp over a floor of .8, from where the lamp is small: L A cos / d^2.
SceneDesc over(PrimitiveDesc lampShape) {
    SceneDesc s;
    const int floor = shapes::add(s, shapes::diffuse("floor", Spectrum(.8f))), lamp = shapes::add(s, shapes::lamp("lamp", Spectrum(1)));
    shapes::add(s, "floor", plate({0, 0, 0}, {0, 1, 0}, 5), floor);
    shapes::add(s, "lamp", std::move(lampShape), lamp, shapes::translation({0, 2, 0}));
    return s;
}
void ownLight(Trial& t) {
    const PrimitiveDesc flat = plate({0, 0, 0}, {0, -1, 0}, .5), bulb = shapes::sphere(.1, 3);
    t.equal(*compiled(over(flat)), probe({0, 0, 0}, {0, -1, 0}), {4, 4}, .8 / pi64 / 4, "whitted");
    t.equal(*compiled(over(bulb)), probe({0, 0, 0}, {0, -1, 0}), {4, 4}, .8 / pi64 / 16 * shapes::area(bulb), "whitted");
}

void colouredShadow(Trial& t) { // green glass: a green shadow
    SceneDesc s;
    const int floor = shapes::add(s, shapes::diffuse("floor", Spectrum(.8f)));
    MaterialDesc green = shapes::glass("green", 1);
    green.baseColor = {0, .5f, 0};
    green.volume = false;
    const int pane = shapes::add(s, green);
    shapes::add(s, "floor", plate({0, 0, 0}, {0, 1, 0}, 5), floor);
    shapes::add(s, "pane", plate({0, .5, 0}, {0, 1, 0}, 1), pane);
    PunctualDesc lamp;
    lamp.toWorld = shapes::translation({0, 1, 0});
    s.lights.push_back(lamp);
    t.equal(*compiled(std::move(s)), probe({0, 0, 0}, {.6, -.8, 0}, .1), {4, 4}, .8 / pi64 * .5 * double(luminance(Spectrum(0, 1, 0))),
            "whitted");
}

const Check mirrorCheck{"lamp in a mirror of .8 (J1)", mirroredLamp, 16}, ownCheck{"lamps over a floor, far-field exact", ownLight, 16},
    shadowCheck{"shadow of green glass (J3)", colouredShadow, 16};

const PlantedRow rows[] = {
    {Fault::branchUnweighted, 0, "mirror and refraction rays added without their weights", mirrorCheck},
    {Fault::lampShadowsItself, 0, "an area light's own mesh stops the ray to its centre", ownCheck},
    {Fault::shadowUntinted, 0, "light through coloured glass keeps its own colour", shadowCheck},
};

} // namespace

std::span<const PlantedRow> plantedWhitted() { return rows; }

} // namespace chiaro::test

TEST_SUITE("planted-whitted") {
    TEST_CASE("each planted fault of ray trees is caught") { chiaro::test::catchAll(chiaro::test::plantedWhitted()); }
} // TEST_SUITE
