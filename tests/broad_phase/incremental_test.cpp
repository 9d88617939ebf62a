#include "src/broad_phase/incremental.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <set>

#include "bench/scenes/boxes.hpp"
#include "clinch/broad_phase.hpp"
#include "clinch/error.hpp"
#include "tests/broad_phase/oracle.hpp"
#include "tests/device/devices.hpp"
#include "tests/pair_lists.hpp"
#include "tests/random.hpp"

using namespace clinch;

namespace {

bool same(View<const Pair> found, const std::vector<Pair>& expected) {
    return found.size() == expected.size() &&
           (expected.empty() || std::memcmp(found.data(), expected.data(), expected.size() * sizeof(Pair)) == 0);
}

// A world in which a few things happen each frame.
struct World {
    std::vector<Aabb> boxes;
    std::vector<std::uint32_t> group, mask;
    std::vector<Motion> motion;
    test::Random random{7};

    World(const std::string& kind, std::size_t n) : boxes(scenes::make_boxes(kind, n, 3)) {
        for (std::size_t i = 0; i < n; ++i) {
            group.push_back(1u << random.below(3));
            mask.push_back(random.below(4) == 0 ? 3u : 7u);
            motion.push_back(random.below(3) == 0 ? Motion::Static : Motion::Dynamic);
        }
    }
    FilterColumns filters() const { return {group.data(), mask.data(), motion.data()}; }

    // `count` boxes move a little, each seldom far; now and then one is no box, or grows. Ascending.
    std::vector<std::uint32_t> move(std::size_t count) {
        std::set<std::uint32_t> changed;
        while (changed.size() < count) changed.insert(static_cast<std::uint32_t>(random.below(boxes.size())));
        for (const std::uint32_t i : changed) {
            Aabb& box = boxes[i];
            const std::size_t what = random.below(40);
            if (!(box.min[0] <= box.max[0])) box = boxes[(i + 1) % boxes.size()];
            const double reach = what == 0 ? 10.0 : 0.02;
            for (int d = 0; d < 3; ++d) {
                const float by =
                    static_cast<float>(reach * (static_cast<double>(random.below(2001)) - 1000.0) / 1000.0);
                box.min[d] += by;
                box.max[d] += by;
            }
            if (what == 1) box.min[random.below(3)] = std::nanf("");
            if (what == 2) box.max[random.below(3)] += 3.0f;
        }
        return {changed.begin(), changed.end()};
    }
    // Some of the changed bodies get other filters.
    void change_filters(const std::vector<std::uint32_t>& changed) {
        for (std::size_t k = 0; k < changed.size(); k += 3) {
            group[changed[k]] = 1u << random.below(3);
            motion[changed[k]] = random.below(2) == 0 ? Motion::Sleeping : Motion::Dynamic;
        }
    }
};

// Steps the incremental path itself, which the public calls only take for many boxes.
void check_steps(detail::Device& device, const std::string& kind, std::size_t n, int frames, bool filtered) {
    World world(kind, n);
    const auto filters = [&] { return filtered ? world.filters() : FilterColumns{}; };
    const BroadPhaseOptions options;
    detail::Incremental incremental(device, options);
    detail::Buffer staging;
    int stepped = 0;
    for (int frame = 0; frame < frames; ++frame) {
        INFO(kind << " frame " << frame << " filtered " << filtered);
        const std::vector<std::uint32_t> changed = world.move(frame == 0 ? 0 : 1 + n / 100);
        if (filtered && frame % 4 == 2) world.change_filters(changed);
        std::vector<Aabb> rows;
        for (const std::uint32_t i : changed) rows.push_back(world.boxes[i]);

        detail::PairList pairs;
        detail::FindCounts counts;
        bool done = false;
        if (incremental.valid()) {
            detail::BoxInput there(device, staging.handle(), 0, static_cast<std::uint32_t>(n));
            done = incremental.update(there, {changed, rows.data(), false}, {filters(), 0}, pairs, counts);
            stepped += done ? 1 : 0;
        }
        if (!done) {
            CHECK(pairs.size() == 0);
            detail::BoxInput all(world.boxes, staging);
            std::vector<Pair> list = test::pairs_by_hand(world.boxes, filters());
            REQUIRE(incremental.build(all, {filters(), 0}, list, true));
            pairs.adopt(incremental.map_list(), incremental.list_size());
        }
        CHECK(same(pairs.view(), test::pairs_by_hand(world.boxes, filters())));
        const bool any_invalid = std::any_of(world.boxes.begin(), world.boxes.end(), [](const Aabb& box) {
            return !(box.min[0] <= box.max[0] && box.min[1] <= box.max[1] && box.min[2] <= box.max[2]);
        });
        if (done) CHECK((counts.invalid_boxes || !any_invalid));
    }
    CHECK(stepped > frames / 2);
}

}  // namespace

