// ODE: dCollide() on geoms made beforehand, one contact a pair: the deepest. It has no distance of bodies apart, and no
// cone.
#include <ode/ode.h>

#include <new>
#include <stdexcept>

#include "bench/peers/narrow/peer.hpp"

namespace clinch::peers::narrow {
namespace {

dReal real_of(double x) {
    return static_cast<dReal>(x);
}

/// A hull as dCreateConvex wants it, which keeps pointers into this.
struct Polytope {
    std::vector<dReal> planes, points;
    std::vector<unsigned int> polygons;
};

Polytope polytope_of(const PoolShape& pool) {
    Polytope out;
    const Hull* const hull = std::get_if<Hull>(&pool.shape);
    if (hull == nullptr) return out;
    for (const Vec3& p : hull->points) out.points.insert(out.points.end(), {real_of(p.x), real_of(p.y), real_of(p.z)});
    for (const auto& face : pool.faces) {
        const Vec3 &a = hull->points[face[0]], &b = hull->points[face[1]], &c = hull->points[face[2]];
        dVector3 u{real_of(b.x - a.x), real_of(b.y - a.y), real_of(b.z - a.z)};
        dVector3 v{real_of(c.x - a.x), real_of(c.y - a.y), real_of(c.z - a.z)};
        dVector3 n;
        dCalcVectorCross3(n, u, v);
        dNormalize3(n);
        const dVector3 at{real_of(a.x), real_of(a.y), real_of(a.z)};
        out.planes.insert(out.planes.end(), {n[0], n[1], n[2], dCalcVectorDot3(n, at)});
        out.polygons.push_back(3);
        out.polygons.insert(out.polygons.end(), face.begin(), face.end());
    }
    return out;
}

struct MakeGeom {
    const PoolShape& pool;
    const Polytope& polytope;
    const Pose& pose;

    dGeomID operator()(const Sphere& s) const { return placed(dCreateSphere(nullptr, real_of(s.radius))); }
    dGeomID operator()(const Box& s) const {
        const Vec3& e = s.half_extents;
        return placed(dCreateBox(nullptr, real_of(2.0 * e.x), real_of(2.0 * e.y), real_of(2.0 * e.z)));
    }
    dGeomID operator()(const Capsule& s) const {
        return placed(dCreateCapsule(nullptr, real_of(s.radius), real_of(2.0 * s.half_height)));
    }
    dGeomID operator()(const Cylinder& s) const {
        return placed(dCreateCylinder(nullptr, real_of(s.radius), real_of(2.0 * s.half_height)));
    }
    // A plane has no place of its own.
    dGeomID operator()(const Plane& s) const {
        const std::array<double, 9> m = matrix_of(pose.rotation);
        const Vec3 &n = s.normal, &p = pose.position;
        const Vec3 up{m[0] * n.x + m[1] * n.y + m[2] * n.z, m[3] * n.x + m[4] * n.y + m[5] * n.z,
                      m[6] * n.x + m[7] * n.y + m[8] * n.z};
        return dCreatePlane(nullptr, real_of(up.x), real_of(up.y), real_of(up.z),
                            real_of(s.offset + up.x * p.x + up.y * p.y + up.z * p.z));
    }
    dGeomID operator()(const Hull&) const {
        return placed(dCreateConvex(nullptr, polytope.planes.data(), static_cast<unsigned>(pool.faces.size()),
                                    polytope.points.data(), static_cast<unsigned>(polytope.points.size() / 3),
                                    polytope.polygons.data()));
    }
    dGeomID operator()(const Cone&) const { throw std::invalid_argument("there is no cone"); }
    dGeomID operator()(const Mesh&) const { throw std::invalid_argument("a mesh is no convex shape"); }

private:
    dGeomID placed(dGeomID geom) const {
        const Quat& q = pose.rotation;
        const dQuaternion turn{real_of(q.w), real_of(q.x), real_of(q.y), real_of(q.z)};
        dGeomSetPosition(geom, real_of(pose.position.x), real_of(pose.position.y), real_of(pose.position.z));
        dGeomSetQuaternion(geom, turn);
        return geom;
    }
};

class Ode : public ListPeer {
public:
    Ode(const Batch& batch, Question question) : ListPeer(batch), question_(question) {
        polytopes_.reserve(batch.shapes.size());
        for (const PoolShape& shape : batch.shapes) polytopes_.push_back(polytope_of(shape));
        for (std::size_t i = 0; i < batch.pose.size(); ++i) {
            const PoolShape& pool = batch.shapes[batch.shape[i]];
            geoms_.push_back(std::visit(MakeGeom{pool, polytopes_[batch.shape[i]], batch.pose[i]}, pool.shape));
        }
    }
    ~Ode() override {
        for (const dGeomID geom : geoms_) dGeomDestroy(geom);
    }

    void run() override {
        // CONTACTS_UNIMPORTANT would do for a yes, but makes dCollide miss boxes that overlap and find some apart.
        constexpr int one_contact = 1;
        for (std::size_t i = 0; i < answers_.size(); ++i) {
            dContactGeom contact;
            const int count = dCollide(geoms_[2 * i], geoms_[2 * i + 1], one_contact, &contact, sizeof contact);
            Answer answer;
            answer.given = true;
            answer.touching = count > 0;
            if (question_ == Question::Contact && count > 0) {
                answer.distance = -static_cast<double>(contact.depth);
                // Its normal points into the first.
                answer.normal = {-contact.normal[0], -contact.normal[1], -contact.normal[2]};
                answer.point = {contact.pos[0], contact.pos[1], contact.pos[2]};
            }
            answers_[i] = answer;
        }
    }

private:
    struct Library {
        Library() {
            if (dInitODE2(0) == 0) throw std::bad_alloc();
        }
        ~Library() { dCloseODE(); }
        Library(const Library&) = delete;
        Library& operator=(const Library&) = delete;
    };

    Library library_;
    Question question_;
    std::vector<Polytope> polytopes_;
    std::vector<dGeomID> geoms_;
};

}  // namespace

std::unique_ptr<Peer> make_ode(const Batch& batch, Question question) {
    constexpr std::size_t cone = 4;
    if (question == Question::Distance || batch.cell.a.kind == cone || batch.cell.b.kind == cone) return nullptr;
    return std::make_unique<Ode>(batch, question);
}

}  // namespace clinch::peers::narrow
