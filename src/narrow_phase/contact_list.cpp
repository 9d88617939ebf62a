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
    Columns(const std::uint32_t* words, std::uint64_t stride, bool rests)
        : words_(words), stride_(stride), rests_(rests) {}

    Contact at(std::size_t i) const {
        Contact c;
        c.a = words_[i];
        c.b = words_[stride_ + i];
        c.distance = number(0, 0, i);
        c.error = static_cast<double>(real(1, i));
        c.normal = {number(2, 1, i), number(3, 2, i), number(4, 3, i)};
        c.on_a = {number(5, 4, i), number(6, 5, i), number(7, 6, i)};
        return c;
    }

private:
    float real(std::size_t column, std::size_t i) const {
        float x = 0.0f;
        std::memcpy(&x, words_ + (2 + column) * stride_ + i, sizeof x);
        return x;
    }
    double number(std::size_t column, std::size_t rest, std::size_t i) const {
        const auto high = static_cast<double>(real(column, i));
        return rests_ ? high + static_cast<double>(real(answer_columns + rest, i)) : high;
    }
    const std::uint32_t* words_;
    std::uint64_t stride_;
    bool rests_;
};

}  // namespace

void ContactList::clear() {
    contacts_.clear();
}

void ContactList::append(const std::uint32_t* columns, std::uint64_t stride, std::uint32_t count, bool rests) {
    const std::size_t before = contacts_.size();
    contacts_.resize(before + count);
    const Columns from(columns, stride, rests);
    const auto end = static_cast<std::ptrdiff_t>(count);
#pragma omp parallel for schedule(static) if (count >= rows_worth_threads)
    for (std::ptrdiff_t i = 0; i < end; ++i) {
        const auto at = static_cast<std::size_t>(i);
        contacts_[before + at] = from.at(at);
    }
}

void ContactList::append(const std::vector<HostAnswer>& answers) {
    for (const HostAnswer& answer : answers) {
        if (!answer.hit) continue;
        Contact c;
        c.a = answer.a;
        c.b = answer.b;
        c.distance = answer.distance;
        c.error = answer.error;
        c.normal = {answer.normal[0], answer.normal[1], answer.normal[2]};
        c.on_a = {answer.point[0], answer.point[1], answer.point[2]};
        contacts_.push_back(c);
    }
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