TEST_CASE("pairs kept from step to step are those of a search", "[device][builds]") {
    for (std::uint32_t i = 0; i < list_devices().size(); ++i) {
        if (!detail::runs_on(detail::algorithm_named("grid"), list_devices()[i])) continue;
        for (const std::uint32_t lanes : {1u, 4u, 8u, 16u}) {
            const Context context = test::with_lanes(i, lanes);
            detail::Device& device = context.impl().open(0);
            INFO("device " << i << " lanes " << lanes);
            check_steps(device, "density", 3000, 30, false);
            check_steps(device, "uniform", 2000, 20, true);
            check_steps(device, "mixed", 1500, 12, true);
        }
    }
}

TEST_CASE("a few steps of the incremental path", "[device][vectors]") {
    for (std::uint32_t i = 0; i < list_devices().size(); ++i) {
        if (!detail::runs_on(detail::algorithm_named("grid"), list_devices()[i])) continue;
        const Context context = test::with_lanes(i, 1);
        check_steps(context.impl().open(0), "density", 400, 5, true);
    }
}

TEST_CASE("a few steps of the incremental path, by vectors", "[device][vectors]") {
    for (std::uint32_t i = 0; i < list_devices().size(); ++i) {
        if (!detail::runs_on(detail::algorithm_named("grid"), list_devices()[i])) continue;
        const Context context = test::with_lanes(i, 8);
        check_steps(context.impl().open(0), "mixed", 300, 5, false);
    }
}

TEST_CASE("updates of many boxes give what a search gives", "[device]") {
    constexpr std::size_t n = 12000;
    for (std::uint32_t i = 0; i < list_devices().size(); ++i) {
        Context context = test::with_lanes(i, list_devices()[i].lanes);
        World world("density", n);
        BroadPhase broad_phase(context), fresh(context);
        const std::vector<std::uint32_t> none;
        CHECK(same(broad_phase.update(world.boxes, none), test::pairs_by_sweep(world.boxes)));
        for (int frame = 0; frame < 6; ++frame) {
            INFO("device " << i << " frame " << frame);
            const std::vector<std::uint32_t> changed = world.move(frame == 4 ? n / 2 : 100);
            const View<const Pair> found = broad_phase.update(world.boxes, changed);
            CHECK(same(found, test::pairs_by_sweep(world.boxes)));
            const View<const Pair> again = broad_phase.update(world.boxes, none);
            CHECK(same(again, test::pairs_by_sweep(world.boxes)));
            CHECK(broad_phase.report().skipped.unchanged == n);
            CHECK(broad_phase.report().box_tests == 0);
            fresh.find(world.boxes);
            if (frame == 3) {
                broad_phase.update(world.boxes, changed);
                CHECK(broad_phase.report().rejected.size() == fresh.report().rejected.size());
            }
        }
        const std::vector<std::uint32_t> beyond{static_cast<std::uint32_t>(n)};
        CHECK_THROWS_AS(broad_phase.update(world.boxes, beyond), Error);
        world.boxes.resize(n / 2);  // other boxes
        CHECK(same(broad_phase.update(world.boxes, none), test::pairs_by_sweep(world.boxes)));
    }
}

