#include "tools/io/json_value.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "tools/io/error.hpp"
#include "tools/io/input_file.hpp"
#include "tools/io/text.hpp"

namespace clinch::io {
namespace {

using nlohmann::json;

/// A parser's message without the library's own tag in front.
std::string plain(const std::string& message) {
    const std::size_t end = message.find("] ");
    return message.front() == '[' && end != std::string::npos ? message.substr(end + 2) : message;
}

/// Builds the document as it is parsed and refuses a key that stands twice in one object. (The library's
/// own parser keeps the last such value in silence; its filter callback could see both, but searches the
/// whole list around an object at the object's end.)
class Builder final : public nlohmann::json_sax<json> {
public:
    Builder(const std::string& file, json& root) : file_(file), root_(root) {}

    bool null() override { return add(nullptr); }
    bool boolean(bool value) override { return add(value); }
    bool number_integer(number_integer_t value) override { return add(value); }
    bool number_unsigned(number_unsigned_t value) override { return add(value); }
    bool number_float(number_float_t value, const string_t&) override { return add(value); }
    bool string(string_t& value) override { return add(std::move(value)); }
    bool binary(binary_t& value) override { return add(std::move(value)); }
    bool start_object(std::size_t) override { return open(json::object()); }
    bool start_array(std::size_t) override { return open(json::array()); }
    bool end_object() override { return close(); }
    bool end_array() override { return close(); }

    bool key(string_t& name) override {
        Level& level = open_.back();
        const auto [entry, added] = level.value->get_ref<json::object_t&>().try_emplace(name);
        level.entry = &*entry;
        if (!added) throw InputError(file_ + ": " + place() + " stands twice; once is accepted");
        return true;
    }

    bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception& e) override {
        throw InputError(file_ + ": is no JSON document: " + plain(e.what()));
    }

private:
    /// An object or list that is not yet closed. No list around it grows meanwhile: pointers stay.
    struct Level {
        json* value;
        json::object_t::value_type* entry;  // of an object: the one being read
    };

    template <class Value>
    json* put(Value&& value) {
        if (open_.empty()) return &(root_ = std::forward<Value>(value));
        Level& level = open_.back();
        if (level.value->is_array()) return &level.value->emplace_back(std::forward<Value>(value));
        return &(level.entry->second = std::forward<Value>(value));
    }
    template <class Value>
    bool add(Value&& value) {
        put(std::forward<Value>(value));
        return true;
    }
    bool open(json&& value) {
        open_.push_back({put(std::move(value)), nullptr});
        return true;
    }
    bool close() {
        open_.pop_back();
        return true;
    }
    std::string place() const {
        std::string path;
        for (const Level& level : open_)
            path += level.value->is_array() ? "[" + std::to_string(level.value->size() - 1) + "]"
                                            : (path.empty() ? "" : ".") + level.entry->first;
        return path;
    }

    const std::string& file_;
    json& root_;
    std::vector<Level> open_;
};

}  // namespace

json read_json(const std::string& path) {
    const std::string text = read_text(path);
    json document;
    Builder builder(path, document);
    json::sax_parse(text, &builder);
    return document;
}

std::string JsonValue::path() const {
    if (above_ == nullptr) return {};
    const std::string above = above_->path();
    if (key_ == nullptr) return above + "[" + std::to_string(index_) + "]";
    return above + (above.empty() ? "" : ".") + key_;
}

std::string JsonValue::place() const {
    const std::string inner = path();
    return *file_ + ": " + (inner.empty() ? "the document" : inner);
}

void JsonValue::fail(const std::string& what) const {
    throw InputError(place() + " " + what);
}

std::string JsonValue::found() const {
    if (json_->is_object()) return "is an object";
    if (json_->is_array()) return "is a list of " + std::to_string(json_->size());
    const std::string text = json_->dump(-1, ' ', true, json::error_handler_t::replace);
    return "is " + (text.size() > 60 ? text.substr(0, 60) + "..." : text);
}

void JsonValue::only_keys(std::initializer_list<const char*> keys) const {
    const auto accepted = [&] {
        return join({keys.begin(), keys.end()}) + (keys.size() > 1 ? " are accepted" : " is accepted");
    };
    if (!json_->is_object()) fail(found() + "; an object with keys among " + accepted());
    for (const auto& [key, value] : json_->get_ref<const json::object_t&>()) {
        if (std::find(keys.begin(), keys.end(), key) != keys.end()) continue;
        JsonValue(value, *this, key.c_str(), 0).fail("is no known key; " + accepted());
    }
}

JsonValue JsonValue::at(const char* key) const {
    if (!json_->is_object()) fail(found() + "; an object is accepted");
    const auto entry = json_->find(key);
    if (entry == json_->end()) fail(std::string("lacks the key ") + key);
    return {*entry, *this, key, 0};
}

JsonValue JsonValue::at(std::size_t index) const {
    return {(*json_)[index], *this, nullptr, index};
}

double JsonValue::number() const {
    if (!json_->is_number()) fail(found() + "; a number is accepted");
    return json_->get<double>();
}

std::uint64_t JsonValue::whole(std::uint64_t highest) const {
    if (!json_->is_number_unsigned() || json_->get<std::uint64_t>() > highest)
        fail(found() + "; a whole number from 0 to " + std::to_string(highest) + " is accepted");
    return json_->get<std::uint64_t>();
}

std::string JsonValue::text() const {
    if (!json_->is_string()) fail(found() + "; a text is accepted");
    return json_->get<std::string>();
}

void JsonValue::require_array() const {
    if (!json_->is_array()) fail(found() + "; a list is accepted");
}

double JsonValue::element(std::size_t index) const {
    return at(index).number();
}

Vec3 JsonValue::vec3() const {
    if (!json_->is_array() || json_->size() != 3) fail(found() + "; a list of 3 numbers, x y z, is accepted");
    return {element(0), element(1), element(2)};
}

Quat JsonValue::quat() const {
    if (!json_->is_array() || json_->size() != 4) fail(found() + "; a list of 4 numbers, w x y z, is accepted");
    return {element(0), element(1), element(2), element(3)};
}

}  // namespace clinch::io
