/* Calls every function of pinwheel_law.h and prints what came: forces of argv[1] at its start, with all their digits. */
#include "pinwheel_law.h"

#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define CHECK(condition)                                                                    \
    if (!(condition)) {                                                                     \
        fprintf(stderr, "line %d: %s: %s\n", __LINE__, #condition, pinwheel_law_error());   \
        exit(1);                                                                            \
    }

/* A thread with a handle of its own: its forces are those of `wanted`. */
struct job { const char *scene; const double *wanted; int bodies; };

static void *own_handle(void *given)
{
    const struct job *job = (const struct job *)given;
    pinwheel_law *law;
    int n = job->bodies, k;
    double *states = (double *)malloc(sizeof(double) * 9 * (size_t)n), *loads = states + 6 * n;
    CHECK(pinwheel_law_open(job->scene, &law) == 0);
    CHECK(pinwheel_law_start(law, states) == 0);
    for (k = 0; k < 100; k++) {
        CHECK(pinwheel_law_loads(law, states, loads) == 0);
        CHECK(memcmp(loads, job->wanted, sizeof(double) * 3 * (size_t)n) == 0);
    }
    pinwheel_law_close(law);
    free(states);
    return NULL;
}

int main(int argc, char **argv)
{
    pinwheel_law *law = NULL, *none = NULL;
    pthread_t threads[3];
    struct job job;
    int32_t bodies, k, carrier;
    int64_t samples;
    double *states, *loads, *times, seat[2], mass, moment;

    CHECK(argc == 2);
    CHECK(pinwheel_law_abi() == PINWHEEL_LAW_ABI);
    CHECK(pinwheel_law_open(argv[1], &law) == PINWHEEL_LAW_OK && law != NULL);
    bodies = pinwheel_law_bodies(law);
    CHECK(bodies > 4);
    samples = pinwheel_law_samples(law, NULL, 0);
    states = (double *)malloc(sizeof(double) * 6 * (size_t)bodies);
    loads = (double *)malloc(sizeof(double) * 3 * (size_t)bodies);
    times = (double *)malloc(sizeof(double) * (size_t)samples);
    CHECK(pinwheel_law_samples(law, times, samples) == samples);
    CHECK(times[0] == 0.0 && times[samples - 1] > 0.0);
    CHECK(pinwheel_law_rate(law) != 0.0 && pinwheel_law_step(law) > 0.0);
    CHECK(isfinite(pinwheel_law_load_torque(law, 0.0)));
    CHECK(pinwheel_law_start(law, states) == 0);
    for (k = 0; k < bodies; k++) {
        CHECK(pinwheel_law_body(law, k, &carrier, seat, &mass, &moment) == 0);
        CHECK(carrier >= -1 && carrier < 2 && mass > 0.0 && moment > 0.0);
    }
    CHECK(pinwheel_law_loads(law, states, loads) == 0 && pinwheel_law_calls(law) == 1);
    for (k = 0; k < 3 * bodies; k++)
        printf("%.17g\n", loads[k]);

    job.scene = argv[1];
    job.wanted = loads;
    job.bodies = (int)bodies;
    for (k = 0; k < 3; k++)
        CHECK(pthread_create(&threads[k], NULL, own_handle, &job) == 0);
    for (k = 0; k < 3; k++)
        CHECK(pthread_join(threads[k], NULL) == 0);

    /* What goes wrong says so. */
    CHECK(pinwheel_law_open("papre", &none) == PINWHEEL_LAW_SCENE && none == NULL);
    CHECK(strstr(pinwheel_law_error(), "did you mean the preset `paper`?") != NULL);
    CHECK(pinwheel_law_open(NULL, &none) == PINWHEEL_LAW_ARGUMENT);
    CHECK(pinwheel_law_body(law, bodies, &carrier, seat, &mass, &moment) == PINWHEEL_LAW_ARGUMENT && isnan(mass));
    states[2] = NAN;
    CHECK(pinwheel_law_loads(law, states, loads) == PINWHEEL_LAW_NOT_FINITE && isnan(loads[0]));
    pinwheel_law_close(law);
    pinwheel_law_close(law);
    CHECK(pinwheel_law_bodies(law) == PINWHEEL_LAW_ARGUMENT && isnan(pinwheel_law_rate(law)));
    pinwheel_law_close(NULL);
    free(states);
    free(loads);
    free(times);
    return 0;
}
