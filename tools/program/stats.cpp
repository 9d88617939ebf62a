#include "tools/program/stats.hpp"

#include <sys/resource.h>

#include <cstdint>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

namespace clinch::program {
namespace {

using Json = nlohmann::ordered_json;

std::uint64_t peak_host_bytes() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

Json devices(const std::vector<DeviceReport>& reports) {
    Json list = Json::array();
    for (const DeviceReport& r : reports)
        list.push_back({{"index", r.info.index},
                        {"name", r.info.name},
                        {"platform", r.info.platform},
                        {"context_created", r.opened},
                        {"kernels_built", r.modules_built},
                        {"kernels_cached", r.modules_cached},
                        {"peak_bytes", r.peak_bytes}});
    return list;
}

std::size_t modules_used(const std::vector<DeviceReport>& reports) {
    std::set<std::string> used;
    for (const DeviceReport& r : reports) {
        used.insert(r.modules_built.begin(), r.modules_built.end());
        used.insert(r.modules_cached.begin(), r.modules_cached.end());
    }
    return used.size();
}

Json rejections(const std::vector<Rejection>& rejected) {
    Json list = Json::array();
    for (const Rejection& r : rejected) list.push_back({{"body", r.body}, {"why", r.why}});
    return list;
}

/// What a command with a narrow phase tells besides.
void add_narrow(Json& stats, const NarrowReport& report, const NarrowTimes& ms) {
    Json buckets = Json::array();
    for (const BucketReport& bucket : report.buckets)
        buckets.push_back({{"classes", bucket.classes},
                           {"routine", bucket.routine},
                           {"numbers", bucket.numbers},
                           {"pairs", bucket.pairs},
                           {"again", bucket.again}});
    stats["buckets"] = std::move(buckets);
    stats["ms_narrow"] = {{"upload", ms.upload},
                          {"buckets", ms.buckets},
                          {"routines", ms.routines},
                          {"manifolds", ms.manifolds},
                          {"gather", ms.gather}};
    stats["skipped"]["cells"] = report.cells_skipped;
}

}  // namespace

std::string stats_text(const Measured& measured, const Context& context, const StatsInput& input) {
    const Report& report = measured.last.report;
    const StageTimes& ms = measured.median;
    const std::vector<DeviceReport> reports = context.report();
    double build_ms = 0.0;
    for (const DeviceReport& r : reports) build_ms += r.build_ms;
    const Json stats = {{"bodies", report.bodies},
                        {"pairs", report.pairs},
                        {"contacts", report.contacts},
                        {"frames", 1},
                        {"box_tests", report.box_tests},
                        {"algorithm", report.algorithm},
                        {"devices", devices(reports)},
                        {"ms",
                         {{"total", ms.total},
                          {"upload", ms.upload},
                          {"bounds", ms.bounds},
                          {"broad", ms.broad},
                          {"narrow", ms.narrow},
                          {"download", ms.download}}},
                        {"ms_once", {{"read", input.read_ms}, {"build", build_ms}, {"first", measured.first_ms}}},
                        {"skipped",
                         {{"bounds", report.skipped.bounds},
                          {"pairs_filtered", report.skipped.pairs_filtered},
                          {"static_pairs", report.skipped.static_pairs},
                          {"pairs_cached", 0},
                          {"unchanged", report.skipped.unchanged},
                          {"inside", report.skipped.inside},
                          {"still", report.skipped.still},
                          {"kernels_not_built", context.module_count() - modules_used(reports)}}},
                        {"rejected", rejections(input.rejected)},
                        {"tolerance_missed", report.tolerance_missed},
                        {"peak_bytes", {{"host", peak_host_bytes()}, {"device", report.peak_device_bytes}}}};
    Json all = stats;
    if (measured.last.narrow) add_narrow(all, *measured.last.narrow, measured.narrow);
    return all.dump(2, ' ', false, Json::error_handler_t::replace) + '\n';
}

}  // namespace clinch::program
