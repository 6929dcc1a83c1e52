/* A solver whose contact law is its own, written from the equations: Runge-Kutta 4 on the angles, the law `paper` with exact
 * contact, friction, and wheels cut at an offset (docs/physics.md#contact). The library gives start, masses and load alone.
 *
 *     solver JOB FAULT
 *
 * FAULT: none; friction, curvature, inertia, phase, step, damping, long-step, search, sum, driver, order, exponent, away (with one disc). Plane vectors are complex numbers. */
#include "pinwheel_law.h"

#include <complex.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MOST 256
typedef double complex point;

static const char *fault;
static char job[4000000];
static int bodies, wheels, outer, inner, carrier[MOST];
static double rate, step_s, output_moment, mass[MOST], moment[MOST], angle[MOST], spin[MOST], turning[MOST];
static point seat[MOST], place[MOST], speed[MOST], force[MOST];
static pinwheel_law *law;

/* Is there this fault? */
static int has(const char *name) { return strcmp(fault, name) == 0; }

static void give_up(int status, const char *what)
{
    fprintf(stderr, "%s: %s\n", what, pinwheel_law_error());
    exit(status);
}

/* A number of scene.json; lists of that name are passed over. */
static double key(const char *name, double otherwise)
{
    char quoted[80], *at = job, *end;
    snprintf(quoted, sizeof quoted, "\"%s\":", name);
    while ((at = strstr(at, quoted))) {
        double value = strtod(at += strlen(quoted), &end);
        if (end != at)
            return value;
    }
    return otherwise;
}

static double dot(point a, point b) { return creal(a * conj(b)); }
static double cross(point a, point b) { return cimag(conj(a) * b); }
static point unit(double a) { return CMPLX(cos(a), sin(a)); }
/* A turn by a small angle. */
static point slight(double a) { return CMPLX(1.0 - 0.5 * a * a, a); }
static double within(double x, double low, double high) { return fmin(fmax(x, low), high); }

/* One contact: point w and normal n (from the sleeve) in the ground frame, penetration, effective radius. */
static void touch(int wheel, int sleeve, point w, point n, double depth, double radius)
{
    static double factor, damping, ramp, mu, slide;
    double compliance, share, normal, friction;
    point gap, pull;
    if (!factor) {
        compliance = 2.0 * (1.0 - pow(key("poisson", 0), 2)) / (M_PI * key("young_pa", 0));
        factor = 4.0 * key("stiffness_multiplier", 1) / (3.0 * M_PI * compliance);
        damping = key("damping_n_s_m", 0), ramp = key("ramp_m", 0);
        mu = key("friction_coefficient", 0), slide = key("friction_ramp_m_s", 1);
    }
    if (depth <= 0.0)
        return;
    gap = speed[sleeve] + I * spin[sleeve] * (w - place[sleeve]) - speed[wheel] - I * spin[wheel] * (w - place[wheel]);
    share = fmin(depth / ramp, 1.0);
    normal = share * factor * sqrt(radius) * pow(depth, has("exponent") ? 1.49 : 1.5) + (has("damping") ? 1.0 : share) * damping * dot(gap, n);
    normal = fmax(normal, 0.0);
    friction = (has("friction") ? mu : -mu) * normal * within(dot(gap, I * n) / slide, -1.0, 1.0);
    pull = n * (-normal + I * friction);
    force[sleeve] += pull, force[wheel] -= pull;
    turning[sleeve] += cross(w - place[sleeve], pull), turning[wheel] -= cross(w - place[wheel], pull);
}

