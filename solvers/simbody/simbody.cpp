// A gearbox in Simbody: one pin mobilizer a body, the input shaft driven by a prescribed motion, contact forces by
// Pinwheel's law in every realization.
//
//     simbody JOB LAW merson|cpodes
//
// JOB is the folder of one run, LAW the law's library. Coordinates are angles against the carrier, so there are no
// constraints that could drift. Merson is an explicit Runge-Kutta method of order 4 with error control, for scenes
// without friction; CPodes is BDF of variable order with Newton iterations, for stiff ones.

#include <dlfcn.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "Simbody.h"
#include "pinwheel_law.h"

using namespace SimTK;

namespace {

enum Exit { FINISHED = 0, FAILED = 1, DIVERGED = 3 };

constexpr int INPUT = 0;
constexpr int OUTPUT = 1;
constexpr int FREE = -2;

// The run diverged; courses until then are written.
struct Diverged : std::runtime_error {
    using std::runtime_error::runtime_error;
};

// The contact law, loaded at run time so that this program is compiled without it.
class Law {
public:
    struct Body {
        int32_t carrier;
        double seat[2], mass, moment;
    };

    Law(const char* path, const char* job) : library(dlopen(path, RTLD_NOW | RTLD_LOCAL)) {
        if (!library) throw std::runtime_error(dlerror());
        if (find<decltype(&pinwheel_law_abi)>("pinwheel_law_abi")() != PINWHEEL_LAW_ABI)
            throw std::runtime_error("the law's library is of another version than this program");
        call_loads = find<decltype(&pinwheel_law_loads)>("pinwheel_law_loads");
        call_load_torque = find<decltype(&pinwheel_law_load_torque)>("pinwheel_law_load_torque");
        check(find<decltype(&pinwheel_law_open)>("pinwheel_law_open")(job, &handle));
        bodies.resize(find<decltype(&pinwheel_law_bodies)>("pinwheel_law_bodies")(handle));
        for (size_t i = 0; i < bodies.size(); ++i) {
            Body& b = bodies[i];
            check(find<decltype(&pinwheel_law_body)>("pinwheel_law_body")(handle, static_cast<int32_t>(i), &b.carrier,
                                                                         b.seat, &b.mass, &b.moment));
        }
        start.resize(6 * bodies.size());
        check(find<decltype(&pinwheel_law_start)>("pinwheel_law_start")(handle, start.data()));
        auto samples = find<decltype(&pinwheel_law_samples)>("pinwheel_law_samples");
        times.resize(samples(handle, nullptr, 0));
        samples(handle, times.data(), static_cast<int64_t>(times.size()));
        rate = find<decltype(&pinwheel_law_rate)>("pinwheel_law_rate")(handle);
    }

    ~Law() {
        if (handle) find<decltype(&pinwheel_law_close)>("pinwheel_law_close")(handle);
    }

    // Contact loads (fx, fy, moment a body) from states (x, y, angle, vx, vy, rate a body).
    void loads(const std::vector<double>& states, std::vector<double>& loads) const {
        ++calls;
        check(call_loads(handle, states.data(), loads.data()));
    }

    double load_torque(double time) const { return call_load_torque(handle, time); }

    std::vector<Body> bodies;
    std::vector<double> start, times;
    double rate = 0.0;
    mutable unsigned long long calls = 0;

private:
    template <class Function>
    Function find(const char* name) const {
        void* symbol = dlsym(library, name);
        if (!symbol) throw std::runtime_error(std::string("the law's library has no ") + name);
        return reinterpret_cast<Function>(symbol);
    }

    void check(int status) const {
        if (status >= 0) return;
        const char* words = find<decltype(&pinwheel_law_error)>("pinwheel_law_error")();
        if (status == PINWHEEL_LAW_NOT_FINITE) throw Diverged(words);
        throw std::runtime_error(words);
    }

