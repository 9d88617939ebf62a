#include <CL/cl.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <filesystem>
#include <iterator>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

#include "bench/scenes/boxes.hpp"
#include "clinch/broad_phase.hpp"
#include "clinch/interop/opencl.hpp"
#include "clinch/narrow_phase.hpp"
#include "clinch/pipeline.hpp"
#include "tests/device/devices.hpp"
#include "tests/device/faults.hpp"
#include "tests/narrow_phase/narrow_scenes.hpp"
#include "tests/random.hpp"

using namespace clinch;
using test::Faults;
using test::faults_of_a_name;
using test::few_classes;
using test::first_device;
using test::move_some;
using test::Trial;

namespace {

// An empty folder that goes with the test.
class Folder {
public:
    Folder() : path_(std::filesystem::temp_directory_path() / "clinch-faults") {
        std::filesystem::remove_all(path_);
        std::filesystem::create_directories(path_);
    }
    ~Folder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
    std::string path() const { return path_.string(); }
    std::size_t files() const {
        return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(path_), {}));
    }

private:
    std::filesystem::path path_;
};

// What the smallest kernel there is gives on the first device, opened for it.
std::string smallest_kernel(Context& context) {
    detail::Device& device = context.impl().open(0);
    device.add_module("smallest", "kernel void smallest(global uint* p) { p[0] = 17; }\n");
    detail::Kernel kernel = device.kernel("smallest", "smallest");
    const detail::Buffer out = device.allocate(sizeof(std::uint32_t), "a number");
    device.launch(kernel.args(out), 1, 1);
    device.finish();
    std::uint32_t value = 0;
    device.read(out, &value, sizeof value);
    return std::to_string(value);
}

struct Opened {
    Context context;
    std::unique_ptr<Faults> faults;
    std::vector<std::string> log;
};

// With kernels kept in `folder`.
std::unique_ptr<Opened> to_open(const std::string& folder) {
    ContextOptions options = first_device();
    options.kernel_cache = folder;
    auto opened = std::make_unique<Opened>();
    options.log = [&log = opened->log](const std::string& line) { log.push_back(line); };
    opened->context = Context(options);
    opened->faults = std::make_unique<Faults>(opened->context);
    return opened;
}

bool logged(const Opened& opened, const std::string& text) {
    return std::any_of(opened.log.begin(), opened.log.end(),
                       [&](const std::string& line) { return line.find(text) != std::string::npos; });
}

// Boxes with filters, among which a fourth cannot move.
struct Boxes {
    std::vector<Aabb> boxes;
    std::vector<std::uint32_t> group, mask;
    std::vector<Motion> motion;

    Boxes(std::size_t n, std::uint64_t seed) : boxes(scenes::make_boxes("mixed", n, seed)) {
        test::Random random(seed);
        for (std::size_t i = 0; i < n; ++i) {
            group.push_back(1u << random.below(3));
            mask.push_back(random.below(4) == 0 ? 3u : 7u);
            motion.push_back(random.below(4) == 0 ? Motion::Static : Motion::Dynamic);
        }
    }
    FilterColumns filters() const { return {group.data(), mask.data(), motion.data()}; }
};

std::string found(BroadPhase& broad, const Boxes& in) {
    return test::bytes(broad.find(in.boxes, in.filters()));
}

BroadPhaseOptions with_algorithm(const std::string& name) {
    BroadPhaseOptions options;
    options.algorithm = name;
    return options;
}

}  // namespace

TEST_CASE("opening a device and building kernels bear the failure of any OpenCL call", "[device]") {
    const Folder kept;
    for (const bool from_cache : {false, true}) {
        // With an empty cache, and with one that holds the kernel: then a failure to load it is one to be lived with.
        const auto fresh = [&] {
            if (!from_cache) std::filesystem::remove_all(kept.path());
            return to_open(kept.path());
        };
        std::vector<std::string> calls;
        {
            const auto opened = fresh();
            REQUIRE(smallest_kernel(opened->context) == "17");
            calls = opened->faults->calls();
        }
        for (const std::string& name : {std::string("clCreateContext"), std::string("clCreateCommandQueue")})
            CHECK(std::count(calls.begin(), calls.end(), name) == 1);
        CHECK(std::count(calls.begin(), calls.end(), "clCreateProgramWithBinary") == (from_cache ? 1 : 0));
        CHECK(std::count(calls.begin(), calls.end(), "clCreateProgramWithSource") == (from_cache ? 0 : 1));
        for (const test::Fault& fault : test::faults_among(calls, calls.size(), 1)) {
            INFO(fault.call << " number " << fault.number << " fails with " << fault.status << ", from cache "
                            << from_cache);
            const auto opened = fresh();
            opened->faults->fail(fault.call, fault.number, fault.status);
            const bool of_cache = fault.call == "clGetProgramInfo" || fault.call == "clCreateProgramWithBinary" ||
                                  (from_cache && fault.call == "clBuildProgram");
            try {
                const std::string answer = smallest_kernel(opened->context);
                CHECK(answer == "17");
                CHECK(of_cache);
            } catch (const Error& error) {
                CHECK_FALSE(of_cache);
                if (fault.call == "clBuildProgram" && fault.status == CL_DEVICE_NOT_AVAILABLE)
                    CHECK(error.code() == ErrorCode::BuildFailed);
                else
                    test::check_told(error, fault.call, fault.status);
            }
            CHECK(opened->faults->failed() == fault.call);
            opened->faults->watch();
            CHECK(smallest_kernel(opened->context) == "17");
            CHECK(opened->context.report()[0].bytes == 0);
            // What was short says nothing of the entry; another reason is taken as the entry's fault.
            if (of_cache && from_cache)
                CHECK(logged(*opened, "deleted the kernel cache entry") == (fault.status != CL_OUT_OF_RESOURCES));
        }
    }
}

