#include "src/narrow_phase/chunk_contacts.hpp"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <utility>

#include "src/primitives/host_parallel.hpp"
#include "src/scene/scene_impl.hpp"

namespace clinch::detail {
namespace {

constexpr std::uint32_t rows_worth_threads = 4096;

// Writes the unused bytes behind it, too: contacts are the same to the byte, wherever they were found.
void set_feature(Contact& c, std::uint32_t feature) {
    unsigned char bytes[offsetof(Contact, on_a) - offsetof(Contact, feature)] = {};
    std::memcpy(bytes, &feature, sizeof feature);
    std::memcpy(reinterpret_cast<unsigned char*>(&c) + offsetof(Contact, feature), bytes, sizeof bytes);
}

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
        set_feature(c, 0);
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
class GatheredReader {
public:
    explicit GatheredReader(const GatheredContacts& from)
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
    set_feature(c, 0);
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
        set_feature(c, j > 0 && point.feature <= to[j - 1].feature ? to[j - 1].feature + 1 : point.feature);
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

std::size_t parts_of(std::size_t pairs) {
    return pairs == 0 ? 0 : (pairs - 1) / rows_worth_threads + 1;
}

// Calls body(part, begin, end) for each part of the pairs.
template <class Body>
void for_parts(std::size_t pairs, const Body& body) {
    const std::size_t parts = parts_of(pairs), per_part = parts == 0 ? 0 : (pairs - 1) / parts + 1;
    parallel_for(parts, parts > 1,
                 [&](std::size_t part) { body(part, part * per_part, std::min(pairs, (part + 1) * per_part)); });
}

template <class ContactAt>
void write_each(const Scene& scene, std::size_t count, const ContactAt& contact_at, Contact* to) {
    const std::vector<Vec3>& position = scene.impl().position;
    parallel_rows(count, rows_worth_threads, [&](std::size_t i) {
        Contact c = contact_at(i);
        place(position[c.a], c);
        std::memcpy(static_cast<void*>(to + i), &c, sizeof c);  // the unused bytes, too
    });
}

template <class ContactAt, class Points>
void write_points(const Scene& scene, const std::vector<std::size_t>& firsts, const ContactAt& contact_at,
                  const Points& points, Contact* to) {
    const std::vector<Vec3>& position = scene.impl().position;
    const std::size_t count = firsts.size() - 1;
    parallel_rows(count, rows_worth_threads, [&](std::size_t i) {
        const Contact whole = contact_at(i);
        put_points(whole, points_of(points, i), position[whole.a], to + firsts[i]);
    });
}

}  // namespace

std::vector<HostAnswer> answers_of(const GatheredContacts& gathered) {
    const GatheredReader from(gathered);
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

void ChunkContacts::take(View<const Pair> pairs, SlotAnswers answers) {
    release();
    firsts_.assign(parts_of(pairs.size()) + 1, 0);
    for_parts(pairs.size(), [&](std::size_t part, std::size_t begin, std::size_t end) {
        std::size_t hits = 0;
        for (std::size_t i = begin; i < end; ++i) hits += answers.is_hit(answers.slot_of(i)) ? 1U : 0U;
        firsts_[part + 1] = hits;
    });
    for (std::size_t part = 1; part < firsts_.size(); ++part) firsts_[part] += firsts_[part - 1];
    count_ = firsts_.back();
    from_ = InPlace{pairs, std::move(answers)};
}

void ChunkContacts::take(Mapping words, const GatheredContacts& gathered, Points points) {
    release();
    points_ = std::move(points);
    count_points(gathered.count);
    from_ = Gathered{std::move(words), gathered};
}

void ChunkContacts::take(std::vector<HostAnswer> answers, std::vector<FewPoints> points) {
    release();
    OnHost from{std::move(answers), {}};
    for (std::size_t i = 0; i < from.answers.size(); ++i)
        if (from.answers[i].hit) from.hits.push_back(i);
    if (!points.empty()) points_ = std::move(points);
    count_points(from.hits.size());
    from_ = std::move(from);
}

void ChunkContacts::release() {
    from_ = std::monostate();
    points_ = std::monostate();
    count_ = 0;
}

// The rows of so many contacts.
void ChunkContacts::count_points(std::size_t contacts) {
    count_ = contacts;
    const auto count = [&](const auto& points) {
        firsts_.assign(contacts + 1, 0);
        for (std::size_t i = 0; i < contacts; ++i) firsts_[i + 1] = firsts_[i] + count_of(points, i);
        count_ = firsts_.back();
    };
    if (const auto* on_device = std::get_if<DevicePoints>(&points_)) count(*on_device);
    if (const auto* on_host = std::get_if<std::vector<FewPoints>>(&points_)) count(*on_host);
}

template <class ContactAt>
void ChunkContacts::write_all(const Scene& scene, const ContactAt& contact_at, Contact* to) const {
    if (const auto* on_device = std::get_if<DevicePoints>(&points_))
        write_points(scene, firsts_, contact_at, *on_device, to);
    else if (const auto* on_host = std::get_if<std::vector<FewPoints>>(&points_))
        write_points(scene, firsts_, contact_at, *on_host, to);
    else
        write_each(scene, count_, contact_at, to);
}

void ChunkContacts::write_in_place(const Scene& scene, const InPlace& from, Contact* to) const {
    const SlotAnswers& answers = from.answers;
    const Columns columns(answers.columns.as<void>(), answers.stride);
    const std::vector<Vec3>& position = scene.impl().position;
    for_parts(from.pairs.size(), [&](std::size_t part, std::size_t begin, std::size_t end) {
        Contact* next = to + firsts_[part];
        for (std::size_t i = begin; i < end; ++i) {
            const std::size_t slot = answers.slot_of(i);
            if (!answers.is_hit(slot)) continue;
            const Pair pair = from.pairs[i];
            columns.read(slot, answers.rests && answers.is_float64(slot), position[pair.a], *next);
            next->a = pair.a;
            next->b = pair.b;
            ++next;
        }
    });
}

void ChunkContacts::write(const Scene& scene, Contact* to) const {
    if (const auto* in_place = std::get_if<InPlace>(&from_)) write_in_place(scene, *in_place, to);
    if (const auto* gathered = std::get_if<Gathered>(&from_)) {
        const GatheredReader from(gathered->contacts);
        write_all(
            scene, [&](std::size_t i) { return from.at(i); }, to);
    }
    if (const auto* on_host = std::get_if<OnHost>(&from_))
        write_all(
            scene, [&](std::size_t i) { return contact_of(on_host->answers[on_host->hits[i]]); }, to);
}

void ChunkContacts::write(Pair* to) const {
    if (const auto* in_place = std::get_if<InPlace>(&from_))
        for_parts(in_place->pairs.size(), [&](std::size_t part, std::size_t begin, std::size_t end) {
            Pair* next = to + firsts_[part];
            for (std::size_t i = begin; i < end; ++i)
                if (in_place->answers.is_hit(in_place->answers.slot_of(i))) *next++ = in_place->pairs[i];
        });
    if (const auto* gathered = std::get_if<Gathered>(&from_)) {
        const GatheredContacts& from = gathered->contacts;
        for (std::size_t i = 0; i < from.count; ++i) to[i] = {from.words[i], from.words[from.stride + i]};
    }
    if (const auto* on_host = std::get_if<OnHost>(&from_))
        for (std::size_t i = 0; i < on_host->hits.size(); ++i) {
            const HostAnswer& answer = on_host->answers[on_host->hits[i]];
            to[i] = {answer.a, answer.b};
        }
}

}  // namespace clinch::detail
