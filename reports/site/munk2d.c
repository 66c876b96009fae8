// A function for the page: it builds a space from numbers, steps it and records poses and twists. `space_of` in
// reports/site/live/models.py defines the numbers. Velocities are per second; the unit of time of the space is `unit` seconds.

#include "chipmunk/chipmunk_private.h"
#include <emscripten.h>
#include <math.h>
#include <stdlib.h>

enum { HEAD = 8, BODY = 11 };
enum { PIVOT = 1, GROOVE, CIRCLE, SEGMENT, POLYGON, ZEROED, AIMED };

typedef struct {
    cpSpace *space;
    cpBody **bodies;
    cpConstraint **joints;
    cpShape **shapes;
    int body_count, joint_count, shape_count;
    double unit;
} World;

static cpBody *body_of(World *world, double index)
{
    return index < 0 ? cpSpaceGetStaticBody(world->space) : world->bodies[(int)index];
}

static void add_joint(World *world, cpConstraint *joint, double error_bias)
{
    cpConstraintSetErrorBias(joint, error_bias);
    world->joints[world->joint_count++] = cpSpaceAddConstraint(world->space, joint);
}

// A shape collides only with shapes of its own category: the two shapes of one rolling contact.
static void add_shape(World *world, cpShape *shape, const double *own)
{
    cpShapeSetFriction(shape, own[1]);
    cpShapeSetFilter(shape, cpShapeFilterNew(CP_NO_GROUP, (cpBitmask)own[2], (cpBitmask)own[2]));
    world->shapes[world->shape_count++] = cpSpaceAddShape(world->space, shape);
}

static void add_polygon(World *world, const double *own, int numbers)
{
    int corners = (numbers - 3) / 2;
    cpVect *points = calloc(corners, sizeof(cpVect));
    for (int i = 0; i < corners; i++) points[i] = cpv(own[3 + 2 * i], own[4 + 2 * i]);
    add_shape(world, cpPolyShapeNewRaw(body_of(world, own[0]), corners, points, 0), own);
    free(points);
}

static void add_record(World *world, int part, const double *own, int numbers, double error_bias)
{
    cpBody *first = body_of(world, own[0]);
    cpBody *second = part <= GROOVE ? body_of(world, own[1]) : NULL;
    cpVect one = numbers > 3 ? cpv(own[2], own[3]) : cpvzero;
    cpVect two = numbers > 5 ? cpv(own[4], own[5]) : cpvzero;
    switch (part) {
    case PIVOT: add_joint(world, cpPivotJointNew2(first, second, one, two), error_bias); break;
    case GROOVE: add_joint(world, cpGrooveJointNew(first, second, one, two, cpv(own[6], own[7])), error_bias); break;
    case CIRCLE: add_shape(world, cpCircleShapeNew(first, own[3], two), own); break;
    case SEGMENT: add_shape(world, cpSegmentShapeNew(first, two, cpv(own[6], own[7]), own[3]), own); break;
    case POLYGON: add_polygon(world, own, numbers); break;
    case AIMED: cpConstraintSetErrorBias(world->joints[(int)own[1]], 1.0); break;
    }
}

// A groove under the place of the blade after the step; as AimedGroove in engines/pymunk/joints/slide.py.
static void aim(World *world, const double *own, double dt)
{
    cpBody *body = world->bodies[(int)own[0]];
    cpConstraint *groove = world->joints[(int)own[1]];
    cpVect place = cpBodyGetPosition(body), velocity = cpBodyGetVelocity(body);
    double x = place.x + velocity.x * dt, y = place.y + velocity.y * dt;
    double angle = cpBodyGetAngle(body) + cpBodyGetAngularVelocity(body) * dt + own[2];
    cpGrooveJointSetGrooveA(groove, cpv(x + own[3] * cos(angle), y + own[3] * sin(angle)));
    cpGrooveJointSetGrooveB(groove, cpv(x + own[4] * cos(angle), y + own[4] * sin(angle)));
}

// Set the velocity across the blade to zero; as Zeroed in engines/pymunk/joints/slide.py.
static void zero(World *world, const double *own)
{
    cpBody *body = world->bodies[(int)own[0]];
    double angle = cpBodyGetAngle(body) + own[1], rate = cpBodyGetAngularVelocity(body);
    cpVect velocity = cpBodyGetVelocity(body);
    double left_x = -sin(angle), left_y = cos(angle);
    double across = velocity.x * left_x + velocity.y * left_y + own[2] * rate;
    double push = own[3] * across;
    cpBodySetVelocity(body, cpv(velocity.x - push * left_x, velocity.y - push * left_y));
    if (own[4]) cpBodySetAngularVelocity(body, rate - own[4] * across);
}