TEST_CASE("a kernel that does not build says so, with or without the compiler's words", "[device]") {
    const Folder folder;
    const auto opened = to_open(folder.path());
    detail::Device& device = opened->context.impl().open(0);
    device.add_module("faulty", "kernel void faulty(global uint* p) { p[0] = oops; }\n");
    for (const bool with_log : {true, false}) {
        opened->faults->fail([&](std::size_t, const std::string& name,
                                 std::size_t) { return !with_log && name == "clGetProgramBuildInfo"; },
                             CL_OUT_OF_HOST_MEMORY);
        try {
            device.kernel("faulty", "faulty");
            FAIL("no error");
        } catch (const Error& error) {
            CHECK(error.code() == ErrorCode::BuildFailed);
            CHECK(error.opencl_status() == CL_BUILD_PROGRAM_FAILURE);
            CHECK((error.build_log().find("oops") != std::string::npos) == with_log);
        }
    }
    opened->faults->fail([](std::size_t, const std::string& name, std::size_t) { return name == "clBuildProgram"; },
                         CL_BUILD_PROGRAM_FAILURE);
    CHECK_THROWS_AS(smallest_kernel(opened->context), Error);
    CHECK(folder.files() == 0);
    opened->faults->watch();
    CHECK(smallest_kernel(opened->context) == "17");
    CHECK(folder.files() == 1);
}

TEST_CASE("a kernel whose binary cannot be kept works, and is said not to be kept", "[device]") {
    const Folder folder;
    const auto opened = to_open(folder.path());
    opened->faults->fail([](std::size_t, const std::string& name, std::size_t) { return name == "clGetProgramInfo"; },
                         CL_OUT_OF_HOST_MEMORY);
    CHECK(smallest_kernel(opened->context) == "17");
    CHECK(logged(*opened, "cannot keep kernel module 'smallest'"));
    CHECK(folder.files() == 0);
    const auto nowhere = to_open("/dev/null/nowhere");
    CHECK(smallest_kernel(nowhere->context) == "17");
    CHECK(logged(*nowhere, "cannot keep a compiled kernel in '/dev/null/nowhere'"));
}

TEST_CASE("the buffer of another is asked for its size with care", "[device]") {
    const Boxes in(50, 3);
    Context context(first_device());
    Faults faults(context);
    detail::Device& device = context.impl().open(0);
    const std::size_t bytes = in.boxes.size() * sizeof(Aabb);
    detail::Buffer boxes = device.allocate(bytes, "boxes");
    device.write(boxes, in.boxes.data(), bytes);
    BroadPhase broad(context, with_algorithm("brute"));
    const auto find = [&] { return test::bytes(find_pairs(broad, boxes.handle(), in.boxes.size())); };
    const std::string expected = find();
    for (const std::size_t number : {0u, 1u}) {
        faults.fail("clGetMemObjectInfo", number, CL_DEVICE_NOT_AVAILABLE);
        try {
            find();
            FAIL("no error");
        } catch (const Error& error) {
            CHECK(faults.failed() == "clGetMemObjectInfo");
            test::check_told(error, faults.failed(), CL_DEVICE_NOT_AVAILABLE);
        }
        faults.watch();
        CHECK(find() == expected);
    }
}