TEST_CASE("updates need no device", "[host]") {
    Context context = Context::host_only();
    World world("density", 800);
    BroadPhase broad_phase(context);
    for (int frame = 0; frame < 4; ++frame) {
        const std::vector<std::uint32_t> changed = world.move(20);
        CHECK(same(broad_phase.update(world.boxes, changed), test::pairs_by_hand(world.boxes)));
    }
}

TEST_CASE("updates with more pairs than one buffer holds are searches", "[device]") {
    World world("grid-touch", 12000);  // 13 pairs a box, and no more in fattened boxes
    for (std::uint32_t i = 0; i < list_devices().size(); ++i) {
        Context context = test::with_lanes(i, list_devices()[i].lanes);
        context.impl().infos[0].max_allocation = std::size_t{1} << 20;
        BroadPhase broad_phase(context);
        broad_phase.find(world.boxes);
        for (int frame = 0; frame < 3; ++frame) {
            INFO("device " << i << " frame " << frame);
            const std::vector<std::uint32_t> changed = world.move(50);
            const View<const Pair> found = broad_phase.update(world.boxes, changed);
            CHECK(found.size() * sizeof(Pair) > std::size_t{1} << 20);
            CHECK(same(found, test::pairs_by_sweep(world.boxes)));
            CHECK(broad_phase.report().algorithm != "incremental");
        }
    }
}

namespace {

// Updates of a broad phase against a sweep, frame by frame.
class Frames {
public:
    explicit Frames(std::uint32_t device, const std::string& kind, std::size_t n, BroadPhaseOptions options = {})
        : context_(test::with_lanes(device, list_devices()[device].lanes)),
          broad_phase_(context_, std::move(options)),
          boxes(scenes::make_boxes(kind, n, 5)) {}
    // Whether the update took the incremental path.
    bool update(const std::vector<std::uint32_t>& changed) {
        std::vector<Pair> found = test::copy(broad_phase_.update(boxes, changed));
        std::sort(found.begin(), found.end());
        CHECK(found == test::pairs_by_sweep(boxes));
        return broad_phase_.report().algorithm == "incremental";
    }
    void shift(std::uint32_t i, float by) {
        for (int d = 0; d < 3; ++d) {
            boxes[i].min[d] += by;
            boxes[i].max[d] += by;
        }
    }
    BroadPhase& broad_phase() { return broad_phase_; }

private:
    Context context_;
    BroadPhase broad_phase_;

public:
    std::vector<Aabb> boxes;
};

std::vector<std::uint32_t> devices_of_steps() {
    std::vector<std::uint32_t> devices;
    for (std::uint32_t i = 0; i < list_devices().size(); ++i)
        if (detail::runs_on(detail::algorithm_named("grid"), list_devices()[i])) devices.push_back(i);
    return devices;
}

}  // namespace

TEST_CASE("updates in which ever other boxes move begin anew when too many have", "[device]") {
    constexpr std::uint32_t n = 12000, at_once = 700;
    for (const std::uint32_t device : devices_of_steps())
        for (const Order order : {Order::Sorted, Order::Any}) {
            BroadPhaseOptions options;
            options.order = order;
            Frames frames(device, "density", n, options);
            frames.update({});
            int incremental = 0;
            for (std::uint32_t frame = 0; frame < 8; ++frame) {
                INFO("device " << device << " frame " << frame);
                std::vector<std::uint32_t> changed;
                for (std::uint32_t k = 0; k < at_once; ++k) {
                    changed.push_back((frame * at_once + k) % n);
                    frames.shift(changed.back(), 0.05f);
                }
                incremental += frames.update(changed) ? 1 : 0;
            }
            CHECK(incremental >= 4);
            CHECK(incremental < 7);
        }
}