    void* library;
    pinwheel_law* handle = nullptr;
    decltype(&pinwheel_law_loads) call_loads;
    decltype(&pinwheel_law_load_torque) call_load_torque;
};

// Returns a number of the job's description by its key, which is unique there.
double number(const std::string& json, const std::string& key) {
    const size_t at = json.find('"' + key + '"');
    const size_t colon = at == std::string::npos ? at : json.find(':', at);
    if (colon == std::string::npos) throw std::runtime_error("scene.json has no " + key);
    return std::strtod(json.c_str() + colon + 1, nullptr);
}

// Returns the entries of a list of changes in the job's description.
std::vector<std::string> changes(const std::string& json, const std::string& key) {
    std::vector<std::string> entries;
    const size_t begin = json.find('"' + key + '"');
    const size_t end = begin == std::string::npos ? begin : json.find(']', begin);
    if (end == std::string::npos) return entries;
    const std::string list = json.substr(begin, end - begin);
    for (size_t at = list.find('{'); at != std::string::npos; at = list.find('{', at + 1))
        entries.push_back(list.substr(at, list.find('}', at) - at));
    return entries;
}

// Time at which load or speed jumps or bends, for the load (`of_load`) and for the integrator (`time`: the sample within rounding, if
// there is one). A step across it would have a random error.
struct Cut {
    double of_load, time;
};

std::vector<Cut> cuts(const std::string& json, const std::vector<double>& samples) {
    std::vector<double> times{number(json, "load_ramp_s")};
    for (const char* key : {"load_changes", "speed_changes"})
        for (const std::string& one : changes(json, key)) {
            const double time = number(one, "time_s");
            const double ramp = one.find("\"ramp_s\"") == std::string::npos ? 0.0 : number(one, "ramp_s");
            times.push_back(time);
            times.push_back(time + ramp);
        }
    std::sort(times.begin(), times.end());
    std::vector<Cut> cuts;
    for (double time : times) {
        double at = time;
        for (double sample : samples)
            if (std::abs(sample - time) <= 1e-9 * samples.back()) at = sample;
        const double before = cuts.empty() ? 0.0 : cuts.back().time;
        if (at > before && at < samples.back()) cuts.push_back({time, at});
    }
    return cuts;
}

// Contacts and the output's load as forces on the bodies.
class Contacts : public Force::Custom::Implementation {
public:
    Contacts(const Law& law, const SimbodyMatterSubsystem& matter)
        : law(law), matter(matter), states(law.start), loads(3 * law.bodies.size()) {}

    void calcForce(const State& state, Vector_<SpatialVec>& forces, Vector_<Vec3>&, Vector&) const override {
        evaluate(state);
        for (size_t i = 0; i < law.bodies.size(); ++i) {
            const double* load = &loads[3 * i];
            // Mobilized body 0 is the ground.
            forces[static_cast<int>(i) + 1] += SpatialVec(Vec3(0, 0, load[2]), Vec3(load[0], load[1], 0));
        }
        forces[OUTPUT + 1][0][2] += law.load_torque(clock(state.getTime()));
    }

    // The time that chooses load and speed: one within the leg.
    double clock(double time) const { return std::clamp(time, load_from, load_until); }

    Real calcPotentialEnergy(const State&) const override { return 0; }

    // The load from the first cut on, until the next: no step sees both sides of one.
    void begin_leg(std::vector<Cut>& cuts) {
        load_from = cuts.front().of_load;
        cuts.erase(cuts.begin());
        end_leg_before(cuts);
    }

    void end_leg_before(const std::vector<Cut>& cuts) {
        load_until = cuts.empty() ? Infinity : std::nextafter(cuts.front().of_load, 0.0);
    }

    // States and contact loads of the bodies at `state`.
    void evaluate(const State& state) const {
        for (size_t i = 0; i < law.bodies.size(); ++i) {
            const MobilizedBody& body = matter.getMobilizedBody(MobilizedBodyIndex(static_cast<int>(i) + 1));
            const Vec3& at = body.getBodyOriginLocation(state);
            const SpatialVec& velocity = body.getBodyVelocity(state);
            const int carrier = law.bodies[i].carrier;
            double* s = &states[6 * i];
            s[0] = at[0], s[1] = at[1];
            // The angle comes first of a free body, too.
            s[2] = body.getOneQ(state, 0) + (carrier < 0 ? 0.0 : states[6 * carrier + 2]);
            s[3] = velocity[1][0], s[4] = velocity[1][1], s[5] = velocity[0][2];
        }
        law.loads(states, loads);
    }

    const Law& law;
    const SimbodyMatterSubsystem& matter;
    // Mutable buffers: a run has one thread.
    mutable std::vector<double> states, loads;

private:
    double load_from = 0, load_until = Infinity;
};

// Angle of the input over time, in stretches of constant acceleration.
class Turning : public Motion::Custom::Implementation {
public:
    Turning(const std::string& json, double rate, const Contacts& contacts) : contacts(contacts), stretches{{0, 0, rate, 0}} {
        for (const std::string& one : changes(json, "speed_changes")) {
            const double time = number(one, "time_s"), ramp = number(one, "ramp_s"), after = number(one, "input_speed_rad_s");
            const double at = stretches.back().angle + rate * (time - stretches.back().from);
            stretches.push_back({time, at, rate, (after - rate) / ramp});
            stretches.push_back({time + ramp, at + 0.5 * (rate + after) * ramp, after, 0});
            rate = after;
        }
    }

    Motion::Level getLevel(const State&) const override { return Motion::Position; }
    Implementation* clone() const override { return new Turning(*this); }

