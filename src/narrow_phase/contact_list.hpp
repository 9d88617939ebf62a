// The contacts of a call, as columns on the host.
#pragma once

#include <cstdint>
#include <vector>

#include "clinch/contact.hpp"
#include "clinch/scene.hpp"
#include "src/narrow_phase/slots.hpp"

namespace clinch::detail {

/// Grows by chunks; made into Contacts at the end.
class ContactList {
public:
    void clear();
    /// Appends the `count` contacts that were gathered into `columns`, each `stride` long; see Slots::gather.
    void append(const std::uint32_t* columns, std::uint64_t stride, std::uint32_t count, bool rests);
    /// Appends those that are hits.
    void append(const std::vector<HostAnswer>& answers);
    std::size_t size() const noexcept { return contacts_.size(); }
    /// Takes out those farther apart than the margins of their bodies and adds positions: now in world space.
    void finish(const Scene& scene, bool margins);
    View<const Contact> view() const noexcept { return contacts_; }
    std::uint64_t count_above(double tolerance) const;

private:
    std::vector<Contact> contacts_;  // on_a relative to a's position until finish()
};

}  // namespace clinch::detail
