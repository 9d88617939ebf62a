// Every cell of the matrix on hostile pairs, each answer looked at by certificates.
//   clinch_tests "[.campaign]"      with CLINCH_CAMPAIGN_PAIRS pairs a cell (1,000,000), of the cells that
//                                   CLINCH_CAMPAIGN_CELLS names ("box-box cone-hull"; all), from CLINCH_CAMPAIGN_SEED
//                                   (1); with CLINCH_CAMPAIGN_WARM=1 started warm, from corners of other shapes: an
//                                   answer then depends on the start within its error, so kin are not compared
#include <catch2/catch.hpp>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <sstream>
#include <string>

#include "clinch/narrow_phase.hpp"
#include "src/narrow_phase/matrix.hpp"
#include "tests/device/devices.hpp"
#include "tests/narrow_phase/campaign_judge.hpp"
#include "tests/narrow_phase/campaign_threads.hpp"

using namespace clinch;
using namespace clinch::test::campaign;

namespace {

constexpr std::size_t block = 256;
constexpr double wide = 1e30;  // margins that every gap is within

/// The three ways to ask, each with what it keeps between calls.
class Asker {
public:
    /// `warm`: pairs start from what they were decided by when they were others.
    explicit Asker(Context& context, bool warm = false) : warm_(warm) {
        for (const Asked asked : all_asked) {
            NarrowPhaseOptions options;
            options.precision = precision_of(asked);
            phases_.emplace_back(context, options);
        }
    }
    bool is_warm() const noexcept { return warm_; }
    /// Answers of all pairs; valid until the next call.
    std::vector<Answers> answers_of(const Batch& batch) {
        Scene scene = scene_of(batch, wide);
        REQUIRE(scene.rejected().empty());
        std::vector<Pair> pairs;
        for (std::uint32_t i = 0; i < batch.pairs.size(); ++i) pairs.push_back({2 * i, 2 * i + 1});
        std::vector<Answers> answers(batch.pairs.size());
        for (const Asked asked : {Asked::fast, Asked::exact, Asked::certain}) {
            if (asked == Asked::certain) {
                const std::vector<double> none(scene.row_count(), 0.0);
                scene.set_margins(none.data(), none.size());
            }
            for (const Contact& c :
                 phases_[static_cast<std::size_t>(asked)].find(scene, pairs, warm_ ? &kept_ : nullptr))
                answers[c.a / 2][asked] = &c;
        }
        return answers;
    }

private:
    std::vector<NarrowPhase> phases_;
    bool warm_;
    WarmStart kept_;
};

// `kin`: pairs are compared with those before them that they are kin of.
void judge_batch(const Batch& batch, const std::vector<Answers>& answers, bool kin, std::uint64_t seed,
                 Tallies& tallies) {
    std::mutex mutex;
    const std::size_t count = batch.pairs.size();
    in_threads((count + block - 1) / block, [&](std::size_t part) {
        test::Random random(seed + 31337 * part);
        Tallies own;
        for (std::size_t i = part * block; i < std::min(count, (part + 1) * block); ++i)
            judge(batch.pairs[i], answers[i], kin && i > 0 ? answers[i - 1] : Answers{}, random.below(16) == 0, random,
                  own);
        const std::lock_guard<std::mutex> lock(mutex);
        for (std::size_t k = 0; k < own.size(); ++k) tallies[k].add(own[k]);
    });
}

Tallies campaign(Asker& asker, const detail::MatrixRow& row, std::size_t pairs, std::size_t batch_size,
                 std::uint64_t seed) {
    Tallies tallies;
    for (std::size_t done = 0; done < pairs; done += batch_size) {
        const std::uint64_t number = done / batch_size;
        const Batch batch = batch_of(row.a, row.b, std::min(batch_size, pairs - done), seed, number);
        judge_batch(batch, asker.answers_of(batch), !asker.is_warm(), seed ^ number, tallies);
    }
    return tallies;
}

std::string report_of(const Tally& tally) {
    std::ostringstream out;
    for (std::size_t f = 0; f < fault_count; ++f)
        if (tally.faults[f] != 0) out << tally.faults[f] << ' ' << name_of(static_cast<Fault>(f)) << "; ";
    for (const std::string& text : tally.examples)
        if (!text.empty()) out << '\n' << text;
    return out.str();
}

void print(const std::string& classes, Asked asked, const Tally& t) {
    std::printf("%-18s %3.1f %9llu %9llu %7llu %8.3f %9.2g %9.2g %9.2g %9.2g\n", classes.c_str(), precision_of(asked),
                static_cast<unsigned long long>(t.answers), static_cast<unsigned long long>(t.proved),
                static_cast<unsigned long long>(t.broken()), t.used, t.off, t.promise, t.regret, t.witness);
    const std::string faults = report_of(t);
    if (!faults.empty()) std::printf("%s\n", faults.c_str());
    std::fflush(stdout);
}

std::uint64_t number_from(const char* name, std::uint64_t otherwise) {
    const char* const text = std::getenv(name);
    return text == nullptr ? otherwise : std::stoull(text);
}

}  // namespace

TEST_CASE("answers to hostile pairs of every cell keep their promises", "[device][builds]") {
    constexpr std::uint64_t seed = 81;
    Context context = test::with_lanes(0, list_devices()[0].lanes);
    Asker asker(context);
    for (const detail::MatrixRow& row : detail::matrix()) {
        const Tallies tallies = campaign(asker, row, 4000, 1000, seed);
        for (const Asked asked : all_asked) {
            const Tally& tally = tallies[static_cast<std::size_t>(asked)];
            INFO("seed " << seed << ", " << detail::classes_text(row) << ", precision " << precision_of(asked));
            CHECK(tally.answers == 4000);
            CHECK_THAT(report_of(tally), Catch::Equals(""));
        }
    }
}

TEST_CASE("the campaign: as many hostile pairs of every cell as are asked for", "[.campaign]") {
    const std::uint64_t pairs = number_from("CLINCH_CAMPAIGN_PAIRS", 1000000),
                        seed = number_from("CLINCH_CAMPAIGN_SEED", 1);
    const char* const cells = std::getenv("CLINCH_CAMPAIGN_CELLS");
    const std::string chosen = cells == nullptr ? "" : ' ' + std::string(cells) + ' ';
    std::printf("seed %llu\n%-18s %3s %9s %9s %7s %8s %9s %9s %9s %9s\n", static_cast<unsigned long long>(seed), "cell",
                "at", "pairs", "proved", "broken", "used", "off", "promise", "regret", "witness");
    Context context = test::with_lanes(0, list_devices()[0].lanes);
    Asker asker(context, number_from("CLINCH_CAMPAIGN_WARM", 0) != 0);
    for (const detail::MatrixRow& row : detail::matrix()) {
        const std::string classes = detail::classes_text(row);
        if (!chosen.empty() && chosen.find(' ' + classes + ' ') == std::string::npos) continue;
        const Tallies tallies = campaign(asker, row, pairs, 8192, seed);
        for (const Asked asked : all_asked) {
            const Tally& tally = tallies[static_cast<std::size_t>(asked)];
            print(classes, asked, tally);
            CHECK(tally.broken() == 0);
        }
    }
}
