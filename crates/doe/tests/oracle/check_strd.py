"""Recomputes every certified value of the StRD fixtures in exact rational arithmetic.

A misprint in a data file or in certified.json shows here, without trusting any regression code:
the normal equations are solved over the fractions, where they lose nothing.

    python3 crates/doe/tests/oracle/check_strd.py
"""

import csv
import json
import pathlib
from decimal import Decimal, getcontext
from fractions import Fraction

getcontext().prec = 60
FOLDER = pathlib.Path(__file__).parent.parent / "data" / "strd"


def decimal(fraction):
    return Decimal(fraction.numerator) / Decimal(fraction.denominator)


def rows_of(model, x):
    if model.startswith("polynomial"):
        degree = int(model.split()[-1])
        return [[r[0] ** k for k in range(degree + 1)] for r in x]
    if model == "x without intercept":
        return [list(r) for r in x]
    return [[Fraction(1)] + list(r) for r in x]


def solve(a, columns):
    n = len(a)
    a = [row[:] + [c[i] for c in columns] for i, row in enumerate(a)]
    for i in range(n):
        pivot = next(r for r in range(i, n) if a[r][i] != 0)
        a[i], a[pivot] = a[pivot], a[i]
        a[i] = [v / a[i][i] for v in a[i]]
        for r in range(n):
            if r != i and a[r][i] != 0:
                a[r] = [v - a[r][i] * w for v, w in zip(a[r], a[i])]
    return [[a[i][n + k] for i in range(n)] for k in range(len(columns))]


def agree(name, what, ours, certified):
    ours, certified = Decimal(ours), Decimal(repr(certified))
    # 15 printed digits: half a unit of the last is up to 5e-15.
    error = abs(ours - certified) if certified == 0 else abs(ours / certified - 1)
    if error > Decimal("6e-15"):
        raise SystemExit(f"{name} {what}: exact {ours:.20g}, certified {certified}")


for name, c in json.load(open(FOLDER / "certified.json")).items():
    table = list(csv.reader(open(FOLDER / f"{name}.csv")))[1:]
    y = [Fraction(r[0]) for r in table]
    x = [[Fraction(v) for v in r[1:]] for r in table]
    X = rows_of(c["model"], x)
    p = len(X[0])
    xtx = [[sum(r[i] * r[j] for r in X) for j in range(p)] for i in range(p)]
    xty = [sum(r[i] * v for r, v in zip(X, y)) for i in range(p)]
    unit = [[Fraction(int(i == k)) for i in range(p)] for k in range(p)]
    beta, *inverse = solve(xtx, [xty] + unit)
    rss = sum((v - sum(b * r for b, r in zip(beta, row))) ** 2 for v, row in zip(y, X))
    intercept = c["model"] != "x without intercept"
    mean = sum(y) / len(y) if intercept else 0
    sst = sum((v - mean) ** 2 for v in y)
    df = len(y) - p
    s2 = rss / df
    for i in range(p):
        agree(name, f"estimate {i}", decimal(beta[i]), c["estimate"][i])
        agree(name, f"sd {i}", decimal(s2 * inverse[i][i]).sqrt(), c["standard_deviation"][i])
    agree(name, "residual sd", decimal(s2).sqrt(), c["residual_sd"])
    agree(name, "r2", decimal(1 - rss / sst), c["r2"])
    agree(name, "regression ss", decimal(sst - rss), c["regression_ss"])
    agree(name, "residual ss", decimal(rss), c["residual_ss"])
    assert (df, p - intercept) == (c["residual_df"], c["regression_df"])
    if c["f"] is not None:
        agree(name, "F", decimal((sst - rss) / (p - intercept) / s2), c["f"])
    print(name, "agrees with its certified values")
