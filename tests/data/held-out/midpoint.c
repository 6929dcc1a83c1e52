/* Implicit midpoint rule (order 2), solved by fixed-point iteration; written against pinwheel_law.h alone.
 * Shafts, wheels and sleeves are points of a list, each turning about a pin; only angles and rates are unknown. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include "pinwheel_law.h"

#define MOST 512

typedef struct { double angle, rate; } spin;

static pinwheel_law *gear;
static int count;
static int32_t parent[MOST];
static double offset[MOST][2], weight[MOST], inertia[MOST], state[MOST][6], load[MOST][3], total;

static int stop(int status) { fprintf(stderr, "%s\n", pinwheel_law_error()); return status; }

/* Positions of all bodies at time t for given spins. */
static void place(double t, const spin *s)
{
    int b;
    for (b = 0; b < count; b++) {
        double a = b ? s[b].angle : pinwheel_law_rate(gear) * t, w = b ? s[b].rate : pinwheel_law_rate(gear);
        double px = offset[b][0], py = offset[b][1], turn = 0, speed = 0;
        if (parent[b] >= 0) { turn = state[parent[b]][2]; speed = state[parent[b]][5]; }
        state[b][0] = px * cos(turn) - py * sin(turn);
        state[b][1] = px * sin(turn) + py * cos(turn);
        state[b][2] = a;
        state[b][3] = -speed * state[b][1];
        state[b][4] = speed * state[b][0];
        state[b][5] = w;
    }
}

static double lever(int b) { return state[b][0] * load[b][1] - state[b][1] * load[b][0]; }

static int accelerate(double t, const spin *s, double *alpha)
{
    int b;
    double torque;
    place(t, s);
    if (pinwheel_law_loads(gear, &state[0][0], &load[0][0])) return 1;
    torque = load[1][2] + pinwheel_law_load_torque(gear, t);
    for (b = 2; b < count; b++) {
        alpha[b] = load[b][2] / inertia[b];
        if (parent[b] == 1) torque += lever(b);
    }
    alpha[0] = 0;
    alpha[1] = torque / total;
    return 0;
}

int main(int argc, char **argv)
{
    static spin now[MOST], middle[MOST];
    static double alpha[MOST];
    char name[3000];
    double *when, h;
    int64_t rows, row;
    int b, e = 0, i = 0;
    FILE *out;

    if (argc < 2) return 2;
    if (pinwheel_law_abi() != PINWHEEL_LAW_ABI || pinwheel_law_open(argv[1], &gear)) return stop(2);
    count = pinwheel_law_bodies(gear);
    if (count < 0 || count > MOST) { fprintf(stderr, "at most %d bodies\n", MOST); return 4; }
    rows = pinwheel_law_samples(gear, NULL, 0);
    when = malloc((size_t)rows * sizeof *when);
    pinwheel_law_samples(gear, when, rows);
    pinwheel_law_start(gear, &state[0][0]);
    snprintf(name, sizeof name, "%s/courses.csv", argv[1]);
    out = fopen(name, "w");
    if (!when || !out) return 2;
    fputs("time_s,input_torque_n_m,output_torque_n_m,output_angle_rad", out);
    for (b = 0; b < count; b++) {
        pinwheel_law_body(gear, b, &parent[b], offset[b], &weight[b], &inertia[b]);
        now[b].angle = state[b][2];
        now[b].rate = state[b][5];
        if (b == 1) total = inertia[1];
        if (b > 1 && parent[b] == 1) {
            total += weight[b] * (offset[b][0] * offset[b][0] + offset[b][1] * offset[b][1]);
            fprintf(out, ",internal_sleeve_force_n_%d", i++);
        }
        if (b > 1 && parent[b] == -1) fprintf(out, ",external_sleeve_force_n_%d", e++);
    }
    fputc('\n', out);
    for (row = 0; row < rows; row++) {
        double driver, output = 0, t = when[row];
        int64_t n, k;
        int again;
        if (accelerate(t, now, alpha)) return stop(3);
        driver = -load[0][2];
        for (b = 2; b < count; b++) {
            if (parent[b] == 0) driver -= lever(b);
            if (parent[b] == 1) output += lever(b);
        }
        fprintf(out, "%.17g,%.17g,%.17g,%.17g", t, driver, output, state[1][2]);
        for (b = 2; b < count; b++)
            if (parent[b] != 0) fprintf(out, ",%.17g", sqrt(load[b][0] * load[b][0] + load[b][1] * load[b][1]));
        fputc('\n', out);
        if (row + 1 == rows) break;
        n = (int64_t)ceil((when[row + 1] - t) / pinwheel_law_step(gear) - 1e-6);
        h = (when[row + 1] - t) / (double)n;
        for (k = 0; k < n; k++, t += h) {
            for (again = 0; again < 8; again++) {
                double moved = 0;
                for (b = 0; b < count; b++) {
                    double rate = now[b].rate + 0.5 * h * alpha[b];
                    moved = fmax(moved, fabs(rate - middle[b].rate) / (1.0 + fabs(rate)));
                    middle[b].rate = rate;
                    middle[b].angle = now[b].angle + 0.5 * h * rate;
                }
                if (again && moved < 1e-13) break;
                if (accelerate(t + 0.5 * h, middle, alpha)) return stop(3);
            }
            for (b = 1; b < count; b++) {
                now[b].angle += h * middle[b].rate;
                now[b].rate += h * alpha[b];
            }
        }
    }
    fclose(out);
    pinwheel_law_close(gear);
    return 0;
}
