// What one narrow-phase call leaves for the next: of each pair the corners it was decided by.
#pragma once

#include <cstddef>
#include <memory>

namespace clinch {

/// Owned by the caller, filled by NarrowPhase. Bodies that have moved little since are then decided by the same corners
/// of boxes, capsules and hulls, and a look or two confirms it; without, each pair is searched from nothing. It is
/// never trusted: what no longer fits, other shapes or poses, costs time, not truth. 48 bytes a pair, on the host.
///
/// Answers are within their errors as ever, but their last digits, and those of pairs that lie within their error of
/// the margins, may depend on what is kept: the same calls in the same order give the same bytes on
/// the same device, and on any number of devices of its kind.
class WarmStart {
public:
    /// Nothing is kept.
    WarmStart();
    ~WarmStart();
    WarmStart(WarmStart&& other) noexcept;
    WarmStart& operator=(WarmStart&& other) noexcept;

    /// Forgets all pairs: the next call is one without.
    void clear() noexcept;
    /// Pairs that something is kept of.
    std::size_t size() const noexcept;

    /// The library's own view; not for users.
    struct Impl;
    Impl& impl() noexcept { return *impl_; }

private:
    std::unique_ptr<Impl> impl_;
};

}  // namespace clinch
