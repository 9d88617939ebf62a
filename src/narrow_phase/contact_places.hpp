// Where the rows of each chunk belong in the whole result.
#pragma once

#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>
#include <vector>

namespace clinch::detail {

/// A chunk's rows come behind those of all chunks before it. Told in any order, by several threads; none waits for
/// another.
class ContactPlaces {
public:
    explicit ContactPlaces(std::uint32_t chunks) : rows_(chunks, unknown), firsts_(chunks, unknown) {}

    /// A chunk has so many rows. Once a chunk.
    void tell(std::uint32_t chunk, std::size_t rows);
    /// Its first row; nullopt while not all chunks before it have told theirs.
    std::optional<std::size_t> first_of(std::uint32_t chunk) const;
    /// Rows of all that have told.
    std::size_t told() const;
    /// How many there will be of all chunks, if those that have not told have as many each. 0 before the first.
    std::size_t expected() const;

private:
    static constexpr std::size_t unknown = static_cast<std::size_t>(-1);

    mutable std::mutex mutex_;
    std::vector<std::size_t> rows_, firsts_;
    std::size_t known_ = 0;       // chunks before this one have their place
    std::size_t known_rows_ = 0;  // and so many rows
    std::size_t told_ = 0, told_chunks_ = 0;
};

}  // namespace clinch::detail