/* The profile against a ring pin; `back` turns the ground frame into the wheel's. */
static void on_profile(int wheel, int sleeve, point back)
{
    static double e, big, m, q, cut;
    static int zk;
    /* The generating curve C(a) = R e^ia + e e^(i zk a): where the pin's centre lies on it, R e^ia is that centre from the axis. */
    double a = carg(place[sleeve] * back), depth, kappa, c, radius;
    point p = (place[sleeve] - place[wheel]) * back, turn, wave, first, second, n;
    int k;
    if (!zk) {
        zk = outer, e = key("eccentricity_m", 0), q = key("external_sleeve_radius_m", 0);
        cut = q + key("equidistant_m", 0);
        big = e * zk / key("shortening", 1) + key("radial_m", 0), m = e * zk / big;
    }
    /* Newton squares an error of a: after a small correction no other is needed. */
    for (k = 0; k < 60; k++) {
        turn = unit(a), wave = unit((zk - 1) * a);
        first = I * big * turn * (1.0 + m * wave), second = -big * turn * (1.0 + zk * m * wave);
        n = p - turn * (big + e * wave);
        c = dot(n, first) / (dot(first, first) - dot(n, second));
        a += c;
        if (fabs(c) < 1e-6)
            break;
    }
    turn *= slight(c), wave *= slight((zk - 1) * c);
    n = turn * (1.0 + m * wave) / cabs(1.0 + m * wave);
    depth = q - cut - dot(p - turn * (big + e * wave), n);
    if (depth <= 0.0)
        return;
    c = creal(wave);
    kappa = (1.0 + zk * m * m + (zk + 1) * m * c) / (big * pow(1.0 + m * m + 2.0 * m * c, 1.5));
    radius = q * (1.0 - cut * kappa) / (1.0 + (q - cut) * kappa);
    if (kappa < 0.0 && has("curvature")) /* a pit as if it were a hill of its radius */
        radius = q * (cut - 1.0 / kappa) / (q + cut - 1.0 / kappa);
    wave = turn * (big + e * wave) - cut * n, turn = conj(back);
    touch(wheel, sleeve, place[wheel] + turn * wave, -turn * n, depth, radius);
}

/* Everything at time t from the angles and rates y; `slope` becomes their derivative. */
static void evaluate(double t, const double *y, double *slope)
{
    static double rim, r, circle;
    double torque = pinwheel_law_load_torque(law, t);
    int k, j;
    if (!rim)
        rim = key("hole_radius_m", 0), r = key("internal_sleeve_radius_m", 0), circle = key("internal_circle_radius_m", 0);
    for (k = 0; k < bodies; k++) {
        angle[k] = k ? y[k] : rate * t, spin[k] = k ? y[bodies + k] : rate;
        place[k] = seat[k] * (carrier[k] < 0 ? 1.0 : unit(angle[carrier[k]]));
        speed[k] = carrier[k] < 0 ? 0.0 : I * spin[carrier[k]] * place[k];
        force[k] = turning[k] = 0.0;
    }
    for (k = 2; k < 2 + wheels; k++) {
        double start = (M_PI - 2 * M_PI * (k - 2) / wheels) / (outer - 1);
        point back = unit(-angle[k]);
        for (j = 2 + wheels; j < 2 + wheels + outer; j++)
            if (!has("search") || j != 2 + wheels + 3)
                on_profile(k, j, back);
        for (j = 0; j < inner; j++) {
            int sleeve = 2 + wheels + outer + j;
            point hole = place[k] + circle * unit((2 * M_PI * j / inner - start + angle[k]));
            point n = (place[sleeve] - hole) / cabs(place[sleeve] - hole);
            touch(k, sleeve, hole + rim * n, n, r - rim + cabs(place[sleeve] - hole), rim * r / (rim - r));
        }
    }
    for (k = 0; k < bodies; k++) {
        slope[k] = spin[k], slope[bodies + k] = turning[k] / moment[k];
        if (carrier[k] == 1)
            torque += cross(place[k], force[k]);
    }
    slope[bodies] = 0.0, slope[bodies + 1] = torque / output_moment;
}

