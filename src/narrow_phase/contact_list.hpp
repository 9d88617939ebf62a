// The contacts of a call, as columns on the host.
#pragma once

#include <cstdint>
#include <vector>

#include "clinch/contact.hpp"
#include "clinch/scene.hpp"
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

/// Grows by chunks. In world space.
class ContactList {
public:
    void clear() noexcept { size_ = 0; }
    /// Appends the contacts that were gathered.
    void append(const Scene& scene, const GatheredContacts& gathered);
    /// Appends the hits among the answers of `pairs`.
    void append(const Scene& scene, View<const Pair> pairs, const SlotAnswers& answers);
    /// Appends their points instead, those of each by ascending features of which no two are equal.
    void append(const Scene& scene, const GatheredContacts& gathered, const DevicePoints& points);
    void append(const Scene& scene, const GatheredContacts& gathered, const std::vector<FewPoints>& points);
    /// Appends those answers that are hits, or, if there are any, the hits' points.
    void append(const Scene& scene, const std::vector<HostAnswer>& answers, const std::vector<FewPoints>& points);
    std::size_t size() const noexcept { return size_; }
    /// Takes out those farther apart than the margins of their bodies.
    void drop_beyond_margins(const Scene& scene);
    View<const Contact> view() const noexcept { return {contacts_.data(), size_}; }
    std::uint64_t count_above(double tolerance) const;

private:
    Contact* grow(std::size_t by);
    template <class ContactAt>
    void append_each(const Scene& scene, std::size_t count, const ContactAt& contact_at);
    template <class ContactAt, class Points>
    void append_points(const Scene& scene, std::size_t count, const ContactAt& contact_at, const Points& points);
    std::vector<Contact> contacts_;  // as long as the longest list was: what is behind size_ is old
    std::size_t size_ = 0;
    std::vector<std::size_t> firsts_;  // of each contact its first point
};

}  // namespace clinch::detail