TEST_CASE("a broad phase bears the failure of any OpenCL call", "[device]") {
    constexpr std::uint64_t seed = 17;
    const Boxes some(700, seed), many(4500, seed + 1);
    Context context(first_device());
    Faults faults(context);
    for (const std::string& name : test::names_for(context.devices()[0])) {
        if (!detail::algorithm_named(name).needs_device) continue;
        INFO("algorithm " << name << ", seed " << seed);
        const auto fresh = [&] { return BroadPhase(context, with_algorithm(name)); };
        const auto expected = [&](const Boxes& in) {
            BroadPhase broad = fresh();
            return found(broad, in);
        };
        const auto ask_some = [&](BroadPhase& broad) { return found(broad, some); };
        const auto ask_many = [&](BroadPhase& broad) { return found(broad, many); };
        const auto used = [&] {
            BroadPhase broad = fresh();
            broad.find(some.boxes);
            return broad;
        };
        test::check_faults(context, faults,
                           Trial{fresh, ask_some, expected(some), faults_of_a_name(context, 12), seed});
        test::check_faults(context, faults, Trial{used, ask_many, expected(many), faults_of_a_name(context, 6), seed});
    }
}

TEST_CASE("updates of a broad phase bear the failure of any OpenCL call, and its events do", "[device]") {
    constexpr std::uint64_t seed = 19;
    constexpr std::size_t count = 10000;  // fewer are not kept from call to call
    Context context(first_device());
    if (!detail::runs_on(detail::algorithm_named("grid"), context.devices()[0])) return;
    Faults faults(context);
    // Boxes as they are after some updates; the next one is to be found.
    const std::vector<Aabb> before = scenes::make_boxes("density", count, seed);
    std::vector<Aabb> first = before, second = before, third = before;
    std::vector<std::uint32_t> changed;
    for (std::uint32_t i = 3; i < count; i += 40) {
        changed.push_back(i);
        for (std::size_t d = 0; d < 3; ++d) {
            const float by = i % 7 == 0 ? 3.0f : 0.01f;
            first[i].min[d] += by;
            first[i].max[d] += by;
            second[i].min[d] -= by;
            second[i].max[d] -= by;
            third[i].max[d] += 2.5f;
        }
    }
    BroadPhaseOptions options = with_algorithm("grid");
    options.events = true;
    const auto fresh = [&] { return BroadPhase(context, options); };
    const auto listed = [&](BroadPhase& broad, const std::vector<Aabb>& boxes) {
        const std::string pairs = test::bytes(broad.update(boxes, changed));
        return pairs + test::bytes(broad.added()) + test::bytes(broad.removed());
    };
    // The update that begins to keep pairs, one that uses them, and one after which the list before is there alone.
    const auto before_first = [&] {
        BroadPhase broad = fresh();
        broad.find(before);
        return broad;
    };
    const auto before_second = [&] {
        BroadPhase broad = before_first();
        broad.update(first, changed);
        return broad;
    };
    const auto before_third = [&] {
        BroadPhase broad = before_second();
        broad.update(second, changed);
        return broad;
    };
    const auto ask_first = [&](BroadPhase& broad) { return listed(broad, first); };
    const auto ask_second = [&](BroadPhase& broad) { return listed(broad, second); };
    const auto ask_third = [&](BroadPhase& broad) { return listed(broad, third); };
    // Full searches tell the same.
    const auto searched = [&](const std::vector<const std::vector<Aabb>*>& lists) {
        BroadPhase broad = fresh();
        std::string pairs;
        for (const std::vector<Aabb>* const boxes : lists) pairs = test::bytes(broad.find(*boxes));
        CHECK(broad.added().size() + broad.removed().size() > 100);
        return pairs + test::bytes(broad.added()) + test::bytes(broad.removed());
    };
    {
        BroadPhase broad = before_second();
        ask_second(broad);
        CHECK(broad.report().algorithm == "incremental");
        ask_third(broad);
        CHECK(broad.report().algorithm == "incremental");
        CHECK(broad.added().size() > 2048);  // more than one pass over the list edits, and more than it has room for
    }
    test::check_faults(
        context, faults,
        Trial{before_first, ask_first, searched({&before, &first}), faults_of_a_name(context, 6), seed, true});
    test::check_faults(
        context, faults,
        Trial{before_second, ask_second, searched({&first, &second}), faults_of_a_name(context, 8), seed});
    test::check_faults(
        context, faults,
        Trial{before_third, ask_third, searched({&second, &third}), faults_of_a_name(context, 20), seed});
}

