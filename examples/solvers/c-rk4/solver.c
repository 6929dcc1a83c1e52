/* A solver in C: Runge's and Kutta's method of order 4 at the scene's step, contact forces by libpinwheel_law.
 *
 *     cc -O2 -o solver solver.c -L"$(pinwheel solver library)" -lpinwheel_law -lm
 *     pinwheel compare paper --solver solver.toml
 *
 * All bodies are pinned at their centres, so each has one unknown: its angle. The input turns at a constant rate. */
#include "pinwheel_law.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static pinwheel_law *law;
static int bodies, *carrier;
static double rate, output_moment, *seat, *mass, *moment, *states, *loads;

/* Says why, on the last line of stderr, and ends with a status of the protocol: 3 diverged, 4 unsupported, 1 else. */
static void give_up(int status, const char *what)
{
    fprintf(stderr, "%s: %s\n", what, pinwheel_law_error());
    exit(status);
}

/* Fills `states` and `loads` at time t from angles and rates y; `slope` becomes their derivative. */
static void evaluate(double t, const double *y, double *slope)
{
    int k;
    double torque;
    for (k = 0; k < bodies; k++) {
        double *own = states + 6 * k, *on = carrier[k] < 0 ? NULL : states + 6 * carrier[k];
        double c = on ? cos(on[2]) : 1.0, s = on ? sin(on[2]) : 0.0, spin = on ? on[5] : 0.0;
        own[0] = c * seat[2 * k] - s * seat[2 * k + 1];
        own[1] = s * seat[2 * k] + c * seat[2 * k + 1];
        own[2] = k == 0 ? rate * t : y[k];
        own[3] = -spin * own[1];
        own[4] = spin * own[0];
        own[5] = k == 0 ? rate : y[bodies + k];
    }
    if (pinwheel_law_loads(law, states, loads) != 0)
        give_up(3, "no forces");
    torque = loads[5] + pinwheel_law_load_torque(law, t);
    for (k = 0; k < bodies; k++) {
        slope[k] = states[6 * k + 5];
        slope[bodies + k] = loads[3 * k + 2] / moment[k];
        if (carrier[k] == 1)
            torque += states[6 * k] * loads[3 * k + 1] - states[6 * k + 1] * loads[3 * k];
    }
    slope[bodies] = 0.0;
    slope[bodies + 1] = torque / output_moment;
}

/* One row of courses.csv from `states` and `loads`. */
static void record(FILE *file, double t)
{
    int k;
    double driver = -loads[2], output = loads[5];
    for (k = 2; k < bodies; k++) {
        double turning = states[6 * k] * loads[3 * k + 1] - states[6 * k + 1] * loads[3 * k];
        if (carrier[k] == 0)
            driver -= turning;
        if (carrier[k] == 1)
            output += turning;
    }
    fprintf(file, "%.17g,%.17g,%.17g,%.17g", t, driver, output, states[6 + 2]);
    for (k = 2; k < bodies; k++)
        if (carrier[k] != 0)
            fprintf(file, ",%.17g", hypot(loads[3 * k], loads[3 * k + 1]));
    for (k = 2; k < bodies; k++)
        if (carrier[k] == 0)
            fprintf(file, ",%.17g", states[6 * k + 2]);
    for (k = 1; k < bodies; k++)
        fprintf(file, ",%.17g", states[6 * k + 5]);
    fprintf(file, "\n");
}

