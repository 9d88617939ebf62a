#include "bench/machines/phases.hpp"

#include <algorithm>
#include <cmath>

#include "bench/scenes/random.hpp"

namespace clinch::machines {

PhaseStep stream(const PhaseLoad& load, const Stream& how, unsigned broad_units, unsigned units) {
    const double broad = load.broad / how.chunks / broad_units + how.seconds_a_chunk;
    const double narrow = load.narrow / how.chunks / (units - broad_units) + how.seconds_a_chunk;
    std::vector<double> taken(how.chunks);  // when the narrow phase takes each from the buffer
    double put = 0.0, done = 0.0;
    for (std::uint32_t i = 0; i < how.chunks; ++i) {
        put += broad;
        if (i >= how.held) put = std::max(put, taken[i - how.held]);
        taken[i] = std::max(put, done);
        done = taken[i] + narrow;
    }
    return {done, {broad * how.chunks, narrow * how.chunks}};
}

std::vector<PhaseLoad> falling_scene(std::size_t steps, double seconds) {
    const auto rise = [](double t, double at, double width) { return 1.0 / (1.0 + std::exp((at - t) / width)); };
    std::vector<PhaseLoad> scene;
    for (std::size_t i = 0; i < steps; ++i) {
        const double t = static_cast<double>(i) / static_cast<double>(steps);
        const double contacts = 0.05 + 5.0 * rise(t, 0.33, 0.03) - 3.5 * rise(t, 0.7, 0.06);
        scene.push_back({seconds * (1.0 + 0.8 * rise(t, 0.3, 0.05)), seconds * contacts});
    }
    return scene;
}

Balanced balance(const std::vector<PhaseLoad>& scene, const Stream& how, unsigned units, double noise,
                 std::uint64_t seed, Measured measured) {
    scenes::Random random(seed);
    detail::PhaseBalance balance(units);
    Balanced result;
    for (const PhaseLoad& load : scene) {
        result.broad_units.push_back(balance.broad_units());
        PhaseStep step = stream(load, how, balance.broad_units(), units);
        result.seconds.push_back(step.seconds);
        double best = step.seconds;
        for (unsigned broad = 1; broad < units; ++broad) best = std::min(best, stream(load, how, broad, units).seconds);
        result.best.push_back(best);
        step.busy.broad *= random.between(1.0 - noise, 1.0 + noise);
        step.busy.narrow *= random.between(1.0 - noise, 1.0 + noise);
        const bool checked = balance.checks_now();
        if (checked) ++result.checks;
        if (checked || measured == Measured::EveryStep)
            balance.measured(step.busy);
        else
            balance.passed();
    }
    result.moves = balance.moves();
    return result;
}

}  // namespace clinch::machines