TEST_CASE("updates take changed boxes in any order and more than once", "[device]") {
    for (const std::uint32_t device : devices_of_steps()) {
        Frames frames(device, "density", 10500);
        frames.update({});
        std::vector<std::uint32_t> changed;
        for (std::uint32_t k = 0; k < 300; ++k) changed.push_back(k * 7919 % 10500);
        for (int frame = 0; frame < 6; ++frame) {
            for (const std::uint32_t i : changed) frames.shift(i, 0.3f);
            std::vector<std::uint32_t> twice = changed;
            twice.insert(twice.end(), changed.rbegin(), changed.rend());
            CHECK(frames.update(twice) == (frame > 0));
        }
    }
}

TEST_CASE("updates with a box that overlaps all others, and boxes that jump", "[device]") {
    constexpr std::uint32_t n = 12000;
    for (const std::uint32_t device : devices_of_steps()) {
        INFO("device " << device);
        Frames frames(device, "density", n);
        frames.update({});
        const Aabb planet{{-1.0f, -1.0f, -1.0f}, {60.0f, 60.0f, 60.0f}};
        const Aabb far{{3.0e38f, -3.0e38f, 1.0e30f}, {3.1e38f, -2.9e38f, 1.1e30f}};
        const Aabb none{{std::nanf(""), 0.0f, 0.0f}, {1.0f, INFINITY, 1.0f}};
        std::vector<std::uint32_t> changed{5, 77, 78, n - 1};
        for (int frame = 0; frame < 12; ++frame) {
            INFO("frame " << frame);
            frames.boxes[5] = frame % 4 == 3 ? far : planet;
            if (frame % 4 < 2) frames.shift(5, 0.1f * static_cast<float>(frame));
            frames.boxes[77] = frame % 2 == 0 ? far : none;
            frames.boxes[78] = frame % 3 == 0 ? planet : frames.boxes[79];
            frames.shift(n - 1, frame % 2 == 0 ? 20.0f : -20.0f);
            CHECK(frames.update(changed) == (frame > 0));
        }
    }
}

TEST_CASE("events go on through errors, counts and streams between updates", "[device]") {
    for (const std::uint32_t device : devices_of_steps()) {
        INFO("device " << device);
        BroadPhaseOptions options;
        options.events = true;
        options.max_pairs = 30000;
        Frames frames(device, "density", 12000, options);
        BroadPhase& broad_phase = frames.broad_phase();
        frames.update({});
        std::vector<Pair> last = test::pairs_by_sweep(frames.boxes);
        const auto check = [&](const std::vector<std::uint32_t>& changed) {
            frames.update(changed);
            const std::vector<Pair> now = test::pairs_by_sweep(frames.boxes);
            CHECK(test::copy(broad_phase.added()) == test::without(now, last));
            CHECK(test::copy(broad_phase.removed()) == test::without(last, now));
            last = now;
        };
        std::vector<std::uint32_t> changed{3, 4, 5, 6, 7};
        for (int frame = 0; frame < 9; ++frame) {
            INFO("frame " << frame);
            for (const std::uint32_t i : changed) frames.shift(i, 0.4f);
            if (frame == 3) {  // more pairs than the limit
                const std::vector<Aabb> kept = frames.boxes;
                for (const std::uint32_t i : changed) frames.boxes[i] = {{-1, -1, -1}, {99, 99, 99}};
                CHECK_THROWS_AS(broad_phase.update(frames.boxes, changed), Error);
                frames.boxes = kept;
            }
            if (frame == 5) CHECK(broad_phase.count(frames.boxes) == test::pairs_by_sweep(frames.boxes).size());
            if (frame == 7) {
                std::size_t pairs = 0;
                broad_phase.stream(frames.boxes, [&](View<const Pair> piece) { pairs += piece.size(); });
                CHECK(pairs == test::pairs_by_sweep(frames.boxes).size());
            }
            check(changed);
        }
    }
}