static void step(World *world, const double *records, const double *end, double dt)
{
    for (const double *at = records; at < end; at += 2 + (int)at[1])
        if (at[0] == AIMED) aim(world, at + 2, dt);
    cpSpaceStep(world->space, dt);
    for (const double *at = records; at < end; at += 2 + (int)at[1])
        if (at[0] == ZEROED) zero(world, at + 2);
}

static void add_bodies(World *world, const double *own)
{
    for (int i = 0; i < world->body_count; i++, own += BODY) {
        cpBody *body = own[0] ? cpBodyNewKinematic() : cpBodyNew(own[1], own[2]);
        cpBodySetPosition(body, cpv(own[3], own[4]));
        cpBodySetAngle(body, own[5]);
        cpBodySetVelocity(body, cpv(own[6] * world->unit, own[7] * world->unit));
        cpBodySetAngularVelocity(body, own[8] * world->unit);
        world->bodies[i] = cpSpaceAddBody(world->space, body);
    }
}

static void release(World *world)
{
    for (int i = 0; i < world->joint_count; i++) {
        cpSpaceRemoveConstraint(world->space, world->joints[i]);
        cpConstraintFree(world->joints[i]);
    }
    for (int i = 0; i < world->shape_count; i++) {
        cpSpaceRemoveShape(world->space, world->shapes[i]);
        cpShapeFree(world->shapes[i]);
    }
    for (int i = 0; i < world->body_count; i++) {
        cpSpaceRemoveBody(world->space, world->bodies[i]);
        cpBodyFree(world->bodies[i]);
    }
    cpSpaceFree(world->space);
    free(world->joints);
    free(world->shapes);
    free(world->bodies);
}

static double *record(World *world, double *out)
{
    for (int i = 0; i < world->body_count; i++) {
        cpBody *body = world->bodies[i];
        cpVect place = cpBodyGetPosition(body), velocity = cpBodyGetVelocity(body);
        double own[] = {place.x, place.y, cpBodyGetAngle(body), velocity.x / world->unit, velocity.y / world->unit,
                        cpBodyGetAngularVelocity(body) / world->unit};
        for (int j = 0; j < 6; j++) *out++ = own[j];
    }
    return out;
}

// Runs samples * every steps of dt units and records each sample; then, if `last` is not 0, takes one step more, of so
// many iterations, and records the bodies and what each joint's impulse has grown to: two numbers a joint [N s].
EMSCRIPTEN_KEEPALIVE
void munk_run(const double *plan, int length, double dt, double unit, int iterations, double error_bias, int samples,
              int every, int last, double *out)
{
    World world = {.space = cpSpaceNew(), .body_count = (int)plan[4], .unit = unit};
    cpSpaceSetGravity(world.space, cpv(plan[0] * unit * unit, plan[1] * unit * unit));
    cpSpaceSetCollisionSlop(world.space, plan[2]);
    cpSpaceSetCollisionBias(world.space, plan[3]);
    cpSpaceSetIterations(world.space, iterations);
    world.bodies = calloc(world.body_count, sizeof(cpBody *));
    world.joints = calloc(length, sizeof(cpConstraint *));
    world.shapes = calloc(length, sizeof(cpShape *));
    add_bodies(&world, plan + HEAD);
    const double *records = plan + HEAD + BODY * world.body_count, *end = plan + length;
    for (const double *at = records; at < end; at += 2 + (int)at[1])
        add_record(&world, (int)at[0], at + 2, (int)at[1], error_bias);
    out = record(&world, out);
    for (int sample = 0; sample < samples; sample++) {
        for (int count = 0; count < every; count++) step(&world, records, end, dt);
        out = record(&world, out);
    }
    if (last) {
        cpSpaceSetIterations(world.space, last);
        step(&world, records, end, dt);
        out = record(&world, out);
        for (int i = 0; i < world.joint_count; i++) {
            cpVect impulse = cpConstraintIsPivotJoint(world.joints[i])
                ? ((cpPivotJoint *)world.joints[i])->jAcc : cpv(cpConstraintGetImpulse(world.joints[i]), 0);
            *out++ = impulse.x / unit;
            *out++ = impulse.y / unit;
        }
    }
    release(&world);
}
