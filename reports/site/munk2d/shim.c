// One call that builds a space from numbers, steps it and records poses: all that the page asks of Munk2D.
// The numbers are those of reports/site/live.py: gravity (2), the number of bodies, the bodies, the pivots.

#include "chipmunk/chipmunk.h"
#include <emscripten.h>
#include <stdlib.h>

enum { BODY = 11, PIVOT = 6 };

EMSCRIPTEN_KEEPALIVE
void munk_run(const double *plan, int length, double dt, int iterations, double error_bias, int samples, int every,
              double *out)
{
    cpSpace *space = cpSpaceNew();
    cpSpaceSetGravity(space, cpv(plan[0], plan[1]));
    cpSpaceSetIterations(space, iterations);
    int count = (int)plan[2];
    cpBody **bodies = calloc(count, sizeof(cpBody *));
    const double *own = plan + 3;
    for (int i = 0; i < count; i++, own += BODY) {
        cpBody *body = own[0] ? cpBodyNewKinematic() : cpBodyNew(own[1], own[2]);
        cpBodySetPosition(body, cpv(own[3], own[4]));
        cpBodySetAngle(body, own[5]);
        cpBodySetVelocity(body, cpv(own[6], own[7]));
        cpBodySetAngularVelocity(body, own[8]);
        bodies[i] = cpSpaceAddBody(space, body);
    }
    int pivots = (int)(plan + length - own) / PIVOT;
    cpConstraint **joints = calloc(pivots, sizeof(cpConstraint *));
    cpBody *ground = cpSpaceGetStaticBody(space);
    for (int i = 0; i < pivots; i++, own += PIVOT) {
        cpBody *first = own[0] < 0 ? ground : bodies[(int)own[0]];
        cpBody *second = own[1] < 0 ? ground : bodies[(int)own[1]];
        joints[i] = cpPivotJointNew2(first, second, cpv(own[2], own[3]), cpv(own[4], own[5]));
        cpConstraintSetErrorBias(joints[i], error_bias);
        cpSpaceAddConstraint(space, joints[i]);
    }
    for (int sample = 0; sample <= samples; sample++) {
        for (int step = 0; sample && step < every; step++) cpSpaceStep(space, dt);
        for (int i = 0; i < count; i++) {
            cpVect place = cpBodyGetPosition(bodies[i]);
            *out++ = place.x;
            *out++ = place.y;
            *out++ = cpBodyGetAngle(bodies[i]);
        }
    }
    for (int i = 0; i < pivots; i++) {
        cpSpaceRemoveConstraint(space, joints[i]);
        cpConstraintFree(joints[i]);
    }
    for (int i = 0; i < count; i++) {
        cpSpaceRemoveBody(space, bodies[i]);
        cpBodyFree(bodies[i]);
    }
    cpSpaceFree(space);
    free(joints);
    free(bodies);
}
