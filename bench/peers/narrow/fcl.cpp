// FCL: collide() and distance() on geometries and transforms made beforehand, with either of its solvers.
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/cone.h>
#include <fcl/geometry/shape/convex.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/halfspace.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>

#include <stdexcept>

#include "bench/peers/narrow/peer.hpp"

namespace clinch::peers::narrow {
namespace {

using Geometry = std::unique_ptr<fcl::CollisionGeometryd>;

struct MakeGeometry {
    const PoolShape& pool;
    Geometry operator()(const Sphere& s) const { return std::make_unique<fcl::Sphered>(s.radius); }
    Geometry operator()(const Box& s) const {
        const Vec3& e = s.half_extents;
        return std::make_unique<fcl::Boxd>(2.0 * e.x, 2.0 * e.y, 2.0 * e.z);
    }
    Geometry operator()(const Capsule& s) const {
        return std::make_unique<fcl::Capsuled>(s.radius, 2.0 * s.half_height);
    }
    Geometry operator()(const Cylinder& s) const {
        return std::make_unique<fcl::Cylinderd>(s.radius, 2.0 * s.half_height);
    }
    Geometry operator()(const Cone& s) const { return std::make_unique<fcl::Coned>(s.radius, 2.0 * s.half_height); }
    Geometry operator()(const Plane& s) const {
        return std::make_unique<fcl::Halfspaced>(fcl::Vector3d(s.normal.x, s.normal.y, s.normal.z), s.offset);
    }
    Geometry operator()(const Hull& s) const {
        auto points = std::make_shared<std::vector<fcl::Vector3d>>();
        for (const Vec3& p : s.points) points->emplace_back(p.x, p.y, p.z);
        auto faces = std::make_shared<std::vector<int>>();
        for (const auto& face : pool.faces) {
            faces->push_back(3);
            for (const std::uint32_t corner : face) faces->push_back(static_cast<int>(corner));
        }
        return std::make_unique<fcl::Convexd>(points, static_cast<int>(pool.faces.size()), faces);
    }
    Geometry operator()(const Mesh&) const { throw std::invalid_argument("a mesh is no convex shape"); }
};

Vec3 vector_of(const fcl::Vector3d& v) {
    return {v[0], v[1], v[2]};
}

class Fcl : public ListPeer {
public:
    Fcl(const Batch& batch, Question question, fcl::GJKSolverType solver) : ListPeer(batch), question_(question) {
        for (const PoolShape& shape : batch.shapes) {
            geometries_.push_back(std::visit(MakeGeometry{shape}, shape.shape));
            geometries_.back()->computeLocalAABB();
        }
        for (std::size_t i = 0; i < batch.pose.size(); ++i) {
            const auto& [p, q] = batch.pose[i];
            fcl::Transform3d transform = fcl::Transform3d::Identity();
            transform.linear() = fcl::Quaterniond(q.w, q.x, q.y, q.z).toRotationMatrix();
            transform.translation() = fcl::Vector3d(p.x, p.y, p.z);
            transforms_.push_back(transform);
            of_body_.push_back(geometries_[batch.shape[i]].get());
        }
        collide_.num_max_contacts = 1;
        collide_.enable_contact = question == Question::Contact;
        collide_.gjk_solver_type = solver;
        distance_.enable_nearest_points = true;
        distance_.gjk_solver_type = solver;
    }

    void run() override {
        for (std::size_t i = 0; i < answers_.size(); ++i) {
            Answer answer;
            try {
                answer = question_ == Question::Distance ? apart(2 * i) : together(2 * i);
            } catch (const std::exception&) {  // what it throws where its depth search fails
                answer = {};
            }
            answers_[i] = answer;
        }
    }

private:
    Answer together(std::size_t a) {
        found_.clear();
        fcl::collide(of_body_[a], transforms_[a], of_body_[a + 1], transforms_[a + 1], collide_, found_);
        Answer answer;
        answer.given = true;
        answer.touching = found_.isCollision();
        if (question_ == Question::Touching || !answer.touching) return answer;
        const fcl::Contactd& contact = found_.getContact(0);
        answer.distance = -contact.penetration_depth;
        answer.normal = vector_of(contact.normal);
        // Where the indep solver searches, its depth comes out negative and its normal in the frame of the first shape.
        if (contact.penetration_depth < 0.0) {
            answer.distance = contact.penetration_depth;
            answer.normal = vector_of(transforms_[a].linear() * contact.normal);
        }
        answer.point = vector_of(contact.pos);
        return answer;
    }

    Answer apart(std::size_t a) {
        nearest_.clear();
        fcl::distance(of_body_[a], transforms_[a], of_body_[a + 1], transforms_[a + 1], distance_, nearest_);
        Answer answer;
        answer.given = true;
        answer.distance = nearest_.min_distance;
        answer.touching = answer.distance <= 0.0;
        answer.point = vector_of(nearest_.nearest_points[0]);
        answer.other = vector_of(nearest_.nearest_points[1]);
        return answer;
    }

    Question question_;
    std::vector<Geometry> geometries_;
    fcl::aligned_vector<fcl::Transform3d> transforms_;
    std::vector<const fcl::CollisionGeometryd*> of_body_;
    fcl::CollisionRequestd collide_;
    fcl::CollisionResultd found_;
    fcl::DistanceRequestd distance_;
    fcl::DistanceResultd nearest_;
};

}  // namespace

std::unique_ptr<Peer> make_fcl_libccd(const Batch& batch, Question question) {
    return std::make_unique<Fcl>(batch, question, fcl::GST_LIBCCD);
}

std::unique_ptr<Peer> make_fcl_indep(const Batch& batch, Question question) {
    return std::make_unique<Fcl>(batch, question, fcl::GST_INDEP);
}

}  // namespace clinch::peers::narrow