int main(int argc, char **argv)
{
    char path[4096];
    int k, stage, n, external = 0, internal = 0;
    long sample, samples, step, steps, all = 0;
    double *times, *y, *at, *slope, *sum;
    FILE *file;

    if (argc < 2 || pinwheel_law_open(argv[1], &law) != 0)
        give_up(1, "give a job folder");
    bodies = pinwheel_law_bodies(law);
    n = 2 * bodies;
    rate = pinwheel_law_rate(law);
    samples = (long)pinwheel_law_samples(law, NULL, 0);
    carrier = calloc((size_t)bodies, sizeof *carrier);
    seat = calloc((size_t)(2 * bodies), sizeof *seat);
    mass = calloc((size_t)bodies, sizeof *mass);
    moment = calloc((size_t)bodies, sizeof *moment);
    states = calloc((size_t)(6 * bodies), sizeof *states);
    loads = calloc((size_t)(3 * bodies), sizeof *loads);
    times = calloc((size_t)samples, sizeof *times);
    y = calloc((size_t)(4 * n), sizeof *y);
    at = y + n, slope = at + n, sum = slope + n;
    pinwheel_law_samples(law, times, samples);
    pinwheel_law_start(law, states);

    snprintf(path, sizeof path, "%s/courses.csv", argv[1]);
    if (!(file = fopen(path, "w")))
        give_up(1, path);
    fprintf(file, "time_s,input_torque_n_m,output_torque_n_m,output_angle_rad");
    for (k = 0; k < bodies; k++) {
        int32_t on;
        pinwheel_law_body(law, k, &on, seat + 2 * k, mass + k, moment + k);
        carrier[k] = (int)on;
        y[k] = states[6 * k + 2];
        y[bodies + k] = states[6 * k + 5];
        if (k == 1)
            output_moment = moment[1];
        if (on == 1)
            output_moment += mass[k] * (seat[2 * k] * seat[2 * k] + seat[2 * k + 1] * seat[2 * k + 1]);
        if (k > 1 && on == -1)
            fprintf(file, ",external_sleeve_force_n_%d", external++);
        if (on == 1)
            fprintf(file, ",internal_sleeve_force_n_%d", internal++);
    }
    /* States: with them Pinwheel says which part of a solver differs. */
    for (k = 0; k < bodies - 2 - external - internal; k++)
        fprintf(file, ",wheel_angle_rad_%d", k);
    fprintf(file, ",output_rate_rad_s");
    for (k = 0; k < bodies - 2 - external - internal; k++)
        fprintf(file, ",wheel_rate_rad_s_%d", k);
    for (k = 0; k < external; k++)
        fprintf(file, ",external_sleeve_rate_rad_s_%d", k);
    for (k = 0; k < internal; k++)
        fprintf(file, ",internal_sleeve_rate_rad_s_%d", k);
    fprintf(file, "\n");

    for (sample = 0; sample < samples; sample++) {
        evaluate(times[sample], y, slope);
        record(file, times[sample]);
        if (sample % 100 == 0)
            fprintf(stderr, "@t %g\n", times[sample]);
        if (sample + 1 == samples)
            break;
        /* Whole steps to the next sample, no longer than the scene's. */
        steps = (long)ceil((times[sample + 1] - times[sample]) / pinwheel_law_step(law) * (1.0 - 1e-9));
        for (step = 0; step < steps; step++) {
            static const double node[4] = {0.0, 0.5, 0.5, 1.0}, weight[4] = {1.0, 2.0, 2.0, 1.0};
            double h = (times[sample + 1] - times[sample]) / (double)steps, t = times[sample] + (double)step * h;
            memset(sum, 0, (size_t)n * sizeof *sum);
            for (stage = 0; stage < 4; stage++) {
                for (k = 0; k < n; k++)
                    at[k] = y[k] + (stage ? node[stage] * h * slope[k] : 0.0);
                evaluate(t + node[stage] * h, at, slope);
                for (k = 0; k < n; k++)
                    sum[k] += weight[stage] * slope[k];
            }
            for (k = 0; k < n; k++)
                y[k] += h / 6.0 * sum[k];
        }
        all += steps;
    }
    fclose(file);
    snprintf(path, sizeof path, "%s/result.json", argv[1]);
    if ((file = fopen(path, "w"))) {
        fprintf(file, "{\"steps\": %ld, \"degrees_of_freedom\": %d, \"settings\": \"RK4\"}\n", all, bodies - 1);
        fclose(file);
    }
    pinwheel_law_close(law);
    return 0;
}
