#include <catch2/catch.hpp>

#include "clinch/interop/eigen.hpp"
#include "tests/random.hpp"
#include "tests/scene/bounds_oracle.hpp"

using namespace clinch;

TEST_CASE("poses go to Eigen transforms and back", "[host]") {
    test::Random random(61);
    for (int n = 0; n < 100; ++n) {
        Pose pose{{random.between(-9, 9), random.between(-9, 9), random.between(-9, 9)}, test::random_rotation(random)};
        const Eigen::Isometry3d t = to_eigen(pose);
        const test::Real3 v = test::turned(pose.rotation, {1, 2, 3});
        const Eigen::Vector3d moved = t * Eigen::Vector3d(1, 2, 3);
        CHECK(moved.x() == Approx(double(v[0]) + pose.position.x).margin(1e-12));
        CHECK(moved.y() == Approx(double(v[1]) + pose.position.y).margin(1e-12));
        CHECK(moved.z() == Approx(double(v[2]) + pose.position.z).margin(1e-12));
        CHECK((to_eigen(from_eigen(t)).matrix() - t.matrix()).norm() < 1e-12);
        pose.rotation.w *= 1.0005;
        pose.rotation.x *= 1.0005;
        pose.rotation.y *= 1.0005;
        pose.rotation.z *= 1.0005;
        CHECK((to_eigen(pose).matrix() - t.matrix()).norm() < 1e-12);
        CHECK(to_eigen(pose.rotation).norm() == Approx(1.0005));
    }
}

TEST_CASE("boxes go to Eigen and back", "[host]") {
    const Aabb box{{1, 2, 3}, {4, 5, 6}};
    const Eigen::AlignedBox3f e = to_eigen(box);
    CHECK(e.contains(Eigen::Vector3f(4, 5, 6)));
    CHECK_FALSE(e.contains(Eigen::Vector3f(4, 5.1f, 6)));
    CHECK(from_eigen(e).max[1] == 5.0f);
    const Aabb empty = from_eigen(Eigen::AlignedBox3f());
    CHECK(empty.min[0] > empty.max[0]);
    CHECK_FALSE(overlap(empty, box));
}

TEST_CASE("positions of a scene are an Eigen matrix", "[host]") {
    Scene scene;
    CHECK(positions(scene).cols() == 0);
    Body body;
    body.shape = scene.add_shape(Sphere{});
    scene.add_bodies(4, body);
    const Eigen::Matrix3Xd columns = Eigen::Matrix3Xd::Random(3, 4);
    set_positions(scene, columns);
    CHECK(positions(scene) == columns);
    CHECK(static_cast<const void*>(positions(scene).data()) ==
          static_cast<const void*>(scene.columns().position.data()));
    set_positions(scene, columns.rightCols(2), 1);
    CHECK(positions(scene).col(1) == columns.col(2));
    CHECK(positions(scene).col(0) == columns.col(0));
    const Eigen::Matrix4Xd strided = Eigen::Matrix4Xd::Random(4, 4);
    const std::uint64_t version = scene.version();
    CHECK_THROWS_AS(set_positions(scene, strided.topRows<3>()), Error);
    CHECK_THROWS_AS(set_positions(scene, columns, 1), Error);
    CHECK(scene.version() == version);
}
