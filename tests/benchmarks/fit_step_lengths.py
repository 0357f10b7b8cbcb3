#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Fits the length law of step/odograph to real walks, and prints its errors on data sets left out, beside plain laws:

    tests/benchmarks/fit_step_lengths.py build/bin/odograph FOLDER [DATA/ridi DATA/ipin2023_t3 ...]

FOLDER receives the truth of the walks (`odograph bench steps`) and the features of their steps (the plugin's parameter `features`);
without data sets, those in FOLDER are used again. A walk's logarithm of true over estimated length is fitted by generalised least squares:
the walks of a person share that person's level, so that differences between the walks of one person determine the exponents as much as
those between persons. The plain laws use the same steps, with shortened first ones."""
import json
import pathlib
import subprocess
import sys

import numpy as np

# The constants of the plugin (length_model.hpp), with the leg's logarithm.
NAMES, EXPONENTS = ["cadence", "rise", "turning", "harmonic", "leg"], [0.9, 0.22, 0.8, 0.3, -0.12]
BY_OWN_CADENCE = 0.8
# Standard deviations of the logarithm of a walk's length for a law: among persons, and among walks of a person.
PERSON, WALK = 0.08, 0.05
# Of the exponents, before the data: a place's, and any other's.
PLACE, ANY = 0.1, 0.5
ONE_PERSON = ("trundle_wheel", "pace_walks", "ipin2023_t3")  # IPIN does not state its persons
PACES = ("trundle_wheel", "pace_walks")  # sets of one person at several paces
CONFIG = """odograph: 1
walker: {height: 1.70 m}
attitude: {plugin: attitude/vqf}
step_estimator: {plugin: step/odograph, parameters: {features: "%s"}}
coupling: {type: localizer}
"""


def measure(program, folder, data):
    """Truth and features of all walks."""
    folder.mkdir(parents=True, exist_ok=True)
    config = folder / "steps.yaml"
    config.write_text(CONFIG % "")
    sets = [option for path in data for option in ("--data", path)]
    measured = subprocess.run([program, "bench", "steps", *sets, "-c", config, "--json", "--keep", folder], stdout=subprocess.PIPE)
    rows = [row for row in json.loads(measured.stdout) if row["true_m"] and row["steps"] and row["floors"] == 0]
    (folder / "walks.json").write_text(json.dumps(rows))
    files = {(path.rstrip("/").split("/")[-1], f.stem): f for path in data for f in pathlib.Path(path).rglob("*.*")}
    for row in rows:
        config.write_text(CONFIG % (folder / f"{row['data']}_{row['recording']}.csv").absolute())
        subprocess.run([program, "steps", files[row["data"], row["recording"]], "-c", config], check=True, stdout=subprocess.DEVNULL)


class Walk:
    """Steps of a walk while its truth is known: features, and the part of a step that each is (the first ones are shorter)."""

    def __init__(self, row, steps):
        self.set, self.name, self.true_m = row["data"], row["recording"], row["true_m"]
        self.person = self.set + ("" if self.set in ONE_PERSON else row["person"])
        start, end = steps["t_start_ns"], steps["t_end_ns"]
        inside = np.clip((np.minimum(row["to_ns"], end) - np.maximum(row["from_ns"], start)) / (end - start), 0, 1)
        steps, inside = steps[inside > 0], inside[inside > 0]
        self.parts, self.count = inside * (1 - 0.5 * np.exp(-steps["since_stood"] / 1.3)), inside.sum()
        self.own_sigma = np.average(steps["own_sigma"], weights=inside * steps["length_m"])
        pace = np.log(np.maximum(steps["frequency_hz"], 1.15) / 1.72)
        trunk = (steps["gentle"] == 0) & (steps["vertical_part"] > 0.4) & (steps["frequency_hz"] > 1.45)
        self.features = {
            "cadence": np.minimum(pace, 0),
            "rise": np.log(np.clip(steps["rise_m"], 0.015, 0.12) / 0.03),
            "turning": -np.minimum(steps["turning_radps"], 0.3),
            "harmonic": -np.where(trunk, np.clip(steps["second_harmonic"], 0, 0.4), 0),
            "leg": steps["on_leg"],
            "quick": np.maximum(pace, 0),
            "swing": np.log(steps["swing_mps2"] / 3),
        }
        speed = self.true_m / (inside * (steps["t_end_ns"] - steps["t_start_ns"])).sum() * 1e9
        self.pace = "slow" if speed < 1.05 else "usual" if speed < 1.45 else "fast"

    def mean(self, name):
        return self.log_length([name], np.zeros(1))[1][0]

    def terms(self):
        return np.append(EXPONENTS[1:], BY_OWN_CADENCE) * [self.mean(n) for n in [*NAMES[1:], "quick"]]

    def sigma(self, fitted):
        """As the plugin states it for the sum of the steps; `fitted`: mean terms of the fit."""
        common = 0.4 * np.linalg.norm(self.terms() - fitted)
        return np.sqrt(PERSON**2 + (0.55 * self.mean("cadence"))**2 + common**2 + self.own_sigma**2)

    def log_length(self, names, exponents):
        """Logarithm of the length for a level of 1 m, and its derivatives by the exponents."""
        x = np.stack([self.features[n] for n in names]) if names else np.zeros((0, len(self.parts)))
        lengths = self.parts * np.exp(exponents @ x)
        return np.log(lengths.sum()), x @ lengths / lengths.sum()


class Law:
    """Product of powers; `fixed` are exponents that are not fitted."""

    def __init__(self, names, fixed=None):
        self.names, self.fixed = names, np.array(fixed, float) if fixed else None
        self.exponents = self.fixed if fixed else np.full(len(names), 0.3)

    def fit(self, walks):
        V = np.array([[PERSON**2 * (a.person == b.person) + WALK**2 * (a is b) for b in walks] for a in walks])
        weights = np.linalg.inv(V)
        for _ in range(20):
            y, x = zip(*(w.log_length(self.names, self.exponents) for w in walks))
            A = np.ones((len(walks), 1)) if self.fixed is not None else np.column_stack([np.ones(len(walks)), np.stack(x)])
            self.center = np.array(x).mean(0)
            residual = np.log([w.true_m for w in walks]) - y
            prior = np.diag([0] + [(PLACE if n == "leg" else ANY) ** -2 for n in self.names])[: A.shape[1], : A.shape[1]]
            now = np.append(0, self.exponents)[: A.shape[1]]
            self.covariance = np.linalg.inv(A.T @ weights @ A + prior)
            change = self.covariance @ (A.T @ weights @ residual - prior @ now)
            self.level = change[0]
            if self.fixed is None:
                self.exponents = self.exponents + change[1:]
                if np.abs(change[1:]).max(initial=0) < 1e-6:
                    break
        return self

    def error(self, walk):
        return walk.log_length(self.names, self.exponents)[0] + self.level - np.log(walk.true_m)


def percent(errors):
    e = 100 * np.expm1(np.asarray(errors))
    return f"{np.median(abs(e)):5.1f} {np.quantile(abs(e), 0.9):5.1f} {e.mean():+6.1f}"


def mean_terms(walks):
    """Each person once."""
    persons = [w.person for w in walks]
    return np.average([w.terms() for w in walks], axis=0, weights=[1 / persons.count(p) for p in persons])


def line_of(own, law):
    """Errors of one set's walks by a law fitted without it."""
    errors = {w: law.error(w) for w in own}
    line = f"  {own[0].set:14} {percent(list(errors.values()))}"
    if own[0].set in PACES:
        known = {w: law.error(w) + BY_OWN_CADENCE * w.mean("quick") for w in own}
        line += f"; after one known walk {percent([known[a] - known[b] for a in own for b in own if a is not b])}"
    if own[0].set == "pace_walks":
        true = np.array([w.true_m / w.count for w in own])
        line += f", slope {np.polyfit(true, true * np.exp(list(errors.values())), 1)[0]:.2f}"
    if own[0].set == "trundle_wheel":
        line += "; " + ", ".join(f"{w.name} {100 * np.expm1(e):+.1f}" for w, e in errors.items())
    return errors, line + "   " + np.array2string(law.exponents, precision=2, floatmode="fixed")


def consistency(walks, errors, sigmas):
    """Squared errors over the stated variances, by pace: mean of all walks, and each person once."""
    squares = np.array([(errors[w] / sigmas[w]) ** 2 for w in walks])
    for pace in ("slow", "usual", "fast", ""):
        own = np.array([w.pace.startswith(pace) for w in walks])
        persons = [w.person for w in np.array(walks)[own]]
        once = np.array([1 / persons.count(p) for p in persons])
        distance = np.array([w.true_m for w in walks])[own]
        nees = squares[own]
        print(f"  {pace or 'all':6} {own.sum():4} walks: {nees.mean():.2f}, each person once {np.average(nees, weights=once):.2f}, "
              f"within one sigma {100 * np.average(nees < 1, weights=once):.0f} %, beyond three "
              f"{100 * np.average(nees > 9, weights=distance):.1f} % of the distance")


def main():
    program, folder, *data = sys.argv[1:]
    folder = pathlib.Path(folder)
    if data:
        measure(program, folder, data)
    walks = [Walk(row, np.genfromtxt(folder / f"{row['data']}_{row['recording']}.csv", delimiter=",", names=True))
             for row in json.loads((folder / "walks.json").read_text())]
    sets = sorted({w.set for w in walks})
    for title, law in (("this law, all constants", Law(NAMES)), ("this law, the level", Law(NAMES, EXPONENTS)),
                       ("Kim: third root of the swing", Law(["swing"], [1 / 3])), ("Weinberg: fourth root", Law(["swing"], [0.25])),
                       ("constant", Law([], []))):
        print(f"{title}; of a set left out: error, median and 90 %, mean, %")
        errors, sigmas = {}, {}
        for s in sets:
            others = [w for w in walks if w.set != s]
            own, line = line_of([w for w in walks if w.set == s], law.fit(others))
            errors.update(own)
            sigmas.update({w: w.sigma(mean_terms(others)) for w in own})
            print(line)
        law.fit(walks)
        print(f"  all sets: {np.exp(law.level):.3f} m, {np.round(law.exponents, 2)} +- {np.round(np.sqrt(np.diag(law.covariance))[1:], 2)}")
        if law.names == NAMES and law.fixed is not None:
            print(f"mean terms {np.round(mean_terms(walks), 2)}; consistency of a set left out:")
            consistency(walks, errors, sigmas)


if __name__ == "__main__":
    main()
