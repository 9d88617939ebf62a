#include "tools/io/json_value.hpp"

#include <algorithm>
#include <set>
#include <utility>
#include <vector>

#include "tools/io/error.hpp"
#include "tools/io/input_file.hpp"
#include "tools/io/text.hpp"

namespace clinch::io {
namespace {

using nlohmann::json;

/// Watches a document being parsed for keys that stand twice in one object.
class DuplicateWatch {
public:
    explicit DuplicateWatch(const std::string& file) : file_(file) {}

    void operator()(json::parse_event_t event, const json& value) {
        switch (event) {
            case json::parse_event_t::object_start:
            case json::parse_event_t::array_start:
                next_element();
                open_.push_back({event == json::parse_event_t::array_start, 0, {}, {}});
                break;
            case json::parse_event_t::object_end:
            case json::parse_event_t::array_end:
                open_.pop_back();
                break;
            case json::parse_event_t::key:
                note_key(value.get_ref<const std::string&>());
                break;
            case json::parse_event_t::value:
                next_element();
                break;
        }
    }

private:
    struct Level {
        bool array;
        std::size_t elements;
        std::string key;
        std::set<std::string> keys;
    };

    void next_element() {
        if (!open_.empty() && open_.back().array) ++open_.back().elements;
    }
    void note_key(const std::string& key) {
        open_.back().key = key;
        if (open_.back().keys.insert(key).second) return;
        throw InputError(file_ + ": " + place() + " stands twice; once is accepted");
    }
    std::string place() const {
        std::string path;
        for (const Level& level : open_)
            path +=
                level.array ? "[" + std::to_string(level.elements - 1) + "]" : (path.empty() ? "" : ".") + level.key;
        return path;
    }

    const std::string& file_;
    std::vector<Level> open_;
};

/// A parser's message without the library's own tag in front.
std::string plain(const std::string& message) {
    const std::size_t end = message.find("] ");
    return message.front() == '[' && end != std::string::npos ? message.substr(end + 2) : message;
}

}  // namespace

json read_json(const std::string& path) {
    const std::string text = read_text(path);
    DuplicateWatch watch(path);
    try {
        return json::parse(text, [&watch](int, json::parse_event_t event, const json& value) {
            watch(event, value);
            return true;
        });
    } catch (const json::exception& e) {
        throw InputError(path + ": is no JSON document: " + plain(e.what()));
    }
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
    std::vector<std::string> known(keys.begin(), keys.end());
    const std::string accepted = join(known) + (known.size() > 1 ? " are accepted" : " is accepted");
    if (!json_->is_object()) fail(found() + "; an object with keys among " + accepted);
    for (const auto& entry : json_->items()) {
        if (std::find(known.begin(), known.end(), entry.key()) != known.end()) continue;
        JsonValue(entry.value(), *this, entry.key().c_str(), 0).fail("is no known key; " + accepted);
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
