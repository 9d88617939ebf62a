#include "src/narrow_phase/contact_list.hpp"

#include <algorithm>
#include <cstring>

#include "src/scene/scene_impl.hpp"

namespace clinch::detail {
namespace {

constexpr std::uint32_t rows_worth_threads = 4096;

// Answers in columns, each `stride` floats long, those of float64 with what the floats leave over.
class Columns {
public:
    Columns(const void* columns, std::uint64_t stride)
        : columns_(static_cast<const unsigned char*>(columns)), stride_(stride) {}

    /// That of row i, but for the bodies' numbers; its points from `origin`.
    void read(std::size_t i, bool rests, const Vec3& origin, Contact& c) const {
        const double distance = number(0, 0, i, rests);
        const double nx = number(2, 1, i, rests), ny = number(3, 2, i, rests), nz = number(4, 3, i, rests);
        const double x = origin.x + number(5, 4, i, rests), y = origin.y + number(6, 5, i, rests),
                     z = origin.z + number(7, 6, i, rests);
        // One number after the other: a struct that is copied would wait for each of its halves.
        c.feature = 0;
        c.on_a.x = x;
        c.on_a.y = y;
        c.on_a.z = z;
        c.on_b.x = x + distance * nx;
        c.on_b.y = y + distance * ny;
        c.on_b.z = z + distance * nz;
        c.normal.x = nx;
        c.normal.y = ny;
        c.normal.z = nz;
        c.distance = distance;
        c.error = static_cast<double>(real(1, i));
    }

private:
    float real(std::size_t column, std::size_t i) const {
        float x = 0.0f;
        std::memcpy(&x, columns_ + (column * stride_ + i) * sizeof x, sizeof x);
        return x;
    }
    double number(std::size_t column, std::size_t rest, std::size_t i, bool rests) const {
        const auto high = static_cast<double>(real(column, i));
        return rests ? high + static_cast<double>(real(answer_columns + rest, i)) : high;
    }
    const unsigned char* columns_;
    std::uint64_t stride_;
};

// The contacts that Slots::gather left.
class Gathered {
public:
    explicit Gathered(const GatheredContacts& from)
        : from_(from), columns_(from.words + 2 * from.stride, from.stride) {}
    /// From a's position.
    Contact at(std::size_t i) const {
        Contact c;
        columns_.read(i, from_.rests, {-0.0, -0.0, -0.0}, c);  // what is added to -0 stays as it is
        c.a = from_.words[i];
        c.b = from_.words[from_.stride + i];
        return c;
    }

private:
    GatheredContacts from_;
    Columns columns_;
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

std::size_t count_of(const DevicePoints& points, std::size_t i) {
    return points.count(i);
}
std::size_t count_of(const std::vector<FewPoints>& points, std::size_t i) {
    return points[i].count;
}
FewPoints points_of(const DevicePoints& points, std::size_t i) {
    return points.at(i);
}
const FewPoints& points_of(const std::vector<FewPoints>& points, std::size_t i) {
    return points[i];
}

// From a's position to world space.
void place(const Vec3& position, Contact& c) {
    c.on_a.x += position.x;
    c.on_a.y += position.y;
    c.on_a.z += position.z;
    c.on_b.x = c.on_a.x + c.distance * c.normal.x;
    c.on_b.y = c.on_a.y + c.distance * c.normal.y;
    c.on_b.z = c.on_a.z + c.distance * c.normal.z;
}

// Numbers of the points, by features.
struct PointOrder {
    std::uint32_t at[most_points];

