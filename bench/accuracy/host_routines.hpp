// Candidates of the kernels' own source on the host, in the numbers of the shim included before; its name for the
// namespace is REAL_NAMESPACE.
#pragma once

#include <utility>

#include "bench/accuracy/candidate.hpp"
#include "src/device/stopwatch.hpp"
#include "tests/narrow_phase/closed_form_answer.hpp"

namespace clinch::detail::REAL_NAMESPACE {
#include "cl/narrow_phase/convex.clh"

constexpr unsigned real_bits = 8 * sizeof(real);

/// What a candidate asks: the routine of a pair of classes, or the general one at a tolerance.
struct Question {
    Routine routine = nullptr;
    uint kind_a = 0, kind_b = 0;
    real tolerance = 0;

    void ask(const Side& a, const Side& b, v3 between, Touch& touch) const {
        if (routine != nullptr)
            routine(&a, &b, between, &touch);
        else
            touch_convex_within(kind_a, kind_b, &a, &b, between, CONVEX_FAR, tolerance, &touch);
    }
};

class HostRoutine final : public accuracy::Candidate {
public:
    HostRoutine(accuracy::Title title, Question question) : Candidate(std::move(title)), question_(question) {}

    void load(const std::vector<test::TruePair>& pairs, std::size_t copies) override {
        loaded_.clear();
        loaded_.resize(pairs.size() * copies);
        touches_.assign(loaded_.size(), Touch{});
        for (std::size_t i = 0; i < loaded_.size(); ++i) {
            const test::TruePair& pair = pairs[i % pairs.size()];
            Loaded& l = loaded_[i];
            hold(pair.a, l.a);
            hold(pair.b, l.b);
            real way[3];
            for (std::size_t d = 0; d < 3; ++d) way[d] = way_between(pair.a.position[d], pair.b.position[d], &l.slack);
            l.between = v_of(way[0], way[1], way[2]);
        }
        first_copy_ = pairs.size();
    }
    double run() override {
        const Stopwatch watch;
        for (std::size_t i = 0; i < loaded_.size(); ++i)
            question_.ask(loaded_[i].a.side, loaded_[i].b.side, loaded_[i].between, touches_[i]);
        return watch.ms() * 1e-3;
    }
    std::vector<accuracy::Found> found() const override {
        std::vector<accuracy::Found> all;
        for (std::size_t i = 0; i < first_copy_; ++i) {
            const Touch& t = touches_[i];
            // As the driver widens it for what positions have lost.
            all.push_back(
                {static_cast<double>(t.distance),
                 static_cast<double>(t.error) + 2 * loaded_[i].slack + 1e-37,
                 {static_cast<double>(t.normal.x), static_cast<double>(t.normal.y), static_cast<double>(t.normal.z)},
                 true});
        }
        return all;
    }

private:
    struct Loaded {
        HeldSide a, b;
        v3 between{};
        double slack = 0;
    };
    Question question_;
    std::vector<Loaded> loaded_;
    std::vector<Touch> touches_;
    std::size_t first_copy_ = 0;
};

/// The general routine at its own tolerance and at others, for all but planes; `own`: the closed form, if there is one.
inline void add_routines(test::Kind a, test::Kind b, Routine own, const std::vector<double>& tolerances,
                         accuracy::Candidates& candidates) {
    const auto add = [&](const char* name, double tolerance, const Question& question) {
        candidates.push_back(
            std::make_unique<HostRoutine>(accuracy::Title{name, "host", real_bits, tolerance}, question));
    };
    if (own != nullptr) add("own", -1, {own});
    if (a == test::Kind::plane || b == test::Kind::plane) return;
    const uint kind_a = static_cast<uint>(a), kind_b = static_cast<uint>(b);
    const bool curved = is_curved(kind_a) || is_curved(kind_b);
    add(own != nullptr ? "gjk-epa" : "own", -1, {nullptr, kind_a, kind_b, curved ? CONVEX_CURVED : number(0.0)});
    for (const double tolerance : tolerances)
        add("gjk-epa", tolerance, {nullptr, kind_a, kind_b, static_cast<real>(tolerance)});
}

}  // namespace clinch::detail::REAL_NAMESPACE
