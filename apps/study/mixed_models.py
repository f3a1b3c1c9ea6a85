#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Mixed models of the trials of a recorded study, by statsmodels.

Usage: mixed_models.py STUDY/trials.csv [> mixed_models.json]

For each metric, by restricted maximum likelihood (SU-11 of apps/study/METHOD.md):

    metric ~ condition + place,   a random intercept for each participant

Place counts the tracking trials of a participant: its slope is learning or fatigue a trial. Condition B is the base.
Trials that are not in the study's tables (a rule excluded them, or they were repeated) have no say.
Exit status 2 and one line for a table that is not of this form.
"""
import json
import sys
import warnings

METRICS = {"rms_error_mm": "rms error [mm]", "dwell_ratio": "dwell ratio [-]", "crossover_hz": "crossover [Hz]"}
NEEDED = {"participant", "condition", "place", *METRICS.values()}


def fitted(trials, column):
    """One model as a dictionary, or the reason why there is none."""
    import statsmodels.formula.api as formula
    rows = trials[["participant", "condition", "place", column]].rename(columns={column: "metric"}).dropna()
    if rows["participant"].nunique() < 3 or len(rows) <= rows["participant"].nunique() + rows["condition"].nunique():
        return {"reason": "too few participants or trials: 3 participants with several trials each are needed"}
    base = "B" if "B" in set(rows["condition"]) else sorted(set(rows["condition"]))[0]
    terms = f"C(condition, Treatment('{base}')) + place" if rows["condition"].nunique() > 1 else "place"
    with warnings.catch_warnings(record=True) as seen:
        warnings.simplefilter("always")
        fit = formula.mixedlm(f"metric ~ {terms}", rows, groups=rows["participant"]).fit(reml=True)
    low_high = fit.conf_int()
    effects = {}
    for name in fit.fe_params.index:
        level = name.rsplit("[T.", 1)
        key = f"{level[1].rstrip(']')}-{base}" if len(level) == 2 else name.lower()
        effects[key] = {"estimate": float(fit.fe_params[name]), "standard_error": float(fit.bse_fe[name]),
                        "p": float(fit.pvalues[name]), "ci95": [float(edge) for edge in low_high.loc[name]]}
    return {"effects": effects, "participant_variance": float(fit.cov_re.iloc[0, 0]),
            "residual_variance": float(fit.scale), "converged": bool(fit.converged), "trials": len(rows),
            "warnings": sorted({str(entry.message) for entry in seen})}


def main(arguments):
    try:
        import pandas
        import statsmodels  # noqa: F401
    except ImportError as error:
        return f"mixed_models: {error.name} is missing; want the package python3-statsmodels"
    if len(arguments) != 1:
        return "mixed_models: want one argument, the trials.csv of a study"
    try:
        trials = pandas.read_csv(arguments[0], dtype={"participant": str, "session": str, "condition": str})
    except (OSError, ValueError) as error:
        return f"mixed_models: {arguments[0]}: {error}; want the trials.csv of a study"
    missing = sorted(NEEDED - set(trials.columns))
    if missing:
        return f"mixed_models: {arguments[0]}: no column {missing[0]}; want the trials.csv of a study"
    if "in tables" in trials.columns:
        trials = trials[trials["in tables"] == 1]
    print(json.dumps({key: fitted(trials, column) for key, column in METRICS.items()}, indent=2))
    return None


if __name__ == "__main__":
    wrong = main(sys.argv[1:])
    if wrong:
        print(wrong, file=sys.stderr)
        sys.exit(2)
