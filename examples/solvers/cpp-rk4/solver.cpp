// A solver in C++: Runge's and Kutta's method of order 4 at the scene's step, contact forces by libpinwheel_law.
//
//     c++ -std=c++17 -O2 -o solver solver.cpp -L"$(pinwheel solver library)" -lpinwheel_law
//     pinwheel compare paper --solver solver.toml
//
// All bodies are pinned at their centres, so each has one unknown: its angle. The input turns at a constant rate.
#include "pinwheel_law.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <string>
#include <vector>

using Vector = std::vector<double>;

// Says why, on the last line of stderr, and ends with a status of the protocol: 3 diverged, 4 unsupported, 1 else.
[[noreturn]] static void give_up(int status, const std::string &what)
{
    std::cerr << what << ": " << pinwheel_law_error() << std::endl;
    std::exit(status);
}

struct Body {
    int32_t carrier = -1;
    double seat[2] = {0, 0}, mass = 0, moment = 0;
};

class Gear {
public:
    std::vector<Body> bodies;
    Vector states, loads;

    explicit Gear(const char *job)
    {
        if (pinwheel_law_abi() != PINWHEEL_LAW_ABI || pinwheel_law_open(job, &law) != 0)
            give_up(1, "give a job folder");
        bodies.resize(static_cast<std::size_t>(pinwheel_law_bodies(law)));
        states.resize(6 * bodies.size());
        loads.resize(3 * bodies.size());
        for (std::size_t k = 0; k < bodies.size(); k++) {
            Body &b = bodies[k];
            pinwheel_law_body(law, static_cast<int32_t>(k), &b.carrier, b.seat, &b.mass, &b.moment);
        }
        output_moment = bodies[1].moment;
        for (const Body &b : bodies)
            if (b.carrier == 1)
                output_moment += b.mass * (b.seat[0] * b.seat[0] + b.seat[1] * b.seat[1]);
        pinwheel_law_start(law, states.data());
    }
    Gear(const Gear &) = delete;
    Gear &operator=(const Gear &) = delete;
    ~Gear() { pinwheel_law_close(law); }

    double step() const { return pinwheel_law_step(law); }

    Vector samples() const
    {
        Vector times(static_cast<std::size_t>(pinwheel_law_samples(law, nullptr, 0)));
        pinwheel_law_samples(law, times.data(), static_cast<int64_t>(times.size()));
        return times;
    }

    // Moment about the origin of the contact force on a body.
    double turning(std::size_t k) const
    {
        return states[6 * k] * loads[3 * k + 1] - states[6 * k + 1] * loads[3 * k];
    }

    // Fills states and loads at time t from angles and rates y; gives their derivative.
    Vector slope(double t, const Vector &y)
    {
        const std::size_t n = bodies.size();
        const double rate = pinwheel_law_rate(law);
        for (std::size_t k = 0; k < n; k++) {
            const Body &b = bodies[k];
            const double *on = b.carrier < 0 ? nullptr : &states[6 * static_cast<std::size_t>(b.carrier)];
            const double c = on ? std::cos(on[2]) : 1.0, s = on ? std::sin(on[2]) : 0.0, spin = on ? on[5] : 0.0;
            double *own = &states[6 * k];
            own[0] = c * b.seat[0] - s * b.seat[1];
            own[1] = s * b.seat[0] + c * b.seat[1];
            own[2] = k == 0 ? rate * t : y[k];
            own[3] = -spin * own[1];
            own[4] = spin * own[0];
            own[5] = k == 0 ? rate : y[n + k];
        }
        if (pinwheel_law_loads(law, states.data(), loads.data()) != 0)
            give_up(3, "no forces");
        Vector dy(2 * n);
        double torque = loads[5] + pinwheel_law_load_torque(law, t);
        for (std::size_t k = 0; k < n; k++) {
            dy[k] = states[6 * k + 5];
            dy[n + k] = loads[3 * k + 2] / bodies[k].moment;
            if (bodies[k].carrier == 1)
                torque += turning(k);
        }
        dy[n] = 0.0;
        dy[n + 1] = torque / output_moment;
        return dy;
    }

private:
    pinwheel_law *law = nullptr;
    double output_moment = 0;
};