    void calcPrescribedPosition(const State& state, int, Real* q) const override {
        const Stretch& now = at(state);
        const double since = state.getTime() - now.from;
        *q = now.angle + since * (now.rate + 0.5 * since * now.acceleration);
    }
    void calcPrescribedPositionDot(const State& state, int, Real* u) const override {
        const Stretch& now = at(state);
        *u = now.rate + (state.getTime() - now.from) * now.acceleration;
    }
    void calcPrescribedPositionDotDot(const State& state, int, Real* udot) const override { *udot = at(state).acceleration; }

private:
    struct Stretch {
        double from, angle, rate, acceleration;
    };

    const Stretch& at(const State& state) const {
        const double time = contacts.clock(state.getTime());
        size_t k = stretches.size() - 1;
        while (k > 0 && stretches[k].from > time) --k;
        return stretches[k];
    }

    const Contacts& contacts;
    std::vector<Stretch> stretches;
};

// The contract's courses, one row a sample.
class Courses {
public:
    Courses(const Law& law, const std::string& path) : law(law), file(path) {
        size_t external = 0, internal = 0;
        std::string columns = "time_s,input_torque_n_m,output_torque_n_m,output_angle_rad";
        for (size_t i = OUTPUT + 1; i < law.bodies.size(); ++i) {
            const int carrier = law.bodies[i].carrier;
            if (carrier == INPUT || carrier == FREE) continue;
            sleeves.push_back(i);
            // Ring pins come first: on the housing, or on a ring that is the output.
            columns += carrier == law.bodies[sleeves[0]].carrier ? ",external_sleeve_force_n_" + std::to_string(external++)
                                   : ",internal_sleeve_force_n_" + std::to_string(internal++);
        }
        // States of the discs and cranks, then rates of output and pins.
        static const char* kinds[] = {"x_m", "y_m", "angle_rad", "velocity_x_m_s", "velocity_y_m_s", "rate_rad_s"};
        size_t wheels = 0;
        for (size_t i = OUTPUT + 1; i < law.bodies.size(); ++i) {
            const int carrier = law.bodies[i].carrier;
            if (carrier != INPUT && carrier != FREE) continue;
            for (size_t k = 0; k < 6; ++k)
                add(columns, std::string("wheel_") + kinds[k] + '_' + std::to_string(wheels), 6 * i + k);
            ++wheels;
        }
        add(columns, "output_rate_rad_s", 6 * OUTPUT + 5);
        for (size_t k = 0; k < sleeves.size(); ++k)
            add(columns,
                k < external ? "external_sleeve_rate_rad_s_" + std::to_string(k)
                             : "internal_sleeve_rate_rad_s_" + std::to_string(k - external),
                6 * sleeves[k] + 5);
        file.precision(17);
        file << columns << '\n';
    }

    void row(double time, double input_torque, const std::vector<double>& states, const std::vector<double>& loads) {
        // Couples of sleeves on their pins, and the seal.
        double output_torque = loads[3 * OUTPUT + 2];
        for (size_t body : sleeves)
            if (law.bodies[body].carrier == OUTPUT)
                output_torque += (states[6 * body] - states[6 * OUTPUT]) * loads[3 * body + 1]
                                 - (states[6 * body + 1] - states[6 * OUTPUT + 1]) * loads[3 * body];
        file << time << ',' << input_torque << ',' << output_torque << ',' << states[6 * OUTPUT + 2];
        for (size_t body : sleeves) file << ',' << std::hypot(loads[3 * body], loads[3 * body + 1]);
        for (size_t place : places) file << ',' << states[place];
        file << '\n';
    }

private:
    void add(std::string& columns, const std::string& name, size_t place) {
        columns += ',' + name;
        places.push_back(place);
    }

