// The result of a narrow-phase call.
#pragma once

#include <cstddef>

#include "clinch/aabb.hpp"
#include "clinch/contact.hpp"
#include "src/narrow_phase/chunk_contacts.hpp"
#include "src/narrow_phase/narrow_call.hpp"
#include "src/narrow_phase/row_list.hpp"

namespace clinch::detail {

/// Contacts, or only the pairs that touch.
struct NarrowResult {
    RowList<Contact> contacts;
    RowList<Pair> touching;

    void clear() noexcept {
        contacts.clear();
        touching.clear();
    }
    std::size_t size(bool only_pairs) const noexcept { return only_pairs ? touching.size() : contacts.size(); }
    void resize(bool only_pairs, std::size_t size) {
        if (only_pairs)
            touching.resize(size);
        else
            contacts.resize(size);
    }
    /// Writes what a chunk of the call has behind all there is, and releases it.
    void append(const NarrowCall& call, ChunkContacts& chunk) {
        if (call.only_pairs)
            chunk.write(touching.grow(chunk.count()));
        else
            chunk.write(call.scene, contacts.grow(chunk.count()));
        chunk.release();
    }
    /// Writes it from row `first` on; several threads at once: see RowList::write_at.
    void write_at(const NarrowCall& call, std::size_t first, std::size_t expected, ChunkContacts& chunk) {
        if (call.only_pairs)
            touching.write_at(first, chunk.count(), expected, [&](Pair* to) { chunk.write(to); });
        else
            contacts.write_at(first, chunk.count(), expected, [&](Contact* to) { chunk.write(call.scene, to); });
        chunk.release();
    }
};

}  // namespace clinch::detail
