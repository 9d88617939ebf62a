// The contacts of one chunk of pairs: counted first, then written to where they belong.
#pragma once

#include <cstddef>
#include <cstdint>
#include <variant>
#include <vector>

#include "clinch/aabb.hpp"
#include "clinch/contact.hpp"
#include "clinch/scene.hpp"
#include "clinch/view.hpp"
#include "src/device/device.hpp"
#include "src/narrow_phase/manifolds.hpp"
#include "src/narrow_phase/slots.hpp"

namespace clinch::detail {

/// Contacts as Slots::gather left them, read back: columns, each `stride` long.
struct GatheredContacts {
    const std::uint32_t* words = nullptr;
    std::uint64_t stride = 0;
    std::uint32_t count = 0;
    bool rests = false;
};
/// The same as answers, all of them hits.
std::vector<HostAnswer> answers_of(const GatheredContacts& gathered);

/// Holds the answers where they lie, until the next chunk or release(). One thread at a time.
class ChunkContacts {
public:
    /// Takes the hits among the answers of `pairs`, which must stay where they are. Counts them.
    void take(View<const Pair> pairs, SlotAnswers answers);
    /// Takes the contacts that were gathered, or, if there are any, their points, as many as there are contacts.
    using Points = std::variant<std::monostate, DevicePoints, std::vector<FewPoints>>;
    void take(Mapping words, const GatheredContacts& gathered, Points points);
    /// Takes those answers that are hits, or, if there are any, the hits' points.
    void take(std::vector<HostAnswer> answers, std::vector<FewPoints> points);
    /// Holds nothing any more.
    void release();

    /// Rows that write() writes.
    std::size_t count() const noexcept { return count_; }
    /// Writes the contacts, in world space, in the order of the pairs; those of a pair by ascending features of which
    /// no two are equal. Several threads for many.
    void write(const Scene& scene, Contact* to) const;
    /// Writes only the pairs of the hits; where there are points, this may not be asked for.
    void write(Pair* to) const;

private:
    struct InPlace {
        View<const Pair> pairs;
        SlotAnswers answers;
    };
    struct Gathered {
        Mapping words;
        GatheredContacts contacts;
    };
    struct OnHost {
        std::vector<HostAnswer> answers;
        std::vector<std::size_t> hits;
    };
    void count_points(std::size_t contacts);
    void write_in_place(const Scene& scene, const InPlace& from, Contact* to) const;
    template <class ContactAt>
    void write_all(const Scene& scene, const ContactAt& contact_at, Contact* to) const;

    std::variant<std::monostate, InPlace, Gathered, OnHost> from_;
    Points points_;
    std::size_t count_ = 0;
    std::vector<std::size_t> firsts_;  // of each part of the pairs, or contact that has points, its first row; the end
};

}  // namespace clinch::detail
