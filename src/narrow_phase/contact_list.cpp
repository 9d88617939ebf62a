#include "src/narrow_phase/contact_list.hpp"

#include <algorithm>
#include <cstring>

#include "src/scene/scene_impl.hpp"

namespace clinch::detail {
namespace {

constexpr std::uint32_t rows_worth_threads = 4096;

// One contact out of columns.
class Columns {
public:
    explicit Columns(const GatheredContacts& from) : from_(from) {}

    Contact at(std::size_t i) const {
        Contact c;
        c.a = from_.words[i];
        c.b = from_.words[from_.stride + i];
        c.distance = number(0, 0, i);
        c.error = static_cast<double>(real(1, i));
        c.normal = {number(2, 1, i), number(3, 2, i), number(4, 3, i)};
        c.on_a = {number(5, 4, i), number(6, 5, i), number(7, 6, i)};
        return c;
    }

private:
    float real(std::size_t column, std::size_t i) const {
        float x = 0.0f;
        std::memcpy(&x, from_.words + (2 + column) * from_.stride + i, sizeof x);
        return x;
    }
    double number(std::size_t column, std::size_t rest, std::size_t i) const {
        const auto high = static_cast<double>(real(column, i));
        return from_.rests ? high + static_cast<double>(real(answer_columns + rest, i)) : high;
    }
    GatheredContacts from_;
};

Contact contact_of(const HostAnswer& answer) {
    Contact c;
    c.a = answer.a;
    c.b = answer.b;
    c.distance = answer.distance;
    c.error = answer.error;
    c.normal = {answer.normal[0], answer.normal[1], answer.normal[2]};
    c.on_a = {answer.point[0], answer.point[1], answer.point[2]};
    return c;
}

}  // namespace

std::vector<HostAnswer> answers_of(const GatheredContacts& gathered) {
    const Columns from(gathered);
    std::vector<HostAnswer> answers;
    answers.reserve(gathered.count);
    for (std::size_t i = 0; i < gathered.count; ++i) {
        const Contact c = from.at(i);
        answers.push_back({c.a,
                           c.b,
                           c.distance,
                           c.error,
                           {c.normal.x, c.normal.y, c.normal.z},
                           {c.on_a.x, c.on_a.y, c.on_a.z},
                           true});
    }
    return answers;
}

void ContactList::clear() {
    contacts_.clear();
}

template <class ContactAt>
void ContactList::append_all(std::size_t count, const ContactAt& contact_at, const ManifoldPoints* manifolds) {
    const std::size_t before = contacts_.size();
    contacts_.resize(before + (manifolds ? manifolds->points.size() : count));
    Contact* const to = contacts_.data() + before;
    const auto end = static_cast<std::ptrdiff_t>(count);
#pragma omp parallel for schedule(static) if (count >= rows_worth_threads)
    for (std::ptrdiff_t i = 0; i < end; ++i) {
        const auto at = static_cast<std::size_t>(i);
        Contact c = contact_at(at);
        if (manifolds == nullptr) {
            to[at] = c;
            continue;
        }
        for (std::size_t k = manifolds->firsts[at]; k < manifolds->firsts[at + 1]; ++k) {
            const ManifoldPoint& point = manifolds->points[k];
            c.feature = point.feature;
            c.on_a = {point.on_a[0], point.on_a[1], point.on_a[2]};
            c.distance = point.distance;
            c.error = point.error;
            to[k] = c;
        }
    }
}

void ContactList::append(const GatheredContacts& gathered, const ManifoldPoints* manifolds) {
    const Columns from(gathered);
    append_all(
        gathered.count, [&](std::size_t i) { return from.at(i); }, manifolds);
}

void ContactList::append(const std::vector<HostAnswer>& answers, const ManifoldPoints* manifolds) {
    std::vector<std::size_t> hits;
    for (std::size_t i = 0; i < answers.size(); ++i)
        if (answers[i].hit) hits.push_back(i);
    append_all(
        hits.size(), [&](std::size_t i) { return contact_of(answers[hits[i]]); }, manifolds);
}

void ContactList::finish(const Scene& scene, bool margins) {
    const Scene::Impl& s = scene.impl();
    if (margins)
        contacts_.erase(
            std::remove_if(contacts_.begin(), contacts_.end(),
                           [&](const Contact& c) { return c.distance - c.error > s.margin[c.a] + s.margin[c.b]; }),
            contacts_.end());
    const auto end = static_cast<std::ptrdiff_t>(contacts_.size());
#pragma omp parallel for schedule(static) if (contacts_.size() >= rows_worth_threads)
    for (std::ptrdiff_t i = 0; i < end; ++i) {
        Contact& c = contacts_[static_cast<std::size_t>(i)];
        const Vec3& p = s.position[c.a];
        c.on_a = {p.x + c.on_a.x, p.y + c.on_a.y, p.z + c.on_a.z};
        c.on_b = {c.on_a.x + c.distance * c.normal.x, c.on_a.y + c.distance * c.normal.y,
                  c.on_a.z + c.distance * c.normal.z};
    }
}

std::uint64_t ContactList::count_above(double tolerance) const {
    return static_cast<std::uint64_t>(
        std::count_if(contacts_.begin(), contacts_.end(), [&](const Contact& c) { return c.error > tolerance; }));
}

}  // namespace clinch::detail