static Vector moved(Vector y, double h, const Vector &slope)
{
    for (std::size_t k = 0; k < y.size(); k++)
        y[k] += h * slope[k];
    return y;
}

int main(int argc, char **argv)
{
    if (argc < 2)
        give_up(1, "give a job folder");
    const std::string job = argv[1];
    Gear gear(argv[1]);
    const std::size_t n = gear.bodies.size();
    const Vector times = gear.samples();
    Vector y(2 * n);
    for (std::size_t k = 0; k < n; k++) {
        y[k] = gear.states[6 * k + 2];
        y[n + k] = gear.states[6 * k + 5];
    }

    std::ofstream file(job + "/courses.csv");
    file << std::setprecision(17) << "time_s,input_torque_n_m,output_torque_n_m,output_angle_rad";
    int external = 0, internal = 0;
    for (std::size_t k = 2; k < n; k++) {
        if (gear.bodies[k].carrier == -1)
            file << ",external_sleeve_force_n_" << external++;
        if (gear.bodies[k].carrier == 1)
            file << ",internal_sleeve_force_n_" << internal++;
    }
    // States: with them Pinwheel says which part of a solver differs.
    const int wheels = static_cast<int>(n) - 2 - external - internal;
    for (int k = 0; k < wheels; k++)
        file << ",wheel_angle_rad_" << k;
    file << ",output_rate_rad_s";
    for (int k = 0; k < wheels; k++)
        file << ",wheel_rate_rad_s_" << k;
    for (int k = 0; k < external; k++)
        file << ",external_sleeve_rate_rad_s_" << k;
    for (int k = 0; k < internal; k++)
        file << ",internal_sleeve_rate_rad_s_" << k;
    file << "\n";

    long all = 0;
    for (std::size_t sample = 0; sample < times.size(); sample++) {
        gear.slope(times[sample], y);
        double driver = -gear.loads[2], output = gear.loads[5];
        for (std::size_t k = 2; k < n; k++) {
            driver -= gear.bodies[k].carrier == 0 ? gear.turning(k) : 0.0;
            output += gear.bodies[k].carrier == 1 ? gear.turning(k) : 0.0;
        }
        file << times[sample] << "," << driver << "," << output << "," << y[1];
        for (std::size_t k = 2; k < n; k++)
            if (gear.bodies[k].carrier != 0)
                file << "," << std::hypot(gear.loads[3 * k], gear.loads[3 * k + 1]);
        for (std::size_t k = 2; k < n; k++)
            if (gear.bodies[k].carrier == 0)
                file << "," << y[k];
        for (std::size_t k = 1; k < n; k++)
            file << "," << y[n + k];
        file << "\n";
        if (sample % 100 == 0)
            std::cerr << "@t " << times[sample] << "\n";
        if (sample + 1 == times.size())
            break;
        // Whole steps to the next sample, no longer than the scene's.
        const double length = times[sample + 1] - times[sample];
        const long steps = static_cast<long>(std::ceil(length / gear.step() * (1.0 - 1e-9)));
        const double h = length / static_cast<double>(steps);
        for (long step = 0; step < steps; step++) {
            const double t = times[sample] + static_cast<double>(step) * h;
            const Vector a = gear.slope(t, y);
            const Vector b = gear.slope(t + h / 2, moved(y, h / 2, a));
            const Vector c = gear.slope(t + h / 2, moved(y, h / 2, b));
            const Vector d = gear.slope(t + h, moved(y, h, c));
            for (std::size_t k = 0; k < 2 * n; k++)
                y[k] += h / 6 * (a[k] + 2 * b[k] + 2 * c[k] + d[k]);
        }
        all += steps;
    }
    std::ofstream(job + "/result.json") << "{\"steps\": " << all << ", \"degrees_of_freedom\": " << n - 1
                                        << ", \"settings\": \"RK4\"}\n";
    return 0;
}
