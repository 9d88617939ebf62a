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

/// Grows by chunks; made into Contacts at the end.
class ContactList {
public:
    void clear();
    /// Appends the contacts that were gathered: one each, or, with manifolds, their points.
    void append(const GatheredContacts& gathered, const ManifoldPoints* manifolds);
    /// Appends those that are hits; `manifolds` are those of the hits.
    void append(const std::vector<HostAnswer>& answers, const ManifoldPoints* manifolds);
    std::size_t size() const noexcept { return contacts_.size(); }
    /// Takes out those farther apart than the margins of their bodies and adds positions: now in world space.
    void finish(const Scene& scene, bool margins);
    View<const Contact> view() const noexcept { return contacts_; }
    std::uint64_t count_above(double tolerance) const;

private:
    template <class ContactAt>
    void append_all(std::size_t count, const ContactAt& contact_at, const ManifoldPoints* manifolds);
    std::vector<Contact> contacts_;  // on_a relative to a's position until finish()
};

}  // namespace clinch::detail
