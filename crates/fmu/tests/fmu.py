"""A unit in fmpy: `fmu.py UNIT.fmu COURSES.csv`. Called by fmu.rs; prints what is measured, ends with 1 at the first fault."""

import csv
import math
import shutil
import sys
from datetime import datetime, timezone

import fmpy
from fmpy import fmi2
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Slave
from fmpy.validation import validate_fmu

# Variables, and the columns of a run that they are.
COMPARED = {
    "input_torque_n_m": "input_torque_n_m",
    "output_torque_n_m": "output_torque_n_m",
    "output_angle_rad": "output_angle_rad",
    "external_sleeve_force_n[4]": "external_sleeve_force_n_3",
}
# Measured: docs/fmu.md.
LIMIT = 1e-6


def relative(own, wanted):
    off = math.fsum((a - b) ** 2 for a, b in zip(own, wanted))
    return math.sqrt(off / math.fsum(b * b for b in wanted))


def compare(unit, courses):
    with open(courses, newline="") as file:
        rows = list(csv.DictReader(file))
    times = [float(row["time_s"]) for row in rows]
    sample = times[1]
    for step in (1e-3, 1e-4, 1e-5):
        every, steps = max(1, round(step / sample)), max(1, round(sample / step))
        # Of a co-simulation unit the interval is the communication step.
        result = fmpy.simulate_fmu(unit, stop_time=times[-1], output_interval=step, output=list(COMPARED))[::steps]
        wanted = rows[::every]
        assert len(result) == len(wanted), (len(result), len(wanted))
        for name, column in COMPARED.items():
            off = relative(result[name], [float(row[column]) for row in wanted])
            print(f"step {step:g} s: {name} differs by {off:.1e}")
            assert off < LIMIT, (step, name, off)


def heeds(unit):
    """The importer's tolerance acts."""
    column = "external_sleeve_force_n[4]"
    own, coarse = (
        fmpy.simulate_fmu(unit, stop_time=5e-3, output_interval=1e-3, relative_tolerance=tolerance, output=[column])
        for tolerance in (None, 1e-3)
    )
    off = relative(coarse[column], own[column])
    print(f"a tolerance of 1e-3 moves a force by {off:.1e}")
    assert off > 10.0 * LIMIT, off


def slave(unit, folder, heard):
    description = fmpy.read_model_description(unit)
    one = FMU2Slave(
        guid=description.guid,
        unzipDirectory=folder,
        modelIdentifier=description.coSimulation.modelIdentifier,
        instanceName="one",
    )

    def hear(_environment, _name, status, category, message, *_rest):
        heard.append((status, category, message))

    callbacks = fmi2.fmi2CallbackFunctions()
    callbacks.logger = fmi2.fmi2CallbackLoggerTYPE(hear)
    callbacks.allocateMemory = fmi2.fmi2CallbackAllocateMemoryTYPE(fmi2.calloc)
    callbacks.freeMemory = fmi2.fmi2CallbackFreeMemoryTYPE(fmi2.free)
    one.instantiate(callbacks=callbacks, loggingOn=True)
    return one, {v.name: v.valueReference for v in description.modelVariables}


def rollback(unit, folder):
    one, references = slave(unit, folder, [])
    outputs = [references[name] for name in COMPARED]
    one.setupExperiment()
    one.enterInitializationMode()
    one.exitInitializationMode()
    one.doStep(0.0, 1e-3)

    def ahead():
        values = []
        for k in range(1, 6):
            one.setReal([references["drive_speed_rad_s"]], [50.0 + k])
            one.doStep(k * 1e-3, 1e-3)
            values += one.getReal(outputs)
        return values

    state = one.getFMUstate()
    wanted = ahead()
    one.setFMUstate(state)
    assert ahead() == wanted
    data = one.serializeFMUstate(state)
    one.freeFMUstate(state)
    again = one.deSerializeFMUstate(data)
    one.setFMUstate(again)
    assert ahead() == wanted
    one.terminate()
    one.freeInstance()
    print(f"rollback exact, a state takes {len(data)} bytes")


def refusals(unit, folder):
    heard = []
    one, references = slave(unit, folder, heard)

    def refused(call):
        before = len(heard)
        try:
            call()
        except FMICallException:
            assert len(heard) > before, "nothing was logged"
            return
        raise AssertionError("not refused")

    refused(lambda: one.doStep(0.0, 1e-3))
    refused(lambda: one.setReal([99999], [1.0]))
    refused(lambda: one.setReal([references["drive_speed_rad_s"]], [math.nan]))
    refused(lambda: one.setReal([references["output_angle_rad"]], [1.0]))
    one.setupExperiment()
    one.enterInitializationMode()
    one.exitInitializationMode()
    refused(lambda: one.setReal([references["contact.stiffness_multiplier"]], [2.0]))
    refused(lambda: one.doStep(0.5, 1e-3))
    one.doStep(0.0, 1e-3)
    one.freeInstance()
    print(f"refused with words: {heard[0][2]}")


def main(unit, courses):
    problems = validate_fmu(unit)
    assert not problems, problems
    print("fmpy.validate_fmu finds nothing")
    description = fmpy.read_model_description(unit)
    assert description.author == 'A. "B" & C' and description.license == "MIT OR Apache-2.0", description
    made = datetime.fromisoformat(description.generationDateAndTime)
    assert abs(datetime.now(timezone.utc) - made).total_seconds() < 3600.0, made
    compare(unit, courses)
    heeds(unit)
    folder = fmpy.extract(unit)
    try:
        rollback(unit, folder)
        refusals(unit, folder)
    finally:
        shutil.rmtree(folder, ignore_errors=True)


main(*sys.argv[1:])
