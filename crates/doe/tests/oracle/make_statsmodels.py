"""Freezes statsmodels' regression of the thesis's 48 simulated responses.

Full quadratic in the three coded factors, 28 runs a table, with the columns in the order of
doe's ModelTerms::quadratic. Numbers are written with 12 significant digits: the test asks 1e-9.

    pip install numpy scipy statsmodels==0.15.0
    python crates/doe/tests/oracle/make_statsmodels.py
"""

import csv
import json
import pathlib

import numpy as np
import statsmodels
import statsmodels.api as sm
from scipy import stats

ROOT = pathlib.Path(__file__).parents[4]
TABLES = ROOT / "fixtures" / "thesis" / "tables"
OUT = pathlib.Path(__file__).parents[1] / "data" / "statsmodels.json"

FACTORS = {"omega_rpm": (4.0, 30.0), "mu_wall": (0.4, 0.8), "mu_pp": (0.1, 0.9)}
TERMS = ["1", "omega_rpm", "mu_wall", "mu_pp", "omega_rpm*mu_wall", "omega_rpm*mu_pp",
         "mu_wall*mu_pp", "omega_rpm^2", "mu_wall^2", "mu_pp^2"]
RESPONSES = ["aor_lin_deg", "aor_mid_deg", "cen_x_pct", "cen_y_pct"]
CONFIGS = [f"AZ{k}_{wall}" for k in (1, 2, 4, 5, 6, 7) for wall in ("Plexi", "Steel")]


def short(values):
    return [float(f"{v:.12g}") for v in np.atleast_1d(values)]


def one(x, y, points):
    design = np.column_stack([
        np.ones(len(x)), x, x[:, 0] * x[:, 1], x[:, 0] * x[:, 2], x[:, 1] * x[:, 2], x**2])
    fit = sm.OLS(y, design).fit()
    influence = fit.get_influence()
    press = float(np.sum(influence.resid_press**2))
    wall = [i for i, t in enumerate(TERMS) if "mu_wall" in t]
    test = fit.f_test(np.eye(len(TERMS))[wall])
    # Pure error: residual of the model with one mean for each distinct point.
    _, cell = np.unique(points, axis=0, return_inverse=True)
    cell = cell.ravel()
    full = sm.OLS(y, np.eye(cell.max() + 1)[cell]).fit()
    pure, pure_df = float(np.sum((y - full.fittedvalues) ** 2)), len(y) - int(cell.max()) - 1
    lack, lack_df = fit.ssr - pure, fit.df_resid - pure_df
    f_lack = (lack / lack_df) / (pure / pure_df) if pure > 0 else None
    # statsmodels' own weighted fit, with weights that run over the table.
    weights = 1.0 + 0.1 * np.arange(len(y))
    wls = sm.WLS(y, design, weights=weights).fit()
    # Generalised: neighbours in the table correlated by 0.4 a step.
    steps = np.abs(np.subtract.outer(np.arange(len(y)), np.arange(len(y))))
    gls = sm.GLS(y, design, sigma=0.4**steps).fit()
    out = {
        "coefficients": short(fit.params),
        "standard_errors": short(fit.bse),
        "p_values": short(fit.pvalues),
        "interval_95": short(fit.conf_int(0.05).ravel()),
        "r2": short(fit.rsquared)[0],
        "r2_adjusted": short(fit.rsquared_adj)[0],
        "rmse": short(np.sqrt(fit.scale))[0],
        "press": short(press)[0],
        "q2": short(1 - press / fit.centered_tss)[0],
        "f": short(fit.fvalue)[0],
        "leverage": short(influence.hat_matrix_diag),
        "studentised_deleted": short(influence.resid_studentized_external),
        "cooks_distance": short(influence.cooks_distance[0]),
        "f_wall": short(test.fvalue)[0],
        "p_wall": short(test.pvalue)[0],
        "lack_of_fit_ss": short(lack)[0],
        "pure_error_ss": short(pure)[0],
        "df": [int(lack_df), int(pure_df)],
        "f_lack": None if f_lack is None else short(f_lack)[0],
        "p_lack": None if f_lack is None else short(stats.f.sf(f_lack, lack_df, pure_df))[0],
        "skewness": short(stats.skew(y, bias=False))[0],
        "weighted": {"coefficients": short(wls.params), "standard_errors": short(wls.bse),
                     "r2": short(wls.rsquared)[0]},
        "generalised": {"coefficients": short(gls.params), "standard_errors": short(gls.bse)},
    }
    # At the point with coded values 0.5, -0.25, 0.75.
    frame = fit.get_prediction(np.array([[1, .5, -.25, .75, -.125, .375, -.1875, .25, .0625, .5625]]))
    out["predicted_mean"] = short(frame.predicted_mean)[0]
    out["predicted_interval_95"] = short(frame.conf_int(alpha=0.05).ravel())
    out["predicted_new_interval_95"] = short(frame.conf_int(obs=True, alpha=0.05).ravel())
    return out


fits = []
for config in CONFIGS:
    with open(TABLES / f"edem_{config}.csv") as file:
        table = list(csv.DictReader(line for line in file if not line.startswith("#")))
    points = np.array([[float(r[f]) for f in FACTORS] for r in table])
    x = np.column_stack([
        (points[:, j] - (lo + 0.5 * (hi - lo))) / (0.5 * (hi - lo))
        for j, (lo, hi) in enumerate(FACTORS.values())])
    for response in RESPONSES:
        y = np.array([float(r[response]) for r in table])
        fits.append({"config": config, "response": response, "points": points.tolist() if
                     response == RESPONSES[0] else None, "y": y.tolist(), **one(x, y, points)})

with open(OUT, "w") as file:
    command = "python crates/doe/tests/oracle/make_statsmodels.py"
    head = {"command": command, "statsmodels": statsmodels.__version__, "numpy": np.__version__,
            "terms": TERMS}
    file.write(json.dumps(head)[:-1] + ', "fits": [\n')
    file.write(",\n".join(json.dumps(f, separators=(",", ":")) for f in fits))
    file.write("\n]}\n")
print(len(fits), "fits,", OUT.stat().st_size, "bytes")
