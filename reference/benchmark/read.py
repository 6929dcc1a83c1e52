"""Holds time series of a solver against a case: `python read.py paper mine.csv 1e-4`. Needs nothing but Python."""

import csv
import math
import sys
from pathlib import Path


def columns(path):
    """Columns of a CSV file by name."""
    with open(path, newline="") as file:
        names, *rows = csv.reader(file)
    table = {name: [float(row[i]) for row in rows] for i, name in enumerate(names)}
    if not all(math.isfinite(x) for column in table.values() for x in column):
        raise ValueError(f"{path} has values that are not finite")
    return table


def judge(case, mine):
    """For each quantity: its name, the largest difference, the benchmark's uncertainty, the largest value."""
    truth, mine = columns(Path(case, "time_series.csv")), columns(mine)
    row = {round(t * 1e7): i for i, t in enumerate(mine["time_s"])}  # your samples may be denser
    for known in csv.DictReader(Path(case, "uncertainty.csv").open()):
        quantity, window = known["quantity"], (float(known["from_s"]) - 1e-9, float(known["to_s"]) + 1e-9)
        group = [name for name in truth if name == quantity or name.rpartition("_")[0] == quantity]
        at = [i for i, t in enumerate(truth["time_s"]) if window[0] <= t <= window[1]]
        pairs = [(truth[c][i], mine[c][row[round(truth["time_s"][i] * 1e7)]]) for c in group for i in at]
        yield quantity, max(abs(a - b) for a, b in pairs), float(known["largest"]), max(abs(a) for a, _ in pairs)


if __name__ == "__main__":
    case, limit = Path(__file__).parent / sys.argv[1], float(sys.argv[3])
    worst = 0.0
    for quantity, difference, uncertainty, scale in judge(case, sys.argv[2]):
        worst = max(worst, (difference - uncertainty) / scale)
        print(f"{quantity}: differs by {difference:.1e} +- {uncertainty:.1e}, largest value {scale:.3e}")
    sys.exit(not worst <= limit)  # 1 where something differs for certain by more than the limit 