TEST_CASE("a narrow phase bears the failure of any OpenCL call", "[device]") {
    constexpr std::uint64_t seed = 23;
    const Scene scene = few_classes(60, seed), other = few_classes(70, seed + 1);
    const std::vector<Pair> pairs = test::all_pairs(scene), others = test::all_pairs(other);
    Context context(first_device());
    Faults faults(context);
    for (const std::uint32_t points : {1u, 4u}) {
        INFO("contacts_per_pair " << points << ", seed " << seed);
        NarrowPhaseOptions options;
        options.contacts_per_pair = points;
        const auto fresh = [&] { return NarrowPhase(context, options); };
        const auto used = [&] {
            NarrowPhase narrow = fresh();
            narrow.find(other, others);
            return narrow;
        };
        const auto ask = [&](NarrowPhase& narrow) { return test::bytes(narrow.find(scene, pairs)); };
        NarrowPhase narrow = fresh();
        const std::string expected = ask(narrow);
        CHECK(expected.size() > 100 * sizeof(Contact));
        narrow = fresh();
        test::check_faults(context, faults, Trial{fresh, ask, expected, faults_of_a_name(context, 12), seed});
        test::check_faults(context, faults, Trial{used, ask, expected, faults_of_a_name(context, 6), seed});
    }
}

TEST_CASE("a call that found no room leaves the next to ask for what it needs itself", "[device]") {
    constexpr std::uint64_t seed = 31;
    const Scene many = few_classes(250, seed), few = few_classes(30, seed);
    const std::vector<Pair> many_pairs = test::all_pairs(many), few_pairs = test::all_pairs(few);
    Context plenty(first_device()), tight(first_device());
    tight.impl().infos[0].max_allocation = std::uint64_t{1} << 20;  // 1 MB in one buffer
    NarrowPhase expected(plenty), narrow(tight);
    const std::string contacts = test::bytes(expected.find(few, few_pairs));
    CHECK(expected.find(many, many_pairs).size() > few_pairs.size());
    CHECK_THROWS_AS(narrow.find(many, many_pairs), Error);
    const std::string found_tight = test::bytes(narrow.find(few, few_pairs));
    CHECK(found_tight == contacts);
}

TEST_CASE("a search that passed a limit leaves the next to ask for what it needs itself", "[device]") {
    const std::vector<Aabb> crowd(1500, Aabb{{0, 0, 0}, {1, 1, 1}}), few(100, Aabb{{0, 0, 0}, {1, 1, 1}});
    Context context(first_device());
    for (const std::string& name : test::names_for(context.devices()[0])) {
        if (!detail::algorithm_named(name).needs_device) continue;
        INFO("algorithm " << name);
        BroadPhaseOptions options = with_algorithm(name);
        options.max_pairs = 10000;
        BroadPhase broad(context, options);
        CHECK_THROWS_AS(broad.find(crowd), Error);
        const std::uint64_t held = context.report()[0].bytes;
        CHECK(broad.find(few).size() == 4950);
        CHECK(context.report()[0].bytes < held + (std::uint64_t{4} << 20));  // what was passed were 9 MB of pairs
    }
}

TEST_CASE("a pipeline bears the failure of any OpenCL call", "[device]") {
    constexpr std::uint64_t seed = 29;
    // A scene with its pipeline.
    struct World {
        Scene scene;
        Pipeline pipeline;
    };
    Context context(first_device());
    Faults faults(context);
    for (const std::uint32_t points : {1u, 4u}) {
        INFO("contacts_per_pair " << points << ", seed " << seed);
        PipelineOptions options;
        options.broad_phase.algorithm = "bvh";
        options.broad_phase.events = true;
        options.contacts = options.warm_start = true;
        options.narrow_phase.contacts_per_pair = points;
        const auto fresh = [&] { return World{few_classes(300, seed), Pipeline(context, options)}; };
        const auto used = [&] {
            World world = fresh();
            world.pipeline.step(world.scene);
            move_some(world.scene, seed);
            return world;
        };
        const auto step = [&](World& world) {
            const StepResult& result = world.pipeline.step(world.scene);
            return test::bytes(result.pairs()) + test::bytes(result.contacts());
        };
        const auto ask = [&](World& world) {
            const std::string found = step(world);
            return found + test::bytes(world.pipeline.step(world.scene).boxes());
        };
        const auto expected = [&](World world, const auto& how) {
            world.pipeline = Pipeline(context, options);
            const std::string found = how(world);
            world.pipeline = Pipeline(context, options);  // gives the memory back
            return found;
        };
        test::check_faults(context, faults,
                           Trial{fresh, ask, expected(fresh(), ask), faults_of_a_name(context, 8), seed});
        // A warm start, which a failure ends, may choose another of equal answers.
        World undisturbed = used();
        const std::string warm = step(undisturbed);
        undisturbed = fresh();
        test::check_faults(context, faults,
                           Trial{used, step, expected(used(), step), faults_of_a_name(context, 8), seed, false, warm});
    }
}
