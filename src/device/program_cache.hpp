// Compiled kernels on disk, so that a second run compiles nothing.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace clinch::detail {

/// Binaries by key, one file each. The key is whatever decides the binary (source, options, device,
/// driver and platform version) as one text; the file's name is a hash of it and the whole key stands
/// in the file, so two keys never share an entry. Files appear by atomic rename: several
/// programs may use one folder. A folder that cannot be used costs speed, never a result.
class ProgramCache {
public:
    using Log = std::function<void(const std::string&)>;
    /// An empty folder turns the cache off.
    ProgramCache(std::string folder, Log log);

    /// The binary stored for `key`, if there is one. A damaged entry is logged and deleted.
    std::optional<std::vector<unsigned char>> load(const std::string& key) const;
    void store(const std::string& key, const std::vector<unsigned char>& binary) const;
    /// Deletes the entry, after the driver refused it; `why` goes to the log.
    void discard(const std::string& key, const std::string& why) const;
    /// The file of a key.
    std::string path(const std::string& key) const;

private:
    void log(const std::string& line) const;
    std::string folder_;
    Log log_;
};

/// `clinch` in the user's cache folder (XDG_CACHE_HOME, else ~/.cache); empty when neither is known.
std::string default_cache_folder();

}  // namespace clinch::detail
