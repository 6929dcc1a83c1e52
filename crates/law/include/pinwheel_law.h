/* The contact law, geometry, start state and load of a Pinwheel scene, for solvers in any language.
 *
 * Build the library with `cargo build --release -p pinwheel-law`; it is then target/release/libpinwheel_law.so
 * (.dylib, pinwheel_law.dll). Your solver integrates, this library says what the contacts do.
 *
 * What is modelled
 *   A planar gearbox of rigid bodies. Each body turns about its centre of mass, which is pinned on its carrier:
 *   shafts and ring pins on the housing, discs on the eccentrics of the input shaft, output pins on
 *   the output shaft. The input shaft turns at a constant rate. What is left to integrate are the angles of the
 *   output shaft, of the discs, and, with friction, of the sleeves; or all coordinates with joints as constraints.
 *   Where discs lie on elastic bearings, their carrier is -2: nothing pins them, all three of their coordinates are
 *   free, and the loads of pinwheel_law_loads hold what their bearings do to them and to the input shaft.
 *
 * Units and frame
 *   SI: m, kg, s, N, N m, rad. The ground frame is right-handed with its origin on the common axis of both shafts;
 *   angles, rates and moments are positive counter-clockwise. At time 0 the input shaft stands at angle 0 and the
 *   eccentric of disc i of n at the angle 2 pi i/n from the x axis. A disc's own frame has its x axis through the
 *   tip of a lobe; its angle at t = 0 is that of pinwheel_law_start.
 *
 * Order of bodies
 *   0 input shaft, 1 output shaft, then discs, ring pins (number 0 at angle 0, counter-clockwise), internal
 *   sleeves. Discs are the bodies with carrier 0 or -2, output pins those with carrier 1, ring pins those
 *   from 2 on with carrier -1.
 *
 * Arrays
 *   states: six numbers a body, x y angle vx vy rate, of its centre in the ground frame.
 *   loads:  three numbers a body, fx fy moment, of its contacts alone: forces in the ground frame, moment about the
 *           body's centre. The load torque, joints and the driver are yours.
 *   Arrays are yours; the library reads or writes them during the call and keeps nothing of them.
 *
 * What a run must record (columns of courses.csv)
 *   input_torque_n_m    the torque that holds the input shaft's rate. With pinned centres it is minus the contact
 *                       moment on the input (0) minus the sum over the discs of (x fy - y fx).
 *   output_torque_n_m   moment of the output pins' forces about the output's centre: sum of (x fy - y fx).
 *   output_angle_rad    angle of body 1.
 *   external_sleeve_force_n_0.., internal_sleeve_force_n_0..   sqrt(fx^2 + fy^2) of each sleeve.
 *   The load torque acts on the output shaft: J alpha = moment + sum of (x fy - y fx) over output pins + load,
 *   where J is the output's moment plus mass times radius squared of each output pin.
 *
 * Errors
 *   Functions that return an int32_t give 0 (or a count) or one of the negative statuses below; those that return a
 *   double give NaN. What a failed call should have written is NaN, except by a handle that is not open, which
 *   does not know how many numbers that would be. pinwheel_law_error has the words, with a remedy.
 *
 * Threads
 *   Handles are independent: use one a thread. (Threads that share one are safe, but wait for each other.)
 *   A handle has no history: the same states give the same loads to the last bit, in any order of calls.
 */
#ifndef PINWHEEL_LAW_H
#define PINWHEEL_LAW_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Version of this interface. A program compiled with this header must find pinwheel_law_abi() == PINWHEEL_LAW_ABI. */
#define PINWHEEL_LAW_ABI 2

/* Statuses. */
#define PINWHEEL_LAW_OK 0
#define PINWHEEL_LAW_ARGUMENT (-1)   /* a null address, a handle that is not open, an index out of range */
#define PINWHEEL_LAW_SCENE (-2)      /* the scene cannot be found, read or modelled */
#define PINWHEEL_LAW_NOT_FINITE (-3) /* states, time or loads are no finite numbers */
#define PINWHEEL_LAW_FAULT (-4)      /* a fault in the library */

/* A scene that is open. The pointer is a token: never follow it. */
typedef struct pinwheel_law pinwheel_law;

/* PINWHEEL_LAW_ABI of the library. */
uint32_t pinwheel_law_abi(void);

/* Opens `scene`: a job folder (which holds scene.json), a scene file (TOML, or JSON), the text of a scene (it has a
 * line break, `=` or `{`), or the name of a preset ("paper"). UTF-8. `*out` becomes the handle, or null on failure.
 * Takes milliseconds; with drive.start = "equilibrium" it solves for the loaded gear at rest. */
int32_t pinwheel_law_open(const char *scene, pinwheel_law **out);

/* Number of bodies: 28 for the preset "paper". */
int32_t pinwheel_law_bodies(const pinwheel_law *law);

/* One body: the index of its carrier (-1: the housing; -2: none, a free body); the seat of its centre in the carrier's
 * frame, whose origin is the carrier's centre (in the ground frame for -1 and -2), m; its mass; its moment of inertia
 * about its centre. Addresses may be null for what is not wanted. */
int32_t pinwheel_law_body(const pinwheel_law *law, int32_t body, int32_t *carrier, double seat_m[2], double *mass_kg,
                          double *moment_kg_m2);

/* The constant rate of the input shaft, rad/s. */
double pinwheel_law_rate(const pinwheel_law *law);

/* The scene's solver.step_s, s: the step of methods with fixed steps. Studies of cost and accuracy change it. */
double pinwheel_law_step(const pinwheel_law *law);

/* Returns the number of samples of the time series, or a negative status. The first `room` sample times (s) are written to
 * `times_s`, which may be null where room is 0. The first is 0, the last the end of the run; the last interval may be
 * shorter than the others. */
int64_t pinwheel_law_samples(const pinwheel_law *law, double *times_s, int64_t room);

/* The states at t = 0, six numbers a body. All engines start from these. */
int32_t pinwheel_law_start(const pinwheel_law *law, double *states);

/* The contact forces at `states` (six numbers a body): three numbers a body. Friction, where the scene has it, is part of
 * them. `states` and `loads` must not overlap. */
int32_t pinwheel_law_loads(pinwheel_law *law, const double *states, double *loads);

/* The load's torque on the output shaft at a time (s), N m; where it jumps, what it jumps to. The output of a gear with
 * a positive input rate turns clockwise, so that a positive load opposes it. */
double pinwheel_law_load_torque(const pinwheel_law *law, double time_s);

/* Returns the number of calls of pinwheel_law_loads on this handle; 0 for a handle that is not open. */
uint64_t pinwheel_law_calls(const pinwheel_law *law);

/* Why the last call of this thread that failed did so, one line of UTF-8; empty if none did. Valid until the next
 * call of this thread. */
const char *pinwheel_law_error(void);

/* Closes a handle. Null and handles that are closed already do nothing. A handle that was opened on a job folder adds a
 * line with its number of calls to law_calls.txt there, by which the harness sees how often forces were asked for. */
void pinwheel_law_close(pinwheel_law *law);

#ifdef __cplusplus
}
#endif

#endif
