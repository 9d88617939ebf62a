// Bullet 2, in its float32. `bullet`: the pair algorithms of its default configuration, made beforehand for the two
// shapes, with a result that takes their points as they come. `bullet-gjkepa`: btGjkEpaSolver2 called directly.
// Collision margins are 0, so that shapes have the size they were given.
#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkEpa2.h>
#include <btBulletCollisionCommon.h>

#include <limits>
#include <new>
#include <stdexcept>

#include "bench/peers/narrow/peer.hpp"

namespace clinch::peers::narrow {
namespace {

btScalar real_of(double x) {
    return static_cast<btScalar>(x);
}

btVector3 vector_of(const Vec3& v) {
    return {real_of(v.x), real_of(v.y), real_of(v.z)};
}

Vec3 vector_of(const btVector3& v) {
    return {double{v.x()}, double{v.y()}, double{v.z()}};
}

Vec3 reversed(const btVector3& v) {
    return {-double{v.x()}, -double{v.y()}, -double{v.z()}};
}

using ShapePointer = std::unique_ptr<btCollisionShape>;

struct MakeShape {
    ShapePointer operator()(const Sphere& s) const { return std::make_unique<btSphereShape>(real_of(s.radius)); }
    ShapePointer operator()(const Box& s) const { return std::make_unique<btBoxShape>(vector_of(s.half_extents)); }
    ShapePointer operator()(const Capsule& s) const {
        return std::make_unique<btCapsuleShapeZ>(real_of(s.radius), real_of(2.0 * s.half_height));
    }
    ShapePointer operator()(const Cylinder& s) const {
        return std::make_unique<btCylinderShapeZ>(
            btVector3(real_of(s.radius), real_of(s.radius), real_of(s.half_height)));
    }
    ShapePointer operator()(const Cone& s) const {
        return std::make_unique<btConeShapeZ>(real_of(s.radius), real_of(2.0 * s.half_height));
    }
    ShapePointer operator()(const Plane& s) const {
        return std::make_unique<btStaticPlaneShape>(vector_of(s.normal), real_of(s.offset));
    }
    ShapePointer operator()(const Hull& s) const {
        auto hull = std::make_unique<btConvexHullShape>();
        for (const Vec3& p : s.points) hull->addPoint(vector_of(p), false);
        hull->recalcLocalAabb();
        return hull;
    }
    ShapePointer operator()(const Mesh&) const { throw std::invalid_argument("a mesh is no convex shape"); }
};

/// Shapes and poses, in Bullet's words.
struct World {
    explicit World(const Batch& batch) {
        for (const PoolShape& pool : batch.shapes) {
            shapes.push_back(std::visit(MakeShape{}, pool.shape));
            // The margin of a sphere and a capsule is their radius.
            const bool round =
                std::holds_alternative<Sphere>(pool.shape) || std::holds_alternative<Capsule>(pool.shape);
            if (!round) shapes.back()->setMargin(0.0f);
        }
        for (std::size_t i = 0; i < batch.pose.size(); ++i) {
            const Quat& q = batch.pose[i].rotation;
            transforms.push_back(btTransform(btQuaternion(real_of(q.x), real_of(q.y), real_of(q.z), real_of(q.w)),
                                             vector_of(batch.pose[i].position)));
            of_body.push_back(shapes[batch.shape[i]].get());
        }
    }
    std::vector<ShapePointer> shapes;
    std::vector<btTransform> transforms;
    std::vector<const btCollisionShape*> of_body;
};

/// Keeps the deepest point of a pair. Normals point from b to a, points lie on b.
class Deepest : public btManifoldResult {
public:
    Deepest(const btCollisionObjectWrapper* a, const btCollisionObjectWrapper* b, btPersistentManifold* manifold,
            btScalar reach)
        : btManifoldResult(a, b) {
        setPersistentManifold(manifold);
        m_closestPointDistanceThreshold = reach;
    }
    void addContactPoint(const btVector3& normal, const btVector3& point, btScalar distance) override {
        if (!(distance < distance_)) return;
        distance_ = distance;
        normal_ = normal;
        point_ = point;
    }
    Answer answer(Question question) const {
        Answer out;
        out.given = true;
        out.touching = distance_ <= 0.0f;
        if (question == Question::Touching || distance_ == none) return out;
        out.distance = double{distance_};
        out.normal = reversed(normal_);
        out.point = vector_of(point_);
        if (question == Question::Contact) return out;
        out.other = out.point;
        out.point = vector_of(point_ + distance_ * normal_);
        return out;
    }

private:
    static constexpr btScalar none = std::numeric_limits<btScalar>::max();
    btScalar distance_ = none;
    btVector3 normal_{0.0f, 0.0f, 0.0f}, point_{0.0f, 0.0f, 0.0f};
};

class PairAlgorithms : public ListPeer {
public:
    PairAlgorithms(const Batch& batch, Question question)
        : ListPeer(batch), question_(question), world_(batch), dispatcher_(&configuration_) {
        // Gaps of pairs are up to 0.1 of their size.
        if (question == Question::Distance) reach_ = real_of(0.1002 * batch.largest_size);
        first_.setCollisionShape(world_.shapes.front().get());
        second_.setCollisionShape(world_.shapes.back().get());
        manifold_ = dispatcher_.getNewManifold(&first_, &second_);
        manifold_->setContactBreakingThreshold(0.0f);
        const btCollisionObjectWrapper a = wrapped(0, first_), b = wrapped(1, second_);
        algorithm_ = dispatcher_.findAlgorithm(
            &a, &b, manifold_,
            question == Question::Distance ? BT_CLOSEST_POINT_ALGORITHMS : BT_CONTACT_POINT_ALGORITHMS);
    }
    ~PairAlgorithms() override {
        algorithm_->~btCollisionAlgorithm();
        dispatcher_.freeCollisionAlgorithm(algorithm_);
        dispatcher_.releaseManifold(manifold_);
    }