int main(int argc, char **argv)
{
    static double times[100001], states[6 * MOST], y[2 * MOST], at[2 * MOST], slope[2 * MOST], sum[2 * MOST];
    char path[4096], *list;
    int errors = 0;
    long sample, samples, step, steps, all = 0, calls = 0;
    int k, stage;
    FILE *file;

    if (argc < 3 || pinwheel_law_open(argv[1], &law) != 0)
        give_up(1, "give a job folder and a fault");
    fault = argv[2];
    snprintf(path, sizeof path, "%s/scene.json", argv[1]);
    if (!(file = fopen(path, "r")) || fread(job, 1, sizeof job - 1, file) == 0)
        give_up(1, path);
    fclose(file);
    bodies = pinwheel_law_bodies(law);
    samples = (long)pinwheel_law_samples(law, times, 100001);
    /* Errors of single sleeves and holes stand in lists: none may hold a number. */
    if ((list = strstr(job, "\"errors\"")))
        errors = list[strcspn(list, "}")] && strcspn(list, "0123456789") < strcspn(list, "}");
    if (errors || bodies > MOST || samples > 100001 || strstr(job, "\"points\"") || strstr(job, "\"adams\"") || key("rotational_rad", 0) != 0) {
        fprintf(stderr, "at most 256 bodies and 100001 samples, exact contact, regularised friction, no errors, flanks that are not turned\n");
        return 4;
    }
    rate = pinwheel_law_rate(law), step_s = pinwheel_law_step(law) * (has("long-step") ? 2.0 : 1.0);
    pinwheel_law_start(law, states);
    snprintf(path, sizeof path, "%s/courses.csv", argv[1]);
    if (!(file = fopen(path, "w")))
        give_up(1, path);
    fprintf(file, "time_s,input_torque_n_m,output_torque_n_m,output_angle_rad");
    for (k = 0; k < bodies; k++) {
        double centre[2];
        int32_t on;
        pinwheel_law_body(law, k, &on, centre, mass + k, moment + k);
        carrier[k] = on, seat[k] = centre[0] + I * centre[1];
        y[k] = states[6 * k + 2], y[bodies + k] = states[6 * k + 5];
        if (on == 0)
            wheels++;
        if (on == 1)
            output_moment += has("inertia") ? 0.0 : mass[k] * pow(cabs(seat[k]), 2);
        if (k > 1 && on == -1)
            fprintf(file, ",external_sleeve_force_n_%d", outer++);
        if (on == 1)
            fprintf(file, ",internal_sleeve_force_n_%d", inner++);
    }
    if (has("away") && wheels == 1)
        give_up(3, "it ran away");
    for (k = 0; k < wheels; k++)
        fprintf(file, ",wheel_angle_rad_%d", k);
    fprintf(file, ",output_rate_rad_s");
    for (k = 0; k < wheels; k++)
        fprintf(file, ",wheel_rate_rad_s_%d", k);
    for (k = 0; k < outer; k++)
        fprintf(file, ",external_sleeve_rate_rad_s_%d", k);
    for (k = 0; k < inner; k++)
        fprintf(file, ",internal_sleeve_rate_rad_s_%d", k);
    output_moment += moment[1];
    seat[1 + wheels] *= unit((has("phase") ? 1e-3 : 0.0));
    fprintf(file, "\n");
    for (sample = 0; sample < samples; sample++) {
        double driver = 0.0, output = 0.0;
        evaluate(times[sample], y, slope);
        for (k = 2; k < bodies; k++) {
            driver -= carrier[k] == 0 && !(has("driver") && k == 3) ? cross(place[k], force[k]) : 0.0;
            output += carrier[k] == 1 ? cross(place[k], force[k]) : 0.0;
        }
        output *= has("sum") ? 1.02 : 1.0;
        fprintf(file, "%.17g,%.17g,%.17g,%.17g", times[sample], driver, output, angle[1]);
        for (k = 2; k < bodies; k++)
            if (carrier[k] != 0)
                fprintf(file, ",%.17g", cabs(force[k]));
        for (k = 2; k < 2 + wheels; k++)
            fprintf(file, ",%.17g", angle[k]);
        for (k = 1; k < bodies; k++)
            fprintf(file, ",%.17g", spin[k]);
        fprintf(file, "\n");
        if (sample + 1 == samples)
            break;
        steps = (long)ceil((times[sample + 1] - times[sample]) / step_s * (1.0 - 1e-9));
        for (step = 0; step < steps; step++) {
            static const double node[4] = {0.0, 0.5, 0.5, 1.0}, weight[4] = {1.0, 2.0, 2.0, 1.0};
            double h = (times[sample + 1] - times[sample]) / (double)steps, t = times[sample] + (double)step * h;
            memset(sum, 0, sizeof sum);
            for (stage = 0; stage < 4; stage++, calls++) {
                for (k = 0; k < 2 * bodies; k++)
                    at[k] = y[k] + (stage ? (has("order") ? 0.5 : node[stage]) * h * slope[k] : 0.0);
                evaluate(t + node[stage] * h, at, slope);
                for (k = 0; k < 2 * bodies; k++)
                    sum[k] += weight[stage] * slope[k];
            }
            for (k = 0; k < 2 * bodies; k++)
                y[k] += (has("step") ? 2.0 : 1.0) * h / 6.0 * sum[k];
        }
        all += steps;
    }
    fclose(file);
    snprintf(path, sizeof path, "%s/result.json", argv[1]);
    if ((file = fopen(path, "w"))) {
        fprintf(file, "{\"steps\": %ld, \"right_hand_sides\": %ld, \"settings\": \"RK4\"}\n", all, calls);
        fclose(file);
    }
    pinwheel_law_close(law);
    return 0;
}
