// JSON with the checks that a format needs: every value knows its place, for messages.
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "clinch/pose.hpp"

namespace clinch::io {

/// Reads a JSON file. A syntax error, a NaN or infinity token, a number beyond float64's range, or a key
/// that stands twice in one object is InputError, which names the line or the key's place.
nlohmann::json read_json(const std::string& path);

/// One value of a JSON document, read with checks; each failure is InputError that names the file and
/// the value's place ("bodies[3].shape"), what was found and what is accepted. Points to the value
/// above it: both that and the document must outlive it.
class JsonValue {
public:
    /// The whole document; `file` is named in messages.
    JsonValue(const nlohmann::json& json, const std::string& file) : json_(&json), file_(&file) {}

    /// "scene.json: bodies[3].shape WHAT", thrown.
    [[noreturn]] void fail(const std::string& what) const;
    /// "scene.json: bodies[3].shape".
    std::string place() const;

    bool is_object() const noexcept { return json_->is_object(); }
    bool is_array() const noexcept { return json_->is_array(); }
    /// Elements of an array, entries of an object.
    std::size_t size() const noexcept { return json_->size(); }
    const nlohmann::json& json() const noexcept { return *json_; }
    const std::string& file() const noexcept { return *file_; }

    /// Fails unless this is an object whose keys are all among `keys`.
    void only_keys(std::initializer_list<const char*> keys) const;
    bool has(const char* key) const { return json_->contains(key); }
    /// The entry `key` of an object; a missing one fails. `key` must outlive the result.
    JsonValue at(const char* key) const;
    /// Element `index` of an array; index < size().
    JsonValue at(std::size_t index) const;

    double number() const;
    /// A whole number written without a fraction, in [0, highest].
    std::uint64_t whole(std::uint64_t highest) const;
    std::string text() const;
    /// Fails unless this is an array.
    void require_array() const;
    /// An array of three numbers, x y z.
    Vec3 vec3() const;
    /// An array of four numbers, w x y z.
    Quat quat() const;

private:
    JsonValue(const nlohmann::json& json, const JsonValue& above, const char* key, std::size_t index)
        : json_(&json), file_(above.file_), above_(&above), key_(key), index_(index) {}
    std::string path() const;
    std::string found() const;
    double element(std::size_t index) const;

    const nlohmann::json* json_;
    const std::string* file_;
    const JsonValue* above_ = nullptr;
    const char* key_ = nullptr;  // null: an array's element
    std::size_t index_ = 0;
};

}  // namespace clinch::io
