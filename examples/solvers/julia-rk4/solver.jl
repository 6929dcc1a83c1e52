# A solver in Julia: Runge's and Kutta's method of order 4 at the scene's step, contact forces by libpinwheel_law.
#
#     pinwheel compare paper --solver solver.toml
#
# All bodies are pinned at their centres, so each has one unknown: its angle. The input turns at a constant rate.
using Libdl, Printf

const job, library = ARGS[1], dlopen(ARGS[2])
symbol(name) = dlsym(library, "pinwheel_law_" * name)
const handle = Ref{Ptr{Cvoid}}(C_NULL)
if ccall(symbol("open"), Cint, (Cstring, Ref{Ptr{Cvoid}}), job, handle) != 0
    println(stderr, unsafe_string(ccall(symbol("error"), Cstring, ())))
    exit(1)
end
const law = handle[]
const n = Int(ccall(symbol("bodies"), Cint, (Ptr{Cvoid},), law))
const rate = ccall(symbol("rate"), Cdouble, (Ptr{Cvoid},), law)
const longest = ccall(symbol("step"), Cdouble, (Ptr{Cvoid},), law)
const states, loads = zeros(6, n), zeros(3, n)
const carrier, seat, mass, moment = zeros(Cint, n), zeros(2, n), zeros(n), zeros(n)
for k in 1:n
    on, at, m, j = Ref{Cint}(0), zeros(2), Ref{Cdouble}(0), Ref{Cdouble}(0)
    ccall(symbol("body"), Cint, (Ptr{Cvoid}, Cint, Ref{Cint}, Ptr{Cdouble}, Ref{Cdouble}, Ref{Cdouble}),
          law, k - 1, on, at, m, j)
    carrier[k], seat[:, k], mass[k], moment[k] = on[], at, m[], j[]
end
const output_moment = moment[2] + sum(mass[k] * sum(abs2, seat[:, k]) for k in 1:n if carrier[k] == 1)
const loads_function, torque_function = symbol("loads"), symbol("load_torque")

"Moment about the origin of the contact force on body k."
turning(k) = states[1, k] * loads[2, k] - states[2, k] * loads[1, k]

"Fills states and loads at time t from angles y[:, 1] and rates y[:, 2]; returns their derivative."
function slope(t, y)
    for k in 1:n
        on = carrier[k] + 1
        s, c = on > 0 ? sincos(states[3, on]) : (0.0, 1.0)
        spin = on > 0 ? states[6, on] : 0.0
        x = c * seat[1, k] - s * seat[2, k]
        z = s * seat[1, k] + c * seat[2, k]
        states[:, k] .= (x, z, k == 1 ? rate * t : y[k, 1], -spin * z, spin * x, k == 1 ? rate : y[k, 2])
    end
    if ccall(loads_function, Cint, (Ptr{Cvoid}, Ptr{Cdouble}, Ptr{Cdouble}), law, states, loads) != 0
        println(stderr, "no forces: the states are no numbers any more")
        exit(3)
    end
    dy = hcat(states[6, :], loads[3, :] ./ moment)
    torque = loads[3, 2] + ccall(torque_function, Cdouble, (Ptr{Cvoid}, Cdouble), law, t)
    torque += sum(turning(k) for k in 1:n if carrier[k] == 1)
    dy[1, 2], dy[2, 2] = 0.0, torque / output_moment
    dy
end

function main()
    count = ccall(symbol("samples"), Int64, (Ptr{Cvoid}, Ptr{Cdouble}, Int64), law, C_NULL, 0)
    times = zeros(count)
    ccall(symbol("samples"), Int64, (Ptr{Cvoid}, Ptr{Cdouble}, Int64), law, times, count)
    ccall(symbol("start"), Cint, (Ptr{Cvoid}, Ptr{Cdouble}), law, states)
    y = hcat(states[3, :], states[6, :])
    wheels = [k for k in 3:n if carrier[k] == 0]
    internal = [k for k in 3:n if carrier[k] == 1]
    sleeves = [k for k in 3:n if carrier[k] != 0]
    all_steps = 0
    open(joinpath(job, "courses.csv"), "w") do courses
        names = ["time_s", "input_torque_n_m", "output_torque_n_m", "output_angle_rad"]
        append!(names, ["external_sleeve_force_n_$(j - 1)" for j in 1:length(sleeves)-length(internal)])
        append!(names, ["internal_sleeve_force_n_$(j - 1)" for j in 1:length(internal)])
        println(courses, join(names, ","))
        for (sample, time) in enumerate(times)
            slope(time, y)
            driver = -loads[3, 1] - sum(turning, wheels)
            output = loads[3, 2] + sum(turning, internal)
            forces = [hypot(loads[1, k], loads[2, k]) for k in sleeves]
            println(courses, join([time; driver; output; y[2, 1]; forces], ","))
            sample % 100 == 1 && @printf(stderr, "@t %g\n", time)
            sample == count && break
            # Whole steps to the next sample, no longer than the scene's.
            steps = ceil(Int, (times[sample+1] - time) / longest * (1 - 1e-9))
            h = (times[sample+1] - time) / steps
            for step in 1:steps
                t = time + (step - 1) * h
                a = slope(t, y)
                b = slope(t + h / 2, y + h / 2 * a)
                c = slope(t + h / 2, y + h / 2 * b)
                d = slope(t + h, y + h * c)
                y += h / 6 * (a + 2b + 2c + d)
            end
            all_steps += steps
        end
    end
    write(joinpath(job, "result.json"),
          "{\"steps\": $all_steps, \"degrees_of_freedom\": $(n - 1), \"settings\": \"RK4\"}\n")
    ccall(symbol("close"), Cvoid, (Ptr{Cvoid},), law)
end

main()
