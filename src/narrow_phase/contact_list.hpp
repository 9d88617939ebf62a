// The contacts of a call.
#pragma once

#include <cstdint>

#include "clinch/contact.hpp"
#include "clinch/scene.hpp"
#include "src/narrow_phase/row_list.hpp"

namespace clinch::detail {

/// In world space, in the order of the pairs.
using ContactList = RowList<Contact>;

/// Takes out those farther apart than the margins of their bodies.
void drop_beyond_margins(const Scene& scene, ContactList& contacts);
/// How many have an error above it.
std::uint64_t count_above(const ContactList& contacts, double tolerance);

}  // namespace clinch::detail
