#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "tests/narrow_phase/campaign_judge.hpp"

namespace clinch::test::campaign {
namespace {

Real3 exact(const Vec3& v) {
    return {v.x, v.y, v.z};
}

double share(Real x, Real of) {
    return of > 0 ? static_cast<double>(x / of) : 0.0;
}

// One answer.
struct Look {
    const CampaignPair& pair;
    const PosedPair& posed;
    const Contact& c;
    Asked asked;
    Real3 on_a, on_b, normal;  // points from the first body's position
    Real world = 0;            // what rounding to world coordinates may do to a point

    Look(const CampaignPair& p, const PosedPair& at, const Contact& contact, Asked how)
        : pair(p), posed(at), c(contact), asked(how) {
        const Real3 origin = exact(p.a.position);
        on_a = exact(c.on_a) - origin;
        on_b = exact(c.on_b) - origin;
        normal = unit(exact(c.normal));
        world = 0x1p-50L * (length(origin) + length(on_a) + std::fabs(Real(c.distance)));
    }
    bool is_finite() const {
        for (const double x : {c.distance, c.error, c.normal.x, c.normal.y, c.normal.z, c.on_a.x, c.on_a.y, c.on_a.z,
                               c.on_b.x, c.on_b.y, c.on_b.z})
            if (!std::isfinite(x)) return false;
        return c.error >= 0;
    }
    // Half an ulp of 1 of what the answer passed through: floats, or two of them.
    Real rounding() const { return asked == Asked::exact ? 0x1p-47L : 0x1p-24L; }
    bool curved() const {
        const auto is_curved = [](const Form* form) { return form->kind == cylinder || form->kind == cone; };
        return is_curved(pair.a.form) || is_curved(pair.b.form);
    }
    // Whether the general routine answers: no closed form.
    bool general() const {
        const std::size_t low = std::min(pair.a.form->kind, pair.b.form->kind),
                          high = std::max(pair.a.form->kind, pair.b.form->kind);
        if (low == plane || high == plane) return false;
        return low == sphere ? high == hull : low != high || low > capsule;
    }
    // What the general routine leaves of curved shapes, of the size.
    Real tolerance() const { return !curved() ? 0 : asked == Asked::exact ? 1e-10L : 1e-6L; }
    bool of_plane() const { return pair.a.form->kind == plane || pair.b.form->kind == plane; }
    Real along_normal() const { return parted_along(posed, normal); }
    // Of a half-space there is one normal only.
    bool normal_is_sound() const {
        const Real slack = 16 * rounding();
        if (!of_plane()) return along_normal() >= Real(c.distance) - c.error - (slack + 2 * tolerance()) * posed.size;
        const bool first = pair.a.form->kind == plane;
        const Posed<Real>& half_space = first ? posed.a : posed.b;
        const Real3 up = half_space.turned(half_space.form->normals[0]) * (first ? 1.0L : -1.0L);
        return length(up - normal) <= slack;
    }
    // How far the points are outside their cores, or short of what the bodies reach along the normal.
    Real witness_off() const {
        return std::max(witness_off(posed.a, on_a, normal), witness_off(posed.b, on_b, -normal));
    }
    Real witness_off(const Posed<Real>& body, const Real3& point, const Real3& n) const {
        const Form& form = *body.form;
        const Real3 p = point - body.at;
        if (form.kind == plane) return std::fabs(body.turned(form.normals[0]).dot(p) - form.heights[0]);
        const Real3 q = point - n * form.ball;
        const Real outside = form.kind == hull ? beyond_faces(body, q) : outside_core(body, q);
        return std::max(outside, n.dot(farthest(body, n)) + form.ball - n.dot(p));
    }
    // Straight from the definition of a contact.
    bool is_joined() const {
        const Real3 end = exact(c.on_a) + exact(c.normal) * Real(c.distance) - exact(c.on_b);
        return length(end) <= world;
    }
};

// Along a direction that parts bodies apart by d less than d by e, their points miss each other by sqrt(2 d e). Where
// the general routine's direction may be off by e, its points may be by some times the square root of e and the size;
// in float32 more, where bodies touch and the way between their points is rounding.
Real witness_allowed(const Look& look) {
    const Real d = look.c.distance, e = look.c.error, size = look.posed.size;
    const Real missed = d > 0 ? std::sqrt(2 * d * e) : 0;
    const Real times = !look.general() ? 0 : look.asked == Asked::exact ? 4 : 16;
    const Real sideways = times * std::sqrt((e + look.tolerance() * size) * size);
    return 4 * e + look.world + 64 * look.rounding() * size + missed + sideways;
}

void note(Fault fault, const Look& look, const Bracket& bracket, Tally& tally) {
    ++tally.faults[fault];
    if (!tally.examples[fault].empty()) return;
    std::ostringstream out;
    out.precision(17);
    out << name_of(fault) << ": precision " << precision_of(look.asked) << " distance " << look.c.distance << " error "
        << look.c.error << " normal " << look.c.normal.x << ' ' << look.c.normal.y << ' ' << look.c.normal.z << " on_a "
        << look.c.on_a.x << ' ' << look.c.on_a.y << ' ' << look.c.on_a.z << "; certain is " << bracket.low << " to "
        << bracket.high << ", along the normal " << look.along_normal() << ", points off by " << look.witness_off()
        << ", size " << look.posed.size << text_of(look.pair);
    tally.examples[fault] = out.str();
}

void look_at(const Look& look, const Bracket& bracket, Tally& tally) {
    const Contact& c = look.c;
    const Real size = look.posed.size, d = c.distance, e = c.error, noise = 1e-17L * size;
    if (std::fabs(length(exact(c.normal)) - 1) > 16 * look.rounding()) note(not_unit, look, bracket, tally);
    if (!look.is_joined()) note(not_joined, look, bracket, tally);
    if (d + e < bracket.low - noise) note(too_near, look, bracket, tally);
    if (d - e > bracket.high + noise) note(too_far, look, bracket, tally);
    if (!look.normal_is_sound()) note(bad_normal, look, bracket, tally);
    const Real witness = look.witness_off();
    if (witness > witness_allowed(look)) note(bad_witness, look, bracket, tally);
    if (look.asked == Asked::certain && d - e > 0) note(false_hit, look, bracket, tally);
    if (d - e <= bracket.low + noise && d + e + look.world >= bracket.high - noise) ++tally.proved;
    const Real off = std::max({Real(0), bracket.low - d, d - bracket.high});
    tally.used = std::max(tally.used, share(off, e));
    // Sizes near the end of what floats hold have an absolute error of their own, as have positions far away.
    if (size < 1e-25L || length(exact(look.pair.a.position)) > 1e2L * size) return;
    tally.off = std::max(tally.off, share(off, size));
    tally.promise = std::max(tally.promise, share(e, size));
    tally.witness = std::max(tally.witness, share(std::max(witness - look.world, Real(0)), size));
    if (bracket.low < 0 && !look.of_plane())
        tally.regret =
            std::max(tally.regret, share(bracket.low - look.along_normal(), std::max(-bracket.low, 1e-3L * size)));
}

// What a pair and its kin may differ by besides their errors.
Real alike_within(const CampaignPair& pair, const PosedPair& at) {
    if (pair.kin == Kin::mirrored) return pair.a.form->kind == pair.b.form->kind ? at.size * 1e-17L : 0;
    const Real away = length(exact(pair.a.position)) + length(exact(pair.b.position));
    return 0x1p-51L * (away + at.size);
}

void look_at_kin(const Look& look, const Contact& other, const Bracket& bracket, Tally& tally) {
    const Real apart = std::fabs(Real(look.c.distance) - other.distance), within = alike_within(look.pair, look.posed);
    const bool alike = within > 0 ? apart <= within + look.c.error + other.error
                                  : apart == 0 && look.c.error == other.error && look.c.normal.x == -other.normal.x &&
                                        look.c.normal.y == -other.normal.y && look.c.normal.z == -other.normal.z;
    if (!alike) note(not_alike, look, bracket, tally);
}

// The pair has no answer: that is right only without margins, where it does not overlap.
void look_at_none(const CampaignPair& pair, Asked asked, const Bracket& bracket, Tally& tally) {
    if (asked == Asked::certain && bracket.low >= 0) ++tally.proved;
    if (asked == Asked::certain && !(bracket.high < 0)) return;
    ++tally.faults[lost];
    if (!tally.examples[lost].empty()) return;
    std::ostringstream out;
    out.precision(17);
    out << "lost: precision " << precision_of(asked) << "; certain is " << bracket.low << " to " << bracket.high
        << text_of(pair);
    tally.examples[lost] = out.str();
}

}  // namespace

const char* name_of(Fault fault) {
    constexpr const char* names[] = {"lost",     "false hit", "not finite", "normal not unit", "points not joined",
                                     "too near", "too far",   "bad normal", "bad witness",     "not alike"};
    return names[fault];
}

double precision_of(Asked asked) {
    return asked == Asked::fast ? 0.0 : asked == Asked::certain ? 0.5 : 1.0;
}

void Tally::add(const Tally& other) {
    answers += other.answers;
    proved += other.proved;
    for (std::size_t i = 0; i < faults.size(); ++i) faults[i] += other.faults[i];
    used = std::max(used, other.used);
    off = std::max(off, other.off);
    promise = std::max(promise, other.promise);
    regret = std::max(regret, other.regret);
    witness = std::max(witness, other.witness);
    for (std::size_t i = 0; i < examples.size(); ++i)
        if (examples[i].empty()) examples[i] = other.examples[i];
}

std::uint64_t Tally::broken() const {
    std::uint64_t sum = 0;
    for (const std::uint64_t n : faults) sum += n;
    return sum;
}

void judge(const CampaignPair& pair, const Answers& answers, const Answers& before, bool thorough, Random& random,
           Tallies& tallies) {
    const PosedPair at = posed(pair.a, pair.b);
    std::vector<Look> looks;
    std::vector<Real3> hints{unit(pair.hint)};
    for (const Asked asked : all_asked) {
        Tally& tally = tallies[static_cast<std::size_t>(asked)];
        ++tally.answers;
        if (answers[asked] == nullptr) continue;
        const Look look(pair, at, *answers[asked], asked);
        if (!look.is_finite()) {
            note(not_finite, look, {}, tally);
            continue;
        }
        looks.push_back(look);
        if (!look.of_plane()) hints.push_back(look.normal);
    }
    Bracket bracket = bracket_of(at, hints, thorough, random);
    for (const Look& look : looks)
        if (!look.of_plane())
            bracket.high = std::min(bracket.high, proved_by_points(at, look.on_a, look.on_b, look.normal));
    for (const Asked asked : all_asked)
        if (answers[asked] == nullptr) look_at_none(pair, asked, bracket, tallies[static_cast<std::size_t>(asked)]);
    for (const Look& look : looks) {
        Tally& tally = tallies[static_cast<std::size_t>(look.asked)];
        look_at(look, bracket, tally);
        if (pair.kin != Kin::none && before[look.asked] != nullptr)
            look_at_kin(look, *before[look.asked], bracket, tally);
    }
}

std::string text_of(const CampaignPair& pair) {
    std::ostringstream out;
    out.precision(17);
    for (const CampaignBody* body : {&pair.a, &pair.b}) {
        const Form& form = *body->form;
        out << "\n  kind " << form.kind << " size " << form.size[0] << ' ' << form.size[1] << ' ' << form.size[2];
        if (const Plane* p = std::get_if<Plane>(&form.shape))
            out << " plane " << p->normal.x << ' ' << p->normal.y << ' ' << p->normal.z << ' ' << p->offset;
        for (const auto& p : form.points) out << " (" << p.x << ' ' << p.y << ' ' << p.z << ')';
        out << " rotation " << body->rotation.w << ' ' << body->rotation.x << ' ' << body->rotation.y << ' '
            << body->rotation.z << " position " << body->position.x << ' ' << body->position.y << ' '
            << body->position.z;
    }
    return out.str();
}

}  // namespace clinch::test::campaign
