// The matrix of form factors: reciprocal, complete, the same for any number of threads.
#include "scenes/scenes.h"
#include "tests/render/form_factors_kit.h"

using namespace chiaro;
using namespace chiaro::test;
using namespace chiaro::radiosity;

namespace {

// Bit for bit symmetric, no self-factor, rows ascending.
void checkMatrix(const FormFactorMatrix& m) {
    bool symmetric = true, ascending = true, finiteAll = true;
    for (uint32_t i = 0; i < m.size(); ++i) {
        uint32_t last = 0;
        bool first = true;
        for (const Factor& f : m.exchange(i)) {
            ascending = ascending && (first || f.patch > last) && f.patch != i;
            last = f.patch, first = false;
            finiteAll = finiteAll && std::isfinite(f.factor) && f.factor >= 0;
            bool found = false;
            for (const Factor& g : m.exchange(f.patch))
                if (g.patch == i) found = g.factor == f.factor;
            symmetric = symmetric && found;
        }
    }
    CHECK(symmetric);
    CHECK(ascending);
    CHECK(finiteAll);
}
double sumOf(const FormFactorMatrix& m, uint32_t i) {
    double s = 0;
    for (const Factor& f : m.row(i)) s += double(f.factor);
    return s;
}

} // namespace

TEST_SUITE("form-factor-matrix") {
    TEST_CASE("reciprocal to the last bit, rows keep their sums, near the exact factors: unequal patches") {
        SceneDesc d = room({1, 1.5, 2});
        shapes::add(d, "box", shapes::box({.3, .4, .2}), 0, shapes::translation({.2, -.5, .3}) * rotation({0, 1, 0}, .4));
        const auto scene = compiled(d);
        const Bare bare(*scene);
        const Patches p = patchesOf(bare, .6f);
        for (const FormFactorMethod method : {FormFactorMethod::hemisphere, FormFactorMethod::hemicube, FormFactorMethod::analytic}) {
            CAPTURE(int(method));
            FormFactorSettings s = by(method);
            s.resolution = 64;
            s.shadowRays = 16;
            FormFactorCheck check;
            const FormFactorMatrix m = formFactorMatrix(bare.work, FormFactors(bare.work, p, s), &check);
            checkMatrix(m);
            CHECK(check.worstAsymmetryAfter == 0);
            CHECK((method == FormFactorMethod::analytic) == (check.worstAsymmetry < 1e-6));
            double worst = 0;
            for (uint32_t i = 0; i < p.size(); ++i) worst = std::max(worst, std::fabs(sumOf(m, i) - 1));
            INFO("rows after: " << worst);
            CHECK(check.closed);
            CHECK(worst < 1e-5);
            CHECK(check.worstRowSumAfter == doctest::Approx(worst).epsilon(1e-3));
        }
    }
    TEST_CASE("a matrix by rays is nearer to the exact one than the rows that it was made of") {
        const auto scene = compiled(room({1, 1.5, 2}));
        const Bare bare(*scene);
        const Patches p = patchesOf(bare, .5f);
        const FormFactors rays(bare.work, p, by(FormFactorMethod::hemisphere)), analytic(bare.work, p, exact());
        const FormFactorMatrix m = formFactorMatrix(bare.work, rays);
        double before = 0, after = 0;
        std::vector<Factor> row;
        for (uint32_t i = 0; i < p.size(); ++i) {
            rays.row(i, row);
            std::vector<double> known(p.size()), found(p.size(), 0), merged(p.size(), 0);
            for (uint32_t j = 0; j < p.size(); ++j) known[j] = analytic.unoccluded(i, j);
            for (const Factor& f : row) found[f.patch] = double(f.factor);
            for (const Factor& f : m.row(i)) merged[f.patch] = double(f.factor);
            for (uint32_t j = 0; j < p.size(); ++j) {
                before += std::pow(found[j] - known[j], 2);
                after += std::pow(merged[j] - known[j], 2);
            }
        }
        CHECK(after < .6 * before); // two estimates of each
    }
    TEST_CASE("the same bits for any number of threads and in any order of rows") {
        const auto scene = compiled(makeCornell());
        const Bare one(*scene, 1), three(*scene, 3);
        const Patches p = patchesByCount(one, 500);
        FormFactorSettings s;
        s.rays = 256;
        const FormFactorMatrix a = formFactorMatrix(one.work, FormFactors(one.work, p, s)),
                               b = formFactorMatrix(three.work, FormFactors(three.work, p, s));
        CHECK(a.begin == b.begin);
        CHECK(std::equal(a.exchanges.begin(), a.exchanges.end(), b.exchanges.begin(), b.exchanges.end(),
                         [](const Factor& x, const Factor& y) { return x.patch == y.patch && x.factor == y.factor; }));
        const FormFactors f(one.work, p, s);
        std::vector<Factor> first, other, again;
        f.row(7, first), f.row(300, other), f.row(7, again);
        CHECK(std::equal(first.begin(), first.end(), again.begin(), again.end(),
                         [](const Factor& x, const Factor& y) { return x.patch == y.patch && x.factor == y.factor; }));
        f.hemisphereRow(7, 256, 1, other);
        CHECK(sumOf(other) == doctest::Approx(sumOf(first)).epsilon(.05));
    }
    TEST_CASE("alpha-masked patches stay reciprocal: half a screen before a wall") {
        SceneDesc d = twoPlates({0, 1, 0}, {1, 1, 0}, {1, 1, 1}, {0, 1, 1});
        d.materials.push_back(shapes::diffuse("screen", Spectrum(.5f)));
        d.materials[1].alphaMode = AlphaMode::blend;
        d.materials[1].alpha = .5f;
        d.meshes[1].primitives[0].material = 1;
        const auto scene = compiled(d);
        const Bare bare(*scene);
        const Patches p = patchesOf(bare, 1);
        REQUIRE(p.size() == 2);
        CHECK(p[1].coverage == doctest::Approx(.5));
        CHECK(p[1].area == doctest::Approx(.5));
        for (const FormFactorMethod method : {FormFactorMethod::hemisphere, FormFactorMethod::analytic}) {
            FormFactorSettings s = by(method);
            s.rays = 1 << 16;
            const FormFactors f(bare.work, p, s);
            CHECK(betweenParts(f, 0, 1) == doctest::Approx(parallel(1, 1, 1) / 2).epsilon(.01));
            CHECK(betweenParts(f, 1, 0) == doctest::Approx(parallel(1, 1, 1)).epsilon(.01));
        }
    }
    TEST_CASE("no more memory than allowed; a stop leaves nothing; nothing gives nothing") {
        const auto scene = compiled(room());
        Bare bare(*scene);
        const Patches p = patchesOf(bare, .1f);
        Bare small(*scene, 1, 0, 200'000);
        try {
            formFactorMatrix(small.work, FormFactors(small.work, p, {}));
            FAIL("not refused");
        } catch (const Error& e) { CHECK(e.code == Exit::resources); }
        bare.stop.request();
        CHECK(formFactorMatrix(bare.work, FormFactors(bare.work, p, {})).size() == 0);
        const auto empty = compiled(SceneDesc{});
        const Bare nothing(*empty);
        const Patches none = patchesByCount(nothing, 10);
        FormFactorCheck check;
        CHECK(formFactorMatrix(nothing.work, FormFactors(nothing.work, none, {}), &check).size() == 0);
        CHECK(check.worstRowSum == 0);
    }
} // TEST_SUITE
