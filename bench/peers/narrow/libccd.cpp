// libccd: GJK with EPA, and MPR. Support functions are the caller's; these scan a hull's points. It has no distance of
// bodies apart.
#include <ccd/ccd.h>

#include <cmath>

#include "bench/peers/narrow/peer.hpp"

namespace clinch::peers::narrow {
namespace {

struct Body {
    std::size_t kind = 0;
    double size[3] = {};
    const Vec3* points = nullptr;  // of a hull
    std::size_t count = 0;
    std::array<double, 9> turn{};
    Vec3 position;
};

struct SetSizes {
    Body& body;
    void operator()(const Sphere& s) const { body.size[0] = s.radius; }
    void operator()(const Box& s) const {
        body.size[0] = s.half_extents.x;
        body.size[1] = s.half_extents.y;
        body.size[2] = s.half_extents.z;
    }
    void operator()(const Hull& s) const {
        body.points = s.points.data();
        body.count = s.points.size();
    }
    template <class RadiusAndHeight>
    void operator()(const RadiusAndHeight& s) const {
        body.size[0] = s.radius;
        body.size[1] = s.half_height;
    }
    void operator()(const Plane&) const {}
    void operator()(const Mesh&) const {}
};

Vec3 on_disc(double radius, double z, const Vec3& n) {
    const double across = std::sqrt(n.x * n.x + n.y * n.y);
    if (!(across > 0.0)) return {0.0, 0.0, z};
    return {radius / across * n.x, radius / across * n.y, z};
}

Vec3 on_ball(double radius, double z, const Vec3& n) {
    const double scale = radius / std::sqrt(n.x * n.x + n.y * n.y + n.z * n.z);
    return {scale * n.x, scale * n.y, scale * n.z + z};
}

Vec3 on_cone(double radius, double half_height, const Vec3& n) {
    const double across = std::sqrt(n.x * n.x + n.y * n.y);
    if (n.z * half_height > radius * across - n.z * half_height) return {0.0, 0.0, half_height};
    return on_disc(radius, -half_height, n);
}

Vec3 on_hull(const Body& body, const Vec3& n) {
    const Vec3* best = body.points;
    double most = n.x * best->x + n.y * best->y + n.z * best->z;
    for (const Vec3* p = body.points + 1; p != body.points + body.count; ++p) {
        const double reach = n.x * p->x + n.y * p->y + n.z * p->z;
        if (reach > most) {
            most = reach;
            best = p;
        }
    }
    return *best;
}

Vec3 furthest(const Body& body, const Vec3& n) {
    const double* const size = body.size;
    switch (body.kind) {
        case 0:
            return on_ball(size[0], 0.0, n);
        case 1:
            return {std::copysign(size[0], n.x), std::copysign(size[1], n.y), std::copysign(size[2], n.z)};
        case 2:
            return on_ball(size[0], std::copysign(size[1], n.z), n);
        case 3:
            return on_disc(size[0], std::copysign(size[1], n.z), n);
        case 4:
            return on_cone(size[0], size[1], n);
        default:
            return on_hull(body, n);
    }
}

void support(const void* object, const ccd_vec3_t* direction, ccd_vec3_t* out) {
    const Body& body = *static_cast<const Body*>(object);
    const double* const d = direction->v;
    const std::array<double, 9>& m = body.turn;
    const Vec3 p = furthest(body, {m[0] * d[0] + m[3] * d[1] + m[6] * d[2], m[1] * d[0] + m[4] * d[1] + m[7] * d[2],
                                   m[2] * d[0] + m[5] * d[1] + m[8] * d[2]});
    ccdVec3Set(out, m[0] * p.x + m[1] * p.y + m[2] * p.z + body.position.x,
               m[3] * p.x + m[4] * p.y + m[5] * p.z + body.position.y,
               m[6] * p.x + m[7] * p.y + m[8] * p.z + body.position.z);
}

void centre(const void* object, ccd_vec3_t* out) {
    const Body& body = *static_cast<const Body*>(object);
    ccdVec3Set(out, body.position.x, body.position.y, body.position.z);
}

class Libccd : public ListPeer {
public:
    Libccd(const Batch& batch, Question question, bool mpr) : ListPeer(batch), question_(question), mpr_(mpr) {
        for (std::size_t i = 0; i < batch.pose.size(); ++i) {
            const Shape& shape = batch.shapes[batch.shape[i]].shape;
            Body body;
            body.kind = shape.index();
            std::visit(SetSizes{body}, shape);
            body.turn = matrix_of(batch.pose[i].rotation);
            body.position = batch.pose[i].position;
            bodies_.push_back(body);
        }
        CCD_INIT(&ccd_);
        ccd_.support1 = ccd_.support2 = support;
        ccd_.center1 = ccd_.center2 = centre;
        ccd_.max_iterations = 500;  // without a limit, its own choice, a call may not end
        // With its own 1e-4 the depth of two spheres is a hundredth of their size off. The depth of MPR, which is not
        // that of the shortest way out, gets no better by another tolerance.
        ccd_.epa_tolerance = 1e-6;
    }

    void run() override {
        for (std::size_t i = 0; i < answers_.size(); ++i) {
            const Body &a = bodies_[2 * i], &b = bodies_[2 * i + 1];
            answers_[i] = question_ == Question::Touching ? touching(a, b) : contact(a, b);
        }
    }

private:
    Answer touching(const Body& a, const Body& b) const {
        Answer answer;
        answer.given = true;
        answer.touching = (mpr_ ? ccdMPRIntersect(&a, &b, &ccd_) : ccdGJKIntersect(&a, &b, &ccd_)) != 0;
        return answer;
    }

    Answer contact(const Body& a, const Body& b) const {
        ccd_real_t depth = 0.0;
        ccd_vec3_t normal, point;
        const int failed = mpr_ ? ccdMPRPenetration(&a, &b, &ccd_, &depth, &normal, &point)
                                : ccdGJKPenetration(&a, &b, &ccd_, &depth, &normal, &point);
        Answer answer;
        answer.given = true;
        if (failed != 0) return answer;
        answer.touching = true;
        answer.distance = -depth;
        answer.normal = {normal.v[0], normal.v[1], normal.v[2]};
        answer.point = {point.v[0], point.v[1], point.v[2]};
        return answer;
    }

    Question question_;
    bool mpr_;
    std::vector<Body> bodies_;
    ccd_t ccd_;
};

std::unique_ptr<Peer> make(const Batch& batch, Question question, bool mpr) {
    constexpr std::size_t plane = 5;
    const bool known = batch.cell.a.kind != plane && batch.cell.b.kind != plane;
    if (!known || question == Question::Distance) return nullptr;
    return std::make_unique<Libccd>(batch, question, mpr);
}

}  // namespace

std::unique_ptr<Peer> make_libccd_gjk(const Batch& batch, Question question) {
    return make(batch, question, false);
}

std::unique_ptr<Peer> make_libccd_mpr(const Batch& batch, Question question) {
    return make(batch, question, true);
}

}  // namespace clinch::peers::narrow
