#include "src/narrow_phase/contact_list.hpp"

#include <algorithm>
#include <vector>

#include "src/scene/scene_impl.hpp"

namespace clinch::detail {

void drop_beyond_margins(const Scene& scene, ContactList& contacts) {
    const std::vector<double>& margin = scene.impl().margin;
    contacts.drop_if([&](const Contact& c) { return c.distance - c.error > margin[c.a] + margin[c.b]; });
}

std::uint64_t count_above(const ContactList& contacts, double tolerance) {
    const View<const Contact> all = contacts.view();
    return static_cast<std::uint64_t>(
        std::count_if(all.begin(), all.end(), [&](const Contact& c) { return c.error > tolerance; }));
}

}  // namespace clinch::detail
