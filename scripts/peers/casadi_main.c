// The works of benches/works/mod.rs done with C code that CasADi generated (scripts/peers/casadi_panda.py): `casadi NAME COUNT`.
//
// As with the Rust side, the program is run with two counts and the difference is taken. The step is that of the
// six-instant look-ahead formula of Wang and Guo (2020) on two arms with full poses. It watches nothing, and its path is computed
// beforehand.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "panda_generated.h"

enum { STEPS = 20000, JOINTS = 7, STATES = 6 };
static const double SIGMA = 1e-3, H = 0.4, PI = 3.14159265358979323846;

// Position, rotation by columns, twist.
typedef struct {
    double position[3], rotation[9], twist[6];
} Reference;

typedef struct {
    Reference* path;
    double states[STATES][JOINTS];
    int newest, n;
} Arm;

static void pose_of(const double* q, double* position, double* rotation, double* jacobian) {
    const double* inputs[] = {q};
    double* outputs[] = {position, rotation, jacobian};
    pose(inputs, outputs, NULL, NULL, 0);
}

static void begin(Arm* arm, const double* q) {
    double position[3], rotation[9], jacobian[42];
    pose_of(q, position, rotation, jacobian);
    arm->newest = arm->n = 0;
    arm->path = malloc((STEPS + 1) * sizeof(Reference));
    for (int k = 0; k < STATES; ++k) memcpy(arm->states[k], q, sizeof arm->states[k]);
    for (int k = 0; k <= STEPS; ++k) {
        // A circle of 5 cm that begins at rest: u = sin^2(pi t / (2 T)).
        const double tau = (double)k / STEPS, s = sin(PI * tau / 2), u = s * s;
        const double rate = PI / 2 * sin(PI * tau) / (STEPS * SIGMA), angle = 2 * PI * u, r = 0.05;
        Reference* reference = &arm->path[k];
        const double offset[3] = {r * cos(angle) - r, r * sin(angle), 0};
        for (int i = 0; i < 3; ++i) reference->position[i] = position[i] + offset[i];
        memcpy(reference->rotation, rotation, sizeof rotation);
        const double twist[6] = {-r * sin(angle) * 2 * PI * rate, r * cos(angle) * 2 * PI * rate, 0, 0, 0, 0};
        memcpy(reference->twist, twist, sizeof twist);
    }
}

static void step(Arm* arm) {
    // gamma sums to 2 in this row: h = sigma k gamma(1).
    const double gain = H / (SIGMA * 2.0);
    const Reference* wanted = &arm->path[arm->n % STEPS];
    double velocity[JOINTS];
    const double* inputs[] = {arm->states[arm->newest], wanted->position, wanted->rotation, wanted->twist, &gain};
    double* outputs[] = {velocity};
    evaluation(inputs, outputs, NULL, NULL, 0);
    const double* at[STATES];
    for (int age = 0; age < STATES; ++age) at[age] = arm->states[(arm->newest + age) % STATES];
    double next[JOINTS];
    for (int i = 0; i < JOINTS; ++i)
        next[i] = (5.0 / 24) * at[0][i] + (12.0 / 24) * at[1][i] + (6.0 / 24) * at[2][i] + (4.0 / 24) * at[3][i] -
                  (3.0 / 24) * at[4][i] + 2.0 * SIGMA * velocity[i];
    arm->newest = (arm->newest + STATES - 1) % STATES;
    memcpy(arm->states[arm->newest], next, sizeof next);
    ++arm->n;
}

int main(int argc, char** argv) {
    if (argc != 3) return fprintf(stderr, "usage: casadi NAME COUNT\n"), 2;
    const int count = atoi(argv[2]);
    double q[JOINTS] = {0.1, -0.4, 0.2, -2.1, 0.3, 1.8, 0.6}, sum = 0;
    if (strcmp(argv[1], "kinematics panda") == 0) {
        double position[3], rotation[9], jacobian[42];
        for (int i = 0; i < count; ++i) {
            q[0] += 1e-9;
            pose_of(q, position, rotation, jacobian);
            sum += jacobian[0] + position[0];
        }
    } else if (strcmp(argv[1], "step 2 pandas") == 0) {
        static Arm arms[2];
        begin(&arms[0], q);
        begin(&arms[1], q);
        for (int i = 0; i < count; ++i) {
            if (arms[0].n == STEPS) arms[0].n = arms[1].n = 0;
            step(&arms[0]);
            step(&arms[1]);
        }
        for (int i = 0; i < JOINTS; ++i) sum += arms[0].states[arms[0].newest][i] + arms[1].states[arms[1].newest][i];
    } else {
        return fprintf(stderr, "unknown work %s\n", argv[1]), 2;
    }
    printf("%.17g\n", sum);
    return 0;
}
