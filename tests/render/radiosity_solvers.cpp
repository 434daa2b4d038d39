// The solvers on matrices written by hand: closed forms to the last digits, one bounce after the other, step by step.
#include "core/render/error.h"
#include "integrators/radiosity/solve_matrix.h"
#include "integrators/radiosity/solve_shoot.h"
#include <cmath>
#include <doctest/doctest.h>
#include <string>
#include <vector>

using namespace chiaro;
using namespace chiaro::radiosity;

namespace {

constexpr double opposite = 0.1998248957, beside = 0.2000437761; // unit squares of a cube

struct Case {
    System system;
    FormFactorMatrix matrix;
};
// F_ij of patches with these areas, A_i F_ij = A_j F_ji taken from the upper triangle.
Case made(const std::vector<float>& areas, const std::vector<std::vector<double>>& factors, const std::vector<float>& rho,
          const std::vector<double>& emission) {
    Case c;
    const std::size_t n = areas.size();
    c.system.areas = c.matrix.areas = areas;
    c.matrix.begin.push_back(0);
    for (std::size_t i = 0; i < n; ++i) {
        c.system.reflectance.emplace_back(rho[i]);
        c.system.emission.emplace_back(emission[i]);
        c.system.received.emplace_back(0.0);
        for (std::size_t j = 0; j < n; ++j) {
            const std::size_t a = std::min(i, j), b = std::max(i, j);
            if (factors[a][b] > 0) c.matrix.exchanges.push_back({uint32_t(j), float(double(areas[a]) * factors[a][b])});
        }
        c.matrix.begin.push_back(c.matrix.exchanges.size());
    }
    return c;
}
// Patch 0 emits and faces patch 1; 2 to 5 are the sides.
Case cube(float rhoEmitter, float rho) {
    std::vector<std::vector<double>> f(6, std::vector<double>(6, beside));
    for (std::size_t i = 0; i < 6; ++i) f[i][i] = 0;
    for (const auto& [a, b] : {std::pair{0, 1}, {2, 3}, {4, 5}})
        f[std::size_t(a)][std::size_t(b)] = f[std::size_t(b)][std::size_t(a)] = opposite;
    return made(std::vector<float>(6, 1.f), f, {rhoEmitter, rho, rho, rho, rho, rho}, {1, 0, 0, 0, 0, 0});
}

struct Bench {
    Executor executor{2};
    StopToken stop;
    Run run{executor, stop};
};
double radiosityOf(const Case& c, const Solution& s, std::size_t i) {
    return c.system.emission[i][0] + double(c.system.reflectance[i][0]) * s.irradiance(i)[0];
}
using Solve = Solution (*)(const System&, const FormFactorMatrix&, const Limits&, const Run&);
Solution shooting(const System& system, const FormFactorMatrix& m, const Limits& limits, const Run& run) {
    const auto row = [&](uint32_t i, std::vector<Factor>& out) {
        out.clear();
        for (const Factor f : m.row(i)) out.push_back(f);
    };
    return solveShooting(system, row, limits, {}, run);
}
constexpr std::pair<const char*, Solve> solvers[] = {
    {"jacobi", solveJacobi}, {"gauss-seidel", solveGaussSeidel}, {"direct", solveDirect}, {"shoot", shooting}};
Limits tight() {
    Limits l;
    l.tolerance = 1e-12;
    return l;
}

} // namespace