    void run() override {
        for (std::size_t i = 0; i < answers_.size(); ++i) {
            const btCollisionObjectWrapper a = wrapped(2 * i, first_), b = wrapped(2 * i + 1, second_);
            Deepest deepest(&a, &b, manifold_, reach_);
            algorithm_->processCollision(&a, &b, dispatch_, &deepest);
            answers_[i] = deepest.answer(question_);
        }
    }

private:
    btCollisionObjectWrapper wrapped(std::size_t body, const btCollisionObject& object) const {
        return {nullptr, world_.of_body[body], &object, world_.transforms[body], -1, -1};
    }

    Question question_;
    World world_;
    btDefaultCollisionConfiguration configuration_;
    btCollisionDispatcher dispatcher_;
    btDispatcherInfo dispatch_;
    btCollisionObject first_, second_;
    btPersistentManifold* manifold_ = nullptr;
    btCollisionAlgorithm* algorithm_ = nullptr;
    btScalar reach_ = 0.0f;
};

class GjkEpa : public ListPeer {
public:
    GjkEpa(const Batch& batch, Question question) : ListPeer(batch), question_(question), world_(batch) {}

    void run() override {
        for (std::size_t i = 0; i < answers_.size(); ++i) {
            const auto* const a = static_cast<const btConvexShape*>(world_.of_body[2 * i]);
            const auto* const b = static_cast<const btConvexShape*>(world_.of_body[2 * i + 1]);
            const btTransform &from = world_.transforms[2 * i], &to = world_.transforms[2 * i + 1];
            btGjkEpaSolver2::sResults found;
            const btVector3 guess = to.getOrigin() - from.getOrigin();
            answers_[i] = question_ == Question::Contact
                              ? deep(btGjkEpaSolver2::Penetration(a, from, b, to, guess, found), found)
                              : apart(btGjkEpaSolver2::Distance(a, from, b, to, guess, found), found,
                                      {a->getMargin(), b->getMargin()});
        }
    }

private:
    static Answer deep(bool overlapping, const btGjkEpaSolver2::sResults& found) {
        Answer answer;
        answer.given = overlapping || found.status == btGjkEpaSolver2::sResults::Separated;
        answer.touching = overlapping;
        if (!overlapping) return answer;
        // The solver's normal is in the frame of the first shape.
        answer.distance = double{found.distance};
        answer.normal = vector_of(found.witnesses[0] - found.witnesses[1]);
        answer.point = vector_of(found.witnesses[0]);
        return answer;
    }
    // The distance leaves the margins out, which are the radii of spheres and capsules.
    static Answer apart(bool separated, const btGjkEpaSolver2::sResults& found, const std::array<btScalar, 2>& balls) {
        Answer answer;
        answer.given = separated || found.status == btGjkEpaSolver2::sResults::Penetrating;
        answer.touching = !separated;
        if (!separated) return answer;
        answer.distance = double{found.distance} - double{balls[0]} - double{balls[1]};
        answer.touching = answer.distance <= 0.0;
        const btVector3 normal = (found.witnesses[1] - found.witnesses[0]) / found.distance;
        answer.normal = vector_of(normal);
        answer.point = vector_of(found.witnesses[0] + balls[0] * normal);
        answer.other = vector_of(found.witnesses[1] - balls[1] * normal);
        return answer;
    }

    Question question_;
    World world_;
};

}  // namespace

std::unique_ptr<Peer> make_bullet(const Batch& batch, Question question) {
    return std::make_unique<PairAlgorithms>(batch, question);
}

std::unique_ptr<Peer> make_bullet_gjkepa(const Batch& batch, Question question) {
    constexpr std::size_t plane = 5;
    if (batch.cell.a.kind == plane || batch.cell.b.kind == plane) return nullptr;
    return std::make_unique<GjkEpa>(batch, question);
}

}  // namespace clinch::peers::narrow
