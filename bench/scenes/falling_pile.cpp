#include "bench/scenes/falling_pile.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <queue>
#include <utility>

namespace clinch::scenes {
namespace {

// At rest a body is sunk so deep into what it lies on.
constexpr double sink = 0.02;

struct Place {
    double floor;
    std::uint32_t column, layer;
    bool operator>(const Place& other) const {
        return floor > other.floor || (floor == other.floor && column > other.column);
    }
};

// The `wanted` lowest places of the columns, ascending.
std::vector<Place> lowest_places(const std::vector<Column>& columns, double layer, std::size_t wanted) {
    std::priority_queue<Place, std::vector<Place>, std::greater<>> next;
    for (std::uint32_t c = 0; c < columns.size(); ++c) next.push({columns[c].floor, c, 0});
    std::vector<Place> places;
    places.reserve(wanted);
    while (places.size() < wanted) {
        const Place place = next.top();
        next.pop();
        places.push_back(place);
        next.push({place.floor + layer, place.column, place.layer + 1});
    }
    return places;
}

// Where and how each body lies in the end.
void plan_rest(Draft& draft, const std::vector<Column>& columns, const Pile& pile, const std::vector<Place>& places) {
    Random& random = draft.random;
    const double jitter = 0.04 * pile.pitch;
    draft.plan.fallers.reserve(places.size());
    for (const Place& place : places) {
        Faller faller;
        faller.outline = static_cast<std::uint32_t>(random.below(draft.shapes.size()));
        faller.floor = place.floor;
        const std::array<double, 2> about_z = random.unit_vector<2>();
        const double p = random.between(-pile.tilt, pile.tilt), q = random.between(-pile.tilt, pile.tilt);
        faller.rest_rotation = product({about_z[0], 0.0, 0.0, about_z[1]}, normalised({1.0, p, q, 0.0}));
        const Column& column = columns[place.column];
        faller.rest.x = column.x + random.between(-jitter, jitter);
        faller.rest.y = column.y + random.between(-jitter, jitter);
        faller.rest.z = draft.plan.lowest(faller, faller.rest_rotation, faller.rest.x, faller.rest.y);
        draft.plan.fallers.push_back(faller);
    }
}

// Sets the gravity that takes the highest body down in fall_frames, and the velocities that move a body aside by up to
// `aside` on each axis until it strikes, where that leaves it in the bowl.
void plan_velocities(Draft& draft, double aside, double bound) {
    FallPlan& plan = draft.plan;
    double highest = 0.0;
    for (const Faller& faller : plan.fallers) highest = std::max(highest, faller.position.z - faller.rest.z);
    const double seconds = fall_frames * frame_seconds;
    if (highest > 0.0) plan.gravity = 2.0 * highest / (seconds * seconds);
    for (Faller& faller : plan.fallers) {
        double x = draft.random.between(-aside, aside), y = draft.random.between(-aside, aside);
        if (!plan.ground.holds(faller.position.x + x, faller.position.y + y, bound)) x = y = 0.0;
        const double time = std::sqrt(2.0 * (faller.position.z - faller.rest.z) / plan.gravity);
        faller.velocity = {x / time, y / time, 0.0};
    }
}

}  // namespace

double FallPlan::lowest(const Faller& faller, const Quat& rotation, double x, double y) const {
    const Outline& outline = outlines[faller.outline];
    const double on_layer = faller.floor + reach_below(outline, rotation);
    return std::max(on_layer, ground.height(outline, rotation, x, y)) - sink;
}

void Draft::add_static(ShapeId shape, const Pose& pose) {
    Body body;
    body.shape = shape;
    body.pose = pose;
    body.motion = Motion::Static;
    plan.scene.add_body(body);
}

void Draft::add_shape(Shape shape, Outline outline) {
    shapes.push_back(plan.scene.add_shape(std::move(shape)));
    plan.outlines.push_back(std::move(outline));
}

double Draft::bound() const {
    double most = 0.0;
    for (const Outline& outline : plan.outlines) most = std::max(most, outline.bound());
    return most;
}

std::vector<Column> square_of_columns(std::size_t edge, double pitch) {
    std::vector<Column> columns;
    const double middle = 0.5 * static_cast<double>(edge - 1);
    for (std::size_t j = 0; j < edge; ++j)
        for (std::size_t i = 0; i < edge; ++i)
            columns.push_back({pitch * (static_cast<double>(i) - middle), pitch * (static_cast<double>(j) - middle),
                               0.0, static_cast<std::uint32_t>(i % 2 + 2 * (j % 2))});
    return columns;
}

void fill(Draft& draft, const std::vector<Column>& columns, const Pile& pile, double above) {
    FallPlan& plan = draft.plan;
    plan.statics = plan.scene.row_count();
    const std::vector<Place> places = lowest_places(columns, pile.layer, draft.count - plan.statics);
    plan_rest(draft, columns, pile, places);
    for (const Faller& faller : plan.fallers) above = std::max(above, faller.rest.z);
    const double bound = draft.bound(), gap = 1.8 * bound;
    for (std::size_t i = 0; i < places.size(); ++i) {
        Faller& faller = plan.fallers[i];
        const Column& column = columns[places[i].column];
        const double slot = 4.0 * places[i].layer + column.colour + draft.random.unit();
        faller.position = {faller.rest.x, faller.rest.y, above + 2.0 * bound + gap * slot};
        const std::array<double, 4> q = draft.random.unit_vector<4>();
        faller.rotation = {q[0], q[1], q[2], q[3]};
        const std::array<double, 3> axis = draft.random.direction();
        const double rate = draft.random.between(1.0, 5.0);
        faller.spin = {rate * axis[0], rate * axis[1], rate * axis[2]};
        faller.bounce = draft.random.between(0.2, 0.35);
    }
    plan_velocities(draft, pile.pitch, bound);
    for (const Faller& faller : plan.fallers) {
        Body body;
        body.shape = draft.shapes[faller.outline];
        body.pose = {faller.position, faller.rotation};
        body.velocity = faller.velocity;
        body.angular_velocity = faller.spin;
        plan.scene.add_body(body);
    }
}

}  // namespace clinch::scenes