TEST_SUITE("radiosity-solvers") {
    TEST_CASE("two patches (A12)") {
        Bench b;
        for (const auto& [f, b1, b2] : {std::tuple{opposite, 1.0162312409, .1624546414}, {beside, 1.0162673972, .1626383741}}) {
            const Case c = made({1, 1}, {{0, f}, {f, 0}}, {.5f, .8f}, {1, 0});
            for (const auto& [name, solve] : solvers) {
                CAPTURE(name);
                const Solution s = solve(c.system, c.matrix, tight(), b.run);
                CHECK(s.complete);
                CHECK(radiosityOf(c, s, 0) == doctest::Approx(b1).epsilon(1e-7));
                CHECK(radiosityOf(c, s, 1) == doctest::Approx(b2).epsilon(1e-7));
            }
        }
        SUBCASE("of unequal areas: B1 = 1 / (1 - rho1 rho2 F12 F21)") {
            const Case c = made({2, .5f}, {{0, .1}, {0, 0}}, {.5f, .8f}, {1, 0});
            for (const auto& [name, solve] : solvers) {
                CAPTURE(name);
                const Solution s = solve(c.system, c.matrix, tight(), b.run);
                CHECK(radiosityOf(c, s, 0) == doctest::Approx(1 / (1 - .5 * .8 * .1 * .4)).epsilon(1e-7));
                CHECK(radiosityOf(c, s, 1) == doctest::Approx(.8 * .4 / (1 - .5 * .8 * .1 * .4)).epsilon(1e-7));
            }
        }
    }

    TEST_CASE("a cube of six patches (A13)") {
        Bench b;
        struct Row {
            float rhoEmitter, rho;
            double emitter, across, side;
        };
        for (const Row& r : {Row{.5f, .5f, 1.0909090981, .1817458261, .1818362689}, Row{.8f, .8f, 1.5517241536, .6895510707, .6896811939},
                             Row{.9f, .9f, 2.3728813748, 1.5253105511, 1.5254520185}, Row{0, .5f, 1, .1666003395, .1666832454}}) {
            const Case c = cube(r.rhoEmitter, r.rho);
            for (const auto& [name, solve] : solvers) {
                CAPTURE(name);
                CAPTURE(r.rho);
                const Solution s = solve(c.system, c.matrix, tight(), b.run);
                CHECK(radiosityOf(c, s, 0) == doctest::Approx(r.emitter).epsilon(1e-6));
                CHECK(radiosityOf(c, s, 1) == doctest::Approx(r.across).epsilon(1e-6));
                for (std::size_t i = 2; i < 6; ++i) CHECK(radiosityOf(c, s, i) == doctest::Approx(r.side).epsilon(1e-6));
                CHECK(s.residuals.back() < 1e-10);
            }
        }
    }

    TEST_CASE("gathering bounce by bounce (A14), told apart or not") {
        Bench b;
        const Case c = cube(.5f, .5f);
        const double sums[] = {1, 1.5, 1.75, 1.875}, across[] = {0, .0999124478, .1399299602, .1609273331};
        for (const auto& [name, solve] : solvers)
            for (uint32_t bounces = 0; bounces < 4; ++bounces)
                for (const uint32_t apart : {1u, 8u}) {
                    CAPTURE(name);
                    CAPTURE(bounces);
                    CAPTURE(apart);
                    Limits limits = tight();
                    limits.bounces = bounces;
                    limits.apart = apart;
                    const Solution s = solve(c.system, c.matrix, limits, b.run);
                    CHECK(s.terms.size() == limits.levels());
                    double sum = 0;
                    for (std::size_t i = 0; i < 6; ++i) sum += radiosityOf(c, s, i);
                    CHECK(sum == doctest::Approx(sums[bounces]).epsilon(1e-6));
                    CHECK(radiosityOf(c, s, 1) == doctest::Approx(across[bounces]).epsilon(1e-6));
                }
        // The terms one by one are those of the series, whoever solves the rest.
        Limits apart = tight();
        apart.apart = 3;
        const Solution series = solveJacobi(c.system, c.matrix, apart, b.run);
        for (const auto& [name, solve] : solvers) {
            CAPTURE(name);
            const Solution s = solve(c.system, c.matrix, apart, b.run);
            REQUIRE(s.terms.size() == 4);
            for (std::size_t k = 0; k < 4; ++k)
                for (std::size_t i = 0; i < 6; ++i) CHECK(s.terms[k][i][0] == doctest::Approx(series.terms[k][i][0]).epsilon(1e-9));
        }
    }

    TEST_CASE("shooting step by step: who shoots, and what is left (A15)") {
        Bench b;
        const Case c = cube(.5f, .5f);
        const auto row = [&](uint32_t i, std::vector<Factor>& out) {
            out.clear();
            for (const Factor f : c.matrix.row(i)) out.push_back(f);
        };
        std::vector<uint32_t> order;
        ShootSettings how;
        how.order = &order;
        const double left[] = {.5, .4499890560, .3949759229, .3344657456};
        for (uint32_t steps = 1; steps <= 4; ++steps) {
            how.steps = steps;
            const Solution s = solveShooting(c.system, row, tight(), how, b.run);
            CHECK(power(s.unshot, c.system.areas) == doctest::Approx(left[steps - 1]).epsilon(1e-6));
            CHECK(s.residuals.size() == steps);
        }
        how.steps = 7;
        order.clear();
        solveShooting(c.system, row, tight(), how, b.run);
        const auto kinds = [&] {
            std::string text;
            for (const uint32_t i : order) text += i == 0 ? 'e' : i == 1 ? 'o' : 's';
            return text;
        };
        CHECK(kinds() == "essssoe");
        CHECK(order[1] == 2); // the first of equals
        how.steps = 0;
        const Solution done = solveShooting(c.system, row, tight(), how, b.run);
        for (std::size_t k = 1; k < done.residuals.size(); ++k) CHECK(done.residuals[k] <= done.residuals[k - 1]);
        CHECK(radiosityOf(c, done, 0) == doctest::Approx(1.0909090981).epsilon(1e-6));
        SUBCASE("overshooting gets to the same end") {
            how.overshoot = true;
            const Case bright = cube(.9f, .9f);
            const auto brightRow = [&](uint32_t i, std::vector<Factor>& out) {
                out.clear();
                for (const Factor f : bright.matrix.row(i)) out.push_back(f);
            };
            const Solution over = solveShooting(bright.system, brightRow, tight(), how, b.run);
            CHECK(radiosityOf(bright, over, 1) == doctest::Approx(1.5253105511).epsilon(1e-6));
            how.overshoot = false;
            const Solution plain = solveShooting(bright.system, brightRow, tight(), how, b.run);
            CHECK(over.residuals.size() < plain.residuals.size());
        }
        SUBCASE("the ambient term brings the mean of an early step near the end") {
            how.steps = 3;
            how.ambient = true;
            const Solution early = solveShooting(c.system, row, tight(), how, b.run);
            double sum = 0;
            for (std::size_t i = 0; i < 6; ++i) sum += radiosityOf(c, early, i);
            CHECK(sum == doctest::Approx(2).epsilon(1e-6)); // of one reflectance everywhere: exact
        }
    }

    TEST_CASE("lights that are no patches; colours on their own; nothing lost in the dark") {
        Bench b;
        Case c = cube(.5f, .5f);
        c.system.emission.assign(6, Light(0));
        c.system.received[0] = {1, 0, 0};
        c.system.received[1] = {0, 2, 0};
        for (Spectrum& r : c.system.reflectance) r = {.5f, .8f, 0};
        for (const auto& [name, solve] : solvers) {
            CAPTURE(name);
            const Solution s = solve(c.system, c.matrix, tight(), b.run);
            double absorbed[3] = {};
            for (std::size_t i = 0; i < 6; ++i)
                for (std::size_t k = 0; k < 3; ++k) absorbed[k] += (1 - double(c.system.reflectance[i][k])) * s.irradiance(i)[k];
            CHECK(absorbed[0] == doctest::Approx(1).epsilon(1e-6)); // a closed room keeps all that came in
            CHECK(absorbed[1] == doctest::Approx(2).epsilon(1e-6));
            CHECK(absorbed[2] == 0);
        }
        c.system.received.assign(6, Light(0));
        for (const auto& [name, solve] : solvers) CHECK(solve(c.system, c.matrix, tight(), b.run).irradiance(3)[0] == 0);
    }

    TEST_CASE("a factorisation beyond the memory limit says what else there is") {
        Bench b;
        const Case c = cube(.5f, .5f);
        b.run.memoryLimit = 100;
        CHECK_THROWS_WITH_AS(solveDirect(c.system, c.matrix, tight(), b.run), doctest::Contains("solver=gauss-seidel"), Error);
    }
} // TEST_SUITE
