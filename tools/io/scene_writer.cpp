#include "tools/io/scene_writer.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "clinch/error.hpp"
#include "tools/io/block_writer.hpp"

namespace clinch::io {
namespace {

bool same_bits(double a, double b) {
    return a == b && std::signbit(a) == std::signbit(b);
}
bool same_bits(const Vec3& a, const Vec3& b) {
    return same_bits(a.x, b.x) && same_bits(a.y, b.y) && same_bits(a.z, b.z);
}
bool same_bits(const Quat& a, const Quat& b) {
    return same_bits(a.w, b.w) && same_bits(a.x, b.x) && same_bits(a.y, b.y) && same_bits(a.z, b.z);
}

/// Writes the fields of one body.
class BodyWriter {
public:
    BodyWriter(BlockWriter& out, std::uint32_t row) : out_(out), row_(row) {}

    void body(const Body& body, const Shape& shape) {
        out_.text("{\"shape\": {\"type\": ");
        std::visit([this](const auto& s) { fields(s); }, shape);
        out_.character('}');
        const Body plain;
        vector(", \"position\": ", body.pose.position);
        const Quat& q = body.pose.rotation;
        if (!same_bits(q, plain.pose.rotation)) {
            out_.text(", \"rotation\": ");
            list({q.w, q.x, q.y, q.z});
        }
        vector(", \"velocity\": ", body.velocity);
        vector(", \"angular_velocity\": ", body.angular_velocity);
        if (body.motion != plain.motion) motion(body.motion);
        if (body.group != plain.group) whole(", \"group\": ", body.group);
        if (body.mask != plain.mask) whole(", \"mask\": ", body.mask);
        if (!same_bits(body.margin, plain.margin)) number(", \"margin\": ", body.margin);
        out_.character('}');
    }

    [[noreturn]] void fail(const std::string& what) const {
        throw Error(ErrorCode::InvalidArgument, "body " + std::to_string(row_) + " cannot be written: " + what);
    }

private:
    void fields(const Sphere& s) { number("\"sphere\", \"radius\": ", s.radius); }
    void fields(const Box& s) {
        out_.text("\"box\", \"half_extents\": ");
        list({s.half_extents.x, s.half_extents.y, s.half_extents.z});
    }
    void fields(const Capsule& s) { round("\"capsule\"", s.radius, s.half_height); }
    void fields(const Cylinder& s) { round("\"cylinder\"", s.radius, s.half_height); }
    void fields(const Cone& s) { round("\"cone\"", s.radius, s.half_height); }
    void fields(const Plane& s) {
        out_.text("\"plane\", \"normal\": ");
        list({s.normal.x, s.normal.y, s.normal.z});
        number(", \"offset\": ", s.offset);
    }
    void fields(const Hull& s) {
        out_.text("\"hull\", \"points\": [");
        for (std::size_t i = 0; i < s.points.size(); ++i) {
            if (i > 0) out_.text(", ");
            list({s.points[i].x, s.points[i].y, s.points[i].z});
        }
        out_.character(']');
    }
    void fields(const Mesh&) { fail("its shape is a mesh, which needs a file of its own; other shapes are accepted"); }

    void round(const char* type, double radius, double half_height) {
        out_.text(type);
        number(", \"radius\": ", radius);
        number(", \"half_height\": ", half_height);
    }
    void vector(const char* before, const Vec3& v) {
        if (same_bits(v, Vec3{})) return;
        out_.text(before);
        list({v.x, v.y, v.z});
    }
    void motion(Motion motion) {
        constexpr std::array<const char*, 4> names{"static", "kinematic", "dynamic", "sleeping"};
        const auto index = static_cast<std::size_t>(motion);
        if (index >= names.size()) fail("its motion is none of the four there are");
        out_.text(std::string(", \"motion\": \"") + names[index] + '"');
    }
    void whole(const char* before, std::uint32_t value) {
        out_.text(before);
        out_.number(value);
    }
    void number(const char* before, double value) {
        out_.text(before);
        number(value);
    }
    void number(double value) {
        if (!std::isfinite(value)) fail("one of its numbers is not finite");
        if (value == 0.0 && std::signbit(value))
            out_.text("-0.0");  // "-0" would be read as a whole number, which has no sign
        else
            out_.number(value);
    }
    template <std::size_t Size>
    void list(const double (&numbers)[Size]) {
        out_.character('[');
        for (std::size_t i = 0; i < Size; ++i) {
            if (i > 0) out_.text(", ");
            number(numbers[i]);
        }
        out_.character(']');
    }

    BlockWriter& out_;
    std::uint32_t row_;
};

}  // namespace

void write_scene(OutputFile& file, const Scene& scene) {
    BlockWriter out(file);
    out.text("{\"bodies\": [");
    for (std::uint32_t row = 0; row < scene.row_count(); ++row) {
        out.text(row == 0 ? "\n" : ",\n");
        BodyWriter writer(out, row);
        if (!scene.contains({row})) writer.fail("it has been removed");
        const Body body = scene.body({row});
        writer.body(body, scene.shape(body.shape));
    }
    out.text("\n]}\n");
    out.finish();
}

}  // namespace clinch::io