    const Law& law;
    std::ofstream file;
    std::vector<size_t> sleeves, places;
};

// Integrates to `time`, a cut at the latest; at a cut the load from there on begins.
void advance(Integrator& integrator, double time, Contacts& contacts, std::vector<Cut>& cuts) {
    try {
        while (integrator.getTime() < time) {
            const double limit = cuts.empty() ? Infinity : cuts.front().time;
            const auto status = integrator.stepTo(time, limit);
            if (!cuts.empty() && integrator.getTime() >= limit) {
                contacts.begin_leg(cuts);
                integrator.reinitialize(Stage::Time, false);
            }
            if (status == Integrator::ReachedReportTime || status == Integrator::EndOfSimulation) return;
        }
    } catch (const Exception::Base& error) {
        // Simbody finds no step, however short.
        throw Diverged(error.getMessageText());
    }
}

void run(const std::string& job, const char* library, const std::string& method) {
    const Law law(library, job.c_str());
    std::stringstream description;
    description << std::ifstream(job + "/scene.json").rdbuf();

    MultibodySystem system;
    SimbodyMatterSubsystem matter(system);
    GeneralForceSubsystem forces(system);
    for (const Law::Body& body : law.bodies) {
        // The law's bodies come carriers first. Only the moment about z acts; equal ones are valid for any solid.
        const Body::Rigid rigid(MassProperties(body.mass, Vec3(0), Inertia(body.moment)));
        if (body.carrier == FREE) {
            MobilizedBody::Planar(matter.Ground(), Transform(), rigid, Transform());
            continue;
        }
        MobilizedBody& carrier = matter.updMobilizedBody(MobilizedBodyIndex(body.carrier + 1));
        MobilizedBody::Pin(carrier, Transform(Vec3(body.seat[0], body.seat[1], 0)), rigid, Transform());
    }
    MobilizedBody& input = matter.updMobilizedBody(MobilizedBodyIndex(INPUT + 1));
    const std::string json = description.str();
    std::vector<Cut> cut = cuts(json, law.times);
    Contacts* contacts = new Contacts(law, matter);
    contacts->end_leg_before(cut);
    Force::Custom(forces, contacts);  // the system owns it
    if (changes(json, "speed_changes").empty())
        Motion::Steady(input, law.rate);
    else
        Motion::Custom(input, new Turning(json, law.rate, *contacts));

    State state = system.realizeTopology();
    for (size_t i = 0; i < law.bodies.size(); ++i) {
        const MobilizedBody& body = matter.getMobilizedBody(MobilizedBodyIndex(static_cast<int>(i) + 1));
        const int carrier = law.bodies[i].carrier;
        const double* own = &law.start[6 * i];
        body.setOneQ(state, 0, own[2] - (carrier < 0 ? 0.0 : law.start[6 * carrier + 2]));
        body.setOneU(state, 0, own[5] - (carrier < 0 ? 0.0 : law.start[6 * carrier + 5]));
        if (carrier == FREE)
            for (int axis = 0; axis < 2; ++axis) {
                body.setOneQ(state, axis + 1, own[axis]);
                body.setOneU(state, axis + 1, own[axis + 3]);
            }
    }

    // Simbody scales an error of 1 as a radian and a radian a second; the elastic twist is the relevant scale.
    const bool explicit_method = method == "merson";
    const double accuracy = std::max(number(json, "tolerance") * number(json, "elastic_twist_rad"), 1e-13);
    std::unique_ptr<Integrator> integrator;
    if (explicit_method)
        integrator.reset(new RungeKuttaMersonIntegrator(system));
    else
        integrator.reset(new CPodesIntegrator(system));
    integrator->setAccuracy(accuracy);
    // Steps end at samples: interpolated ones would be less accurate than the steps.
    integrator->setAllowInterpolation(!explicit_method);
    integrator->setFinalTime(law.times.back());
    integrator->initialize(state);

    Courses courses(law, job + "/courses.csv");
    Vector motion;
    for (double time : law.times) {
        advance(*integrator, time, *contacts, cut);
        const State& now = integrator->getState();
        system.realize(now, Stage::Acceleration);
        matter.findMotionForces(now, motion);
        contacts->evaluate(now);
        // Simbody's motion forces stand on the other side of the equation.
        const double torque = -motion[0];
        for (double value : contacts->states)
            if (!std::isfinite(value)) throw Diverged("a state is not finite");
        if (!std::isfinite(torque)) throw Diverged("the driver torque is not finite");
        courses.row(time, torque, contacts->states, contacts->loads);
        std::cerr << "@t " << time << '\n';
    }
    std::ofstream result(job + "/result.json");
    result << "{\"steps\": " << integrator->getNumStepsTaken()
           << ", \"rejected_steps\": " << integrator->getNumStepsAttempted() - integrator->getNumStepsTaken()
           << ", \"right_hand_sides\": " << law.calls << ", \"degrees_of_freedom\": " << state.getNU()
           << ", \"settings\": \"" << (explicit_method ? "Runge-Kutta-Merson" : "CPodes BDF") << ", accuracy " << accuracy
           << "\"}\n";
}

}  // namespace

int main(int count, char** arguments) {
    const std::string method = count == 4 ? arguments[3] : "";
    if (method != "merson" && method != "cpodes") {
        std::cerr << "usage: simbody JOB LAW merson|cpodes\n";
        return FAILED;
    }
    int status = FINISHED;
    std::string words;
    try {
        run(arguments[1], arguments[2], method);
    } catch (const Diverged& error) {
        status = DIVERGED, words = error.what();
    } catch (const std::exception& error) {
        status = FAILED, words = error.what();
    }
    for (char& c : words)
        if (c == '\n') c = ' ';
    if (status != FINISHED) std::cerr << words << '\n';
    return status;
}
