// Conversions to and from Eigen. The only public header that includes Eigen; header-only.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "clinch/aabb.hpp"
#include "clinch/error.hpp"
#include "clinch/pose.hpp"
#include "clinch/scene.hpp"

namespace clinch {

inline Eigen::Vector3d to_eigen(const Vec3& v) {
    return {v.x, v.y, v.z};
}
inline Vec3 from_eigen(const Eigen::Vector3d& v) {
    return {v.x(), v.y(), v.z()};
}

/// The rotation as given, not normalised.
inline Eigen::Quaterniond to_eigen(const Quat& q) {
    return {q.w, q.x, q.y, q.z};
}
inline Quat from_eigen(const Eigen::Quaterniond& q) {
    return {q.w(), q.x(), q.y(), q.z()};
}

/// Body to world as a rigid transform; the rotation is normalised.
inline Eigen::Isometry3d to_eigen(const Pose& pose) {
    Eigen::Isometry3d t = Eigen::Isometry3d::Identity();
    t.linear() = to_eigen(pose.rotation).normalized().toRotationMatrix();
    t.translation() = to_eigen(pose.position);
    return t;
}
/// The linear part must be a rotation.
inline Pose from_eigen(const Eigen::Isometry3d& t) {
    return {from_eigen(Eigen::Vector3d(t.translation())), from_eigen(Eigen::Quaterniond(t.linear()))};
}

inline Eigen::AlignedBox3f to_eigen(const Aabb& b) {
    return {Eigen::Vector3f(b.min[0], b.min[1], b.min[2]), Eigen::Vector3f(b.max[0], b.max[1], b.max[2])};
}
/// An empty Eigen box (min > max) gives an invalid Aabb, which pairs with nothing.
inline Aabb from_eigen(const Eigen::AlignedBox3f& b) {
    return {{b.min().x(), b.min().y(), b.min().z()}, {b.max().x(), b.max().y(), b.max().z()}};
}

/// The positions of a scene's rows as a 3 x n matrix that shares the scene's memory: column i is
/// row i. Valid until the scene changes.
inline Eigen::Map<const Eigen::Matrix3Xd> positions(const Scene& scene) {
    const View<const Vec3> p = scene.columns().position;
    return {p.empty() ? nullptr : &p.data()->x, 3, static_cast<Eigen::Index>(p.size())};
}
/// Sets positions of rows first, first + 1, ... from the columns of a 3 x n matrix.
inline void set_positions(Scene& scene, const Eigen::Ref<const Eigen::Matrix3Xd>& columns, std::size_t first = 0) {
    if (columns.outerStride() != 3)
        throw Error(ErrorCode::InvalidArgument, "the columns of the position matrix must be 3 numbers apart");
    scene.set_positions(columns.data(), static_cast<std::size_t>(columns.cols()), first);
}

}  // namespace clinch
