#include "bench/peers/narrow/judge.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace clinch::peers::narrow {
namespace {

double dot(const Vec3& a, const Vec3& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

/// Of unit length; what has no direction becomes no number, which no check lets pass.
Vec3 unit(const Vec3& v) {
    const double length = std::sqrt(dot(v, v));
    return {v.x / length, v.y / length, v.z / length};
}

Vec3 reversed(const Vec3& v) {
    return {-v.x, -v.y, -v.z};
}

/// Counts what is off by more than allowed. What is not a number is as wrong as can be.
void count(double off, double& worst, std::uint64_t& wrong) {
    if (std::isnan(off)) off = std::numeric_limits<double>::infinity();
    worst = std::max(worst, off);
    if (off > right_within) ++wrong;
}

/// What a pair's bodies take up along a direction.
struct Slab {
    double top_of_a, bottom_of_b;
};

Slab slab_of(const Batch& batch, std::size_t pair, const Vec3& n) {
    return {highest(batch, 2 * pair, n), -highest(batch, 2 * pair + 1, reversed(n))};
}

void judge_contact(const Batch& batch, std::size_t pair, const Answer& answer, Verdict& verdict) {
    const double size = batch.size[pair];
    const Truth& truth = batch.truth[pair];
    const Slab along_normal = slab_of(batch, pair, unit(answer.normal));
    count((truth.distance - (along_normal.bottom_of_b - along_normal.top_of_a)) / size, verdict.worst_normal,
          verdict.wrong_normal);
    const Slab shared = slab_of(batch, pair, truth.normal);
    const double at = dot(truth.normal, answer.point);
    const double outside = std::max(at - shared.top_of_a, shared.bottom_of_b - at);
    count(outside > 0.0 ? outside / size : (std::isnan(at) ? at : 0.0), verdict.worst_point, verdict.wrong_point);
}

void judge_distance(const Batch& batch, std::size_t pair, const Answer& answer, Verdict& verdict) {
    const double size = batch.size[pair];
    const Vec3 between{answer.other.x - answer.point.x, answer.other.y - answer.point.y,
                       answer.other.z - answer.point.z};
    const bool has_normal = dot(answer.normal, answer.normal) > 0.0;
    const Vec3 n = unit(has_normal ? answer.normal : between);
    const Slab slab = slab_of(batch, pair, n);
    count((batch.truth[pair].distance - (slab.bottom_of_b - slab.top_of_a)) / size, verdict.worst_normal,
          verdict.wrong_normal);
    // fmax would pass over what is not a number.
    const double off_a = std::fabs(dot(n, answer.point) - slab.top_of_a);
    const double off_b = std::fabs(dot(n, answer.other) - slab.bottom_of_b);
    count((std::isnan(off_a) || off_a > off_b ? off_a : off_b) / size, verdict.worst_point, verdict.wrong_point);
}

}  // namespace

Verdict judge(const Batch& batch, Question question, const std::vector<Answer>& answers) {
    if (answers.size() != batch.pairs()) throw std::runtime_error("not one answer a pair");
    Verdict verdict;
    for (std::size_t i = 0; i < answers.size(); ++i) {
        const Answer& answer = answers[i];
        const double truth = batch.truth[i].distance, size = batch.size[i];
        if (!answer.given) {
            ++verdict.missing;
            continue;
        }
        if (answer.touching != (truth <= 0.0) && std::fabs(truth) > right_within * size) {
            ++verdict.wrong_touching;
            continue;
        }
        // Answers of the other kind have nothing to judge; they are right since the bodies all but touch.
        if (question == Question::Touching || answer.touching != (question == Question::Contact)) continue;
        count(std::fabs(answer.distance - truth) / size, verdict.worst_distance, verdict.wrong_distance);
        if (question == Question::Contact)
            judge_contact(batch, i, answer, verdict);
        else
            judge_distance(batch, i, answer, verdict);
    }
    return verdict;
}

}  // namespace clinch::peers::narrow