    explicit PointOrder(const FewPoints& few) {
        for (std::uint32_t k = 0; k < few.count; ++k) {
            std::uint32_t to = k;
            for (; to > 0 && few.points[at[to - 1]].feature > few.points[k].feature; --to) at[to] = at[to - 1];
            at[to] = k;
        }
    }
};

// Writes the points of a contact, number by number.
void put_points(const Contact& whole, const FewPoints& few, const Vec3& position, Contact* to) {
    const PointOrder order(few);
    for (std::uint32_t j = 0; j < few.count; ++j) {
        const std::uint32_t k = order.at[j];
        const ManifoldPoint& point = few.points[k];
        const bool deepest = k == few.deepest, witness = deepest && few.is_witness;
        Contact& c = to[j];
        c.a = whole.a;
        c.b = whole.b;
        // Numbers of vertices beyond what a name has room for come round again.
        c.feature = j > 0 && point.feature <= to[j - 1].feature ? to[j - 1].feature + 1 : point.feature;
        c.on_a.x = witness ? whole.on_a.x : point.on_a[0];
        c.on_a.y = witness ? whole.on_a.y : point.on_a[1];
        c.on_a.z = witness ? whole.on_a.z : point.on_a[2];
        c.normal.x = whole.normal.x;
        c.normal.y = whole.normal.y;
        c.normal.z = whole.normal.z;
        c.distance = deepest ? whole.distance : point.distance;
        c.error = deepest ? whole.error : point.error;
        place(position, c);
    }
}

}  // namespace

std::vector<HostAnswer> answers_of(const GatheredContacts& gathered) {
    const Gathered from(gathered);
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

Contact* ContactList::grow(std::size_t by) {
    const std::size_t before = size_;
    size_ += by;
    if (contacts_.size() < size_) contacts_.resize(std::max(size_, contacts_.size() + contacts_.size() / 2));
    return contacts_.data() + before;
}

template <class ContactAt>
void ContactList::append_each(const Scene& scene, std::size_t count, const ContactAt& contact_at) {
    Contact* const to = grow(count);
    const std::vector<Vec3>& position = scene.impl().position;
    const auto end = static_cast<std::ptrdiff_t>(count);
#pragma omp parallel for schedule(static) if (count >= rows_worth_threads)
    for (std::ptrdiff_t i = 0; i < end; ++i) {
        const auto at = static_cast<std::size_t>(i);
        Contact c = contact_at(at);
        place(position[c.a], c);
        to[at] = c;
    }
}

template <class ContactAt, class Points>
void ContactList::append_points(const Scene& scene, std::size_t count, const ContactAt& contact_at,
                                const Points& points) {
    firsts_.resize(count);
    std::size_t total = 0;
    for (std::size_t i = 0; i < count; ++i) {
        firsts_[i] = total;
        total += count_of(points, i);
    }
    Contact* const list = grow(total);
    const std::vector<Vec3>& position = scene.impl().position;
    const auto end = static_cast<std::ptrdiff_t>(count);
#pragma omp parallel for schedule(static) if (count >= rows_worth_threads)
    for (std::ptrdiff_t i = 0; i < end; ++i) {
        const auto at = static_cast<std::size_t>(i);
        const Contact whole = contact_at(at);
        put_points(whole, points_of(points, at), position[whole.a], list + firsts_[at]);
    }
}

void ContactList::append(const Scene& scene, const GatheredContacts& gathered) {
    const Gathered from(gathered);
    append_each(scene, gathered.count, [&](std::size_t i) { return from.at(i); });
}

void ContactList::append(const Scene& scene, View<const Pair> pairs, const SlotAnswers& answers) {
    const Columns columns(answers.columns.as<void>(), answers.stride);
    const std::vector<Vec3>& position = scene.impl().position;
    const std::size_t parts = (pairs.size() - 1) / rows_worth_threads + 1, per_part = (pairs.size() - 1) / parts + 1;
    const auto end_of = [&](std::size_t part) { return std::min(pairs.size(), (part + 1) * per_part); };
    firsts_.assign(parts + 1, 0);
    const auto last = static_cast<std::ptrdiff_t>(parts);
#pragma omp parallel for schedule(static) if (parts > 1)
    for (std::ptrdiff_t p = 0; p < last; ++p) {
        const auto part = static_cast<std::size_t>(p);
        std::size_t hits = 0;
        for (std::size_t i = part * per_part; i < end_of(part); ++i)
            hits += answers.is_hit(answers.slot_of(i)) ? 1U : 0U;
        firsts_[part + 1] = hits;
    }
    for (std::size_t part = 0; part < parts; ++part) firsts_[part + 1] += firsts_[part];
    Contact* const list = grow(firsts_[parts]);
#pragma omp parallel for schedule(static) if (parts > 1)
    for (std::ptrdiff_t p = 0; p < last; ++p) {
        const auto part = static_cast<std::size_t>(p);
        Contact* to = list + firsts_[part];
        for (std::size_t i = part * per_part; i < end_of(part); ++i) {
            const std::size_t slot = answers.slot_of(i);
            if (!answers.is_hit(slot)) continue;
            const Pair pair = pairs[i];
            columns.read(slot, answers.rests && answers.is_float64(slot), position[pair.a], *to);
            to->a = pair.a;
            to->b = pair.b;
            ++to;
        }
    }
}

void ContactList::append(const Scene& scene, const GatheredContacts& gathered, const DevicePoints& points) {
    const Gathered from(gathered);
    append_points(
        scene, gathered.count, [&](std::size_t i) { return from.at(i); }, points);
}

void ContactList::append(const Scene& scene, const GatheredContacts& gathered, const std::vector<FewPoints>& points) {
    const Gathered from(gathered);
    append_points(
        scene, gathered.count, [&](std::size_t i) { return from.at(i); }, points);
}

void ContactList::append(const Scene& scene, const std::vector<HostAnswer>& answers,
                         const std::vector<FewPoints>& points) {
    std::vector<std::size_t> hits;
    for (std::size_t i = 0; i < answers.size(); ++i)
        if (answers[i].hit) hits.push_back(i);
    const auto contact_at = [&](std::size_t i) { return contact_of(answers[hits[i]]); };
    if (points.empty())
        append_each(scene, hits.size(), contact_at);
    else
        append_points(scene, hits.size(), contact_at, points);
}

void ContactList::drop_beyond_margins(const Scene& scene) {
    const std::vector<double>& margin = scene.impl().margin;
    Contact* const begin = contacts_.data();
    size_ = static_cast<std::size_t>(
        std::remove_if(begin, begin + size_,
                       [&](const Contact& c) { return c.distance - c.error > margin[c.a] + margin[c.b]; }) -
        begin);
}

std::uint64_t ContactList::count_above(double tolerance) const {
    const View<const Contact> all = view();
    return static_cast<std::uint64_t>(
        std::count_if(all.begin(), all.end(), [&](const Contact& c) { return c.error > tolerance; }));
}

}  // namespace clinch::detail
