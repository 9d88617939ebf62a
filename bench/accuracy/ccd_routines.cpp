// libccd: GJK with EPA, and MPR, at their default tolerances. They tell the depth of overlapping bodies, and of others
// only that they do not overlap; neither promises an error.
#include <cmath>

#include "bench/accuracy/candidate.hpp"
#include "bench/accuracy/support.hpp"

#ifdef CLINCH_WITH_LIBCCD
#include <ccd/ccd.h>

#include "src/device/stopwatch.hpp"

namespace clinch::accuracy {
namespace {

/// A body with its turn as a matrix, in double: what a caller of libccd would write.
struct CcdBody {
    test::Kind kind = test::Kind::sphere;
    std::array<double, 3> size{}, position{};
    std::array<std::array<double, 3>, 3> axes{};
    std::vector<std::array<double, 3>> points;
    std::size_t* looks = nullptr;  // counts those of the pair
};

// Its expanding polytope has no limit of its own and runs for ever on some pairs. Beyond this both bodies are told to
// be the origin, which is no progress, and ends it.
constexpr std::size_t most_looks = 20000;

CcdBody ccd_body(const test::TrueBody& body, const std::array<double, 3>& origin) {
    CcdBody c{body.kind, body.size, {}, {}, body.points, nullptr};
    const Reach reach(body);
    for (std::size_t i = 0; i < 3; ++i) {
        c.position[i] = body.position[i] - origin[i];
        for (std::size_t d = 0; d < 3; ++d) c.axes[i][d] = static_cast<double>(reach.axis(i)[d]);
    }
    return c;
}

std::array<double, 3> farthest(const CcdBody& b, const std::array<double, 3>& m) {
    const auto signed_like = [](double length, double sign) { return sign < 0 ? -length : length; };
    const double across = std::sqrt(m[0] * m[0] + m[1] * m[1]), r = b.size[0], h = b.size[1];
    const auto rim = [&](double z) {
        return across > 0 ? std::array<double, 3>{r * m[0] / across, r * m[1] / across, z}
                          : std::array<double, 3>{0, 0, z};
    };
    switch (b.kind) {
        case test::Kind::box:
            return {signed_like(r, m[0]), signed_like(h, m[1]), signed_like(b.size[2], m[2])};
        case test::Kind::cylinder:
            return rim(signed_like(h, m[2]));
        case test::Kind::cone:
            return 2 * h * m[2] > r * across ? std::array<double, 3>{0, 0, h} : rim(-h);
        case test::Kind::hull: {
            const std::array<double, 3>* best = b.points.data();
            double most = -INFINITY;
            for (const auto& p : b.points) {
                const double d = m[0] * p[0] + m[1] * p[1] + m[2] * p[2];
                if (d > most) {
                    most = d;
                    best = &p;
                }
            }
            return *best;
        }
        default: {  // sphere, capsule
            const double l = std::sqrt(across * across + m[2] * m[2]), s = l > 0 ? r / l : 0;
            const double z = b.kind == test::Kind::capsule ? signed_like(h, m[2]) : 0;
            return {s * m[0], s * m[1], s * m[2] + z};
        }
    }
}

void support(const void* object, const ccd_vec3_t* direction, ccd_vec3_t* out) {
    const CcdBody& b = *static_cast<const CcdBody*>(object);
    if (++*b.looks > most_looks) {
        ccdVec3Set(out, 0, 0, 0);
        return;
    }
    std::array<double, 3> m{};
    for (std::size_t i = 0; i < 3; ++i)
        m[i] = b.axes[i][0] * direction->v[0] + b.axes[i][1] * direction->v[1] + b.axes[i][2] * direction->v[2];
    const std::array<double, 3> p = farthest(b, m);
    for (std::size_t d = 0; d < 3; ++d)
        out->v[d] = b.position[d] + p[0] * b.axes[0][d] + p[1] * b.axes[1][d] + p[2] * b.axes[2][d];
}

// A point inside: of a hull the mean of its vertices.
void centre(const void* object, ccd_vec3_t* out) {
    const CcdBody& b = *static_cast<const CcdBody*>(object);
    std::array<double, 3> mean{};
    for (const auto& p : b.points)
        for (std::size_t d = 0; d < 3; ++d) mean[d] += p[d] / static_cast<double>(b.points.size());
    for (std::size_t d = 0; d < 3; ++d)
        out->v[d] = b.position[d] + mean[0] * b.axes[0][d] + mean[1] * b.axes[1][d] + mean[2] * b.axes[2][d];
}

using Penetration = int (*)(const void*, const void*, const ccd_t*, ccd_real_t*, ccd_vec3_t*, ccd_vec3_t*);

class CcdRoutine final : public Candidate {
public:
    CcdRoutine(Title title, Penetration penetration) : Candidate(std::move(title)), penetration_(penetration) {}
    bool promises() const override { return false; }
    void load(const std::vector<test::TruePair>& pairs, std::size_t copies) override {
        bodies_.clear();
        for (std::size_t i = 0; i < pairs.size() * copies; ++i) {
            const test::TruePair& pair = pairs[i % pairs.size()];
            bodies_.push_back(ccd_body(pair.a, pair.a.position));
            bodies_.push_back(ccd_body(pair.b, pair.a.position));
        }
        answers_.assign(pairs.size() * copies, {});
        first_copy_ = pairs.size();
    }
    double run() override {
        ccd_t ccd;
        CCD_INIT(&ccd);
        ccd.support1 = ccd.support2 = support;
        ccd.center1 = ccd.center2 = centre;
        ccd.max_iterations = 1000;
        const detail::Stopwatch watch;
        for (std::size_t i = 0; i < answers_.size(); ++i) {
            ccd_real_t depth = 0;
            ccd_vec3_t direction{}, position{};
            std::size_t looks = 0;
            bodies_[2 * i].looks = bodies_[2 * i + 1].looks = &looks;
            const int status = penetration_(&bodies_[2 * i], &bodies_[2 * i + 1], &ccd, &depth, &direction, &position);
            if (looks > most_looks) depth = NAN;
            answers_[i] = {-depth, 0, {direction.v[0], direction.v[1], direction.v[2]}, status == 0};
        }
        return watch.ms() * 1e-3;
    }
    std::vector<Found> found() const override {
        return {answers_.begin(), answers_.begin() + static_cast<std::ptrdiff_t>(first_copy_)};
    }

private:
    Penetration penetration_;
    std::vector<CcdBody> bodies_;
    std::vector<Found> answers_;
    std::size_t first_copy_ = 0;
};

}  // namespace

void add_ccd(test::Kind a, test::Kind b, Candidates& candidates) {
    if (a == test::Kind::plane || b == test::Kind::plane) return;
    candidates.push_back(std::make_unique<CcdRoutine>(Title{"libccd-gjk-epa", "host", 64, -1}, ccdGJKPenetration));
    candidates.push_back(std::make_unique<CcdRoutine>(Title{"libccd-mpr", "host", 64, -1}, ccdMPRPenetration));
}

}  // namespace clinch::accuracy
#else
namespace clinch::accuracy {

void add_ccd(test::Kind /*a*/, test::Kind /*b*/, Candidates& /*candidates*/) {}

}  // namespace clinch::accuracy
#endif
