"""Results of a run that never happened, as its stages write them in JSON."""


def _rate(value: float, n: int) -> dict:
    return {"value": value, "low": value - 0.1, "high": min(value + 0.1, 1.0), "n": n}


TRIAL = {
    "cases": 62,
    "top1": _rate(0.78, 50),
    "false_alarm": _rate(0.1, 12),
    "pairs_both": {"value": float("nan"), "low": 0.0, "high": 1.0, "n": 0},
    "confusion": {
        "guide_friction": {"capstan_friction": 4, "undecided": 1},
        "rotor_friction": {"coulomb_friction": 3, "capstan_friction": 1, "unknown": 1},
        "none": {"nothing_missing": 5},
    },
    "reliability": [
        {"low": 0.5, "high": 0.9, "said": 0.71, "right": 0.6, "n": 15},
        {"low": 0.9, "high": 1.0, "said": 0.98, "right": 0.94, "n": 32},
        {"low": 0.0, "high": 0.5, "said": None, "right": None, "n": 0},
    ],
    "strength": [
        {"low": 0.1, "high": 0.4, "value": 0.55, "low_ci": 0.34, "high_ci": 0.74, "n": 20},
        {"low": 0.4, "high": 0.7, "value": 0.93, "low_ci": 0.78, "high_ci": 0.98, "n": 30},
    ],
}


def experiments() -> dict:
    sides = {"robot": 53.4, "base": 54.8, "named": 54.0, "single": 0.0}
    about = {
        "unit": "ms",
        **sides,
        "paper": 52.4,
        "aim": "within 5 %",
        "met": True,
        "note": "odd <",
    }
    plain = {**about, "paper": None, "aim": None, "met": None, "named": None}
    curves = [
        {"play": p, "quantity": "force", "unit": "N", "side": s, "x": [0.0, 1.0], "y": [0.0, v]}
        for p in ("1 N", "2 N")
        for s, v in sides.items()
    ]
    rows = [{"what": "delay at 1 N", **about}, {"what": "rise at 1 N", **plain}]
    return {"delay": {"title": "Delay under constant force", "rows": rows, "curves": curves}}


def size() -> dict:
    simulation = {"mae": 1.31, "rmse": 1.74, "r2": 0.992, "std": 1.73}
    robot = {"mae": 3.42, "rmse": 4.36, "r2": 0.934, "std": 3.9, "samples": 28}
    for one, shipped, svr in ((simulation, 1.31, 1.25), (robot, 3.42, 3.6)):
        one["mae_low"], one["mae_high"] = 0.8 * shipped, 1.2 * shipped
        one["other"] = {
            "svr": rival(svr, svr - shipped, 0.1),
            "mean": rival(15.0, 15.0 - shipped, 2.0),
        }
    robot["unlisted"] = {"mae": 2.9, "mae_low": 2.1, "mae_high": 3.8, "samples": 12}
    step = {"mae": 2.0, "mae_low": 1.5, "mae_high": 2.6}
    training = {
        "samples": 35,
        "chosen": [
            {"threshold": 0.9, "svr_c": 10.0, "mae": 1.42},
            {"threshold": 0.5, "svr_c": 100.0, "mae": 1.04},
        ],
        "importance": {"stall_time": 11.2, "onset_stroke": 5.0},
        "learning_curve": {n: {"simulation": step, "robot": step} for n in ("20", "35")},
        "unit": "mm",
    }
    return {"simulation": simulation, "robot": robot, "training": training}


def rival(mae: float, gain: float, half: float) -> dict:
    return {
        "mae": mae,
        "mae_low": 0.9 * mae,
        "mae_high": 1.1 * mae,
        "gain": gain,
        "gain_low": gain - half,
        "gain_high": gain + half,
    }


def contacts() -> dict:
    signals = {}
    for signal, scale in (("current", 0.26), ("filtered", 0.22)):
        signals[signal] = {"tuned_scale": scale}
        for domain, contacts in (("simulation", 200), ("robot", 50)):
            signals[signal][domain] = {
                "paper": _detector(contacts, 0.36, 569.0),
                "tuned": _detector(contacts, 0.64, 198.5),
                "roc": [
                    {"scale": 0.1, "hits": 0.0, "alarms": 140.0},
                    {"scale": 0.2, "hits": 0.78, "alarms": 0.06},
                    {"scale": scale, "hits": 0.64, "alarms": 0.0},
                    {"scale": 1.0, "hits": 0.36, "alarms": 0.0},
                ],
            }
    return signals


def passive() -> dict:
    """Pushes as the stage `passive` tells them; none was hit at the base of the robot."""
    model = {
        "pushes": 200,
        "felt": {"all": 0.96, "outer": 1.0, "base": 0.84, "middle": 0.99, "tip": 1.0},
        "false_alarms_per_minute": 0.0,
        "minutes": 3.0,
        "delay_ms": [33.0, 150.0],
        "region_right": 0.93,
        "regions": [[34, 2, 0], [8, 65, 1], [0, 3, 79]],
    }
    felt = {"all": 1.0, "outer": 1.0, "middle": 1.0, "tip": 1.0}
    robot = {**model, "pushes": 44, "felt": felt, "regions": [[0, 0, 0], [6, 16, 2], [0, 0, 20]]}
    return {"learned_from": 192, "model": model, "robot": robot}


def _detector(contacts: int, hits: float, delay: float) -> dict:
    rates = {
        "contacts": contacts,
        "hits": {"10": hits / 2, "20": hits, "40": 0.97},
        "ever": 0.99,
        "delay": [delay, 2 * delay],
        "alarms": 0.0,
        "minutes": 29.2,
    }
    never = {**rates, "hits": dict.fromkeys(rates["hits"], 0.0), "ever": 0.0, "delay": None}
    empty = {**never, "contacts": 0, "minutes": 0.0}
    return {
        **rates,
        "by_place": [{"place": 0.5, **never}, {"place": 0.7, **empty}, {"place": 0.9, **rates}],
        "by_gap": [{"gap": 0.0056, **rates}, {"gap": 0.0184, **empty}],
        "by_motion": [{"speed": 0.035, "load": 0.1, **rates}],
    }


def transfer() -> dict:
    step = {"mae": 2.1, "rmse": 2.6, "r2": 0.98, "mae_low": 1.5, "mae_high": 2.7}
    gained = {**step, "mae": 1.97, "gain": 0.13, "gain_low": -0.17, "gain_high": 0.39}
    held = {"covered": 0.92, "refused": 0.0, "width": 0.0087, "samples": 26.0}
    return {
        "samples": 60,
        "stood_in": [
            {
                "name": "arm.base_stiffness",
                "meaning": "stiffness of the base hinge",
                "identified": 0.401429,
                "named": 0.146,
                "unit": "N·m/rad",
                "at_bound": False,
            },
            {
                "name": "winch.efficiency",
                "meaning": "torque transmitted by the gear",
                "identified": 0.89,
                "named": 0.702123,
                "unit": "1",
                "at_bound": True,
            },
        ],
        "robot": {"nominal": step, "identified": gained, "named": {**gained, "mae": 1.58}},
        "machines": {"nominal": step, "identified": gained, "named": {**gained, "mae": 1.43}},
        "interval": {"confidence": 0.9, "simulation": held, "robot": held},
    }


def _parameter(value, spread, unit, nominal, low, high, meaning, at_bound=False) -> dict:
    return {
        "value": value,
        "low": value - spread,
        "high": value + spread,
        "unit": unit,
        "nominal": nominal,
        "bound_low": low,
        "bound_high": high,
        "at_bound": at_bound,
        "meaning": meaning,
    }


IDENTIFIED = {
    "parameters": {
        "rotor_inertia": _parameter(
            2.31e-5, 1.2e-6, "kg·m²", 2e-5, 5e-6, 5e-4, "inertia of the rotor"
        ),
        "rotor_damping": _parameter(
            1e-3, 2e-4, "N·m·s/rad", 1e-4, 1e-5, 1e-3, "viscous friction of the rotor", True
        ),
        "efficiency": _parameter(0.743, 0.014, "1", 0.77, 0.6, 1.0, "torque through the gear"),
        "base_stiffness": _parameter(
            0.1873, 0.0041, "N·m/rad", 0.15, 0.01, 2.0, "stiffness of the base hinge"
        ),
        "stiffness": _parameter(4.1e4, 9e3, "N/m", 4e4, 5e3, 1e6, "tension per stretch"),
    },
    "identifiability": "All five numbers move a signal; tendon stiffness is weakly determined "
    "(condition number 310), because no trial loads both tendons against each other.",
    "resolution": {
        "names": ["rotor_inertia", "rotor_damping", "efficiency", "base_stiffness", "stiffness"],
        "correlation": [
            [1.0, 0.61, 0.97, 0.4, 0.1],
            [0.61, 1.0, 0.55, -0.93, 0.0],
            [0.97, 0.55, 1.0, 0.3, 0.1],
            [0.4, -0.93, 0.3, 1.0, 0.2],
            [0.1, 0.0, 0.1, 0.2, 1.0],
        ],
        "weakest": {
            "rotor_inertia": 0.05,
            "rotor_damping": 0.02,
            "efficiency": 0.1,
            "base_stiffness": 0.03,
            "stiffness": 0.99,
        },
        "least": 0.0003,
        "most": 0.21,
        "unit": "A",
    },
    "train": {"mae": 0.112, "rmse": 0.149, "r2": 0.913, "unit": "A"},
}


def _rung(label, effects, train, validate, heldout) -> dict:
    splits = {"train": train, "validate": validate, "heldout": heldout}
    scores = {name: _scores(rmse) for name, rmse in splits.items()}
    ends = {name: (_scores(0.9 * rmse), _scores(1.15 * rmse)) for name, rmse in splits.items()}
    interval = {
        name: {score: sorted((low[score], high[score])) for score in low}
        for name, (low, high) in ends.items()
    }
    return {"label": label, "effects": effects, **scores, "interval": interval}


def _scores(rmse) -> dict:
    return {"mae": 0.76 * rmse, "rmse": rmse, "r2": 1 - (rmse / 0.51) ** 2}


def _candidate(name, title, probability, rmse, gain) -> dict:
    return {
        "name": name,
        "title": title,
        "probability": probability,
        "train_rmse": 0.92 * rmse,
        "left_out_rmse": 0.97 * rmse,
        "with": [],
        "heldout_rmse": rmse,
        "alone_heldout_rmse": rmse,
        "screen_gain": gain,
    }


def _regime(regime, error, time, bias, rmse, kind="velocity") -> dict:
    return {
        "kind": kind,
        "regime": regime,
        "share_of_error": error,
        "share_of_time": time,
        "bias": bias,
        "rmse": rmse,
    }


DIAGNOSIS = {
    "format": 1,
    "verdict": "named",
    "sentence": "The model lacks friction of the tendon in its guides (capstan friction): the "
    "missing current grows with load and bend and changes sign with the direction of travel.",
    "doubts": [],
    "effects": [
        {
            "name": "capstan_friction",
            "title": "capstan friction",
            "probability": 0.93,
            "together": 0.99,
            "equivalents": [],
            "rivals": ["load_dependent_friction"],
            "parameters": {
                "friction_coefficient": {"value": 0.214, "low": 0.2, "high": 0.229, "unit": "1"},
                "sliding_speed": {"value": 4.3e-4, "low": 2e-4, "high": 9e-4, "unit": "m/s"},
            },
        }
    ],
    "evidence": [],
    "candidates": [
        _candidate("capstan_friction", "capstan friction", 0.93, 0.0512, 0.71),
        _candidate("load_dependent_friction", "load-dependent friction", 0.06, 0.0794, 0.66),
        _candidate("coulomb_friction", "Coulomb friction", 0.01, 0.1213, 0.41),
        _candidate("cogging", "cogging", 0.0, 0.1829, 0.004),
        _candidate("creep", "creep", 0.0, 0.2, 0.001)
        | dict.fromkeys(("train_rmse", "left_out_rmse", "heldout_rmse")),
    ],
    "ladder": [
        _rung("base model", [], 0.149, 0.171, 0.1834),
        _rung("all parameters refitted", [], 0.131, 0.162, 0.1742),
        _rung("with capstan friction", ["capstan_friction"], 0.0462, 0.0493, 0.0512),
        _rung("flexible residual", [], 0.031, 0.0401, 0.0431) | {"ceiling": True},
    ],
    "left": {"share": 0.29},
    "noise_floor": 0.0124,
    "atlas": [
        _regime("winding in", 0.58, 0.21, 0.231, 0.304),
        _regime("0.1 s around reversals", 0.22, 0.06, -0.043, 0.351, "reversal"),
        _regime("paying out", 0.31, 0.38, -0.122, 0.166),
        _regime("standing", 0.05, 0.24, 0.011, 0.083),
        _regime("low load", 0.004, 0.11, 0.002, 0.035, "load"),
    ],
    "atlas_orders": [{"of": "motor", "order": 3.02, "share_of_error": 0.12}],
    "atlas_lateness": {"delay_ms": 1.42, "delay_share": 0.07, "command_share": 0.031},
    "depends": {"sentence": "The residual depends on speed (41% by itself).", "alone": {}},
    "atlas_sentences": [
        "Pulling in under high load holds 58 % of the squared error in 21 % of the time.",
        "The residual changes sign with the direction of travel, within 0.1 s of each reversal.",
        "At rest and with a slack tendon the model is as good as the sensor.",
    ],
    "next_experiment": "Two bends against two opposing currents, 40 s: capstan and load-dependent "
    "friction then differ by 0.19 A, fifteen times the noise.",
    "explanation": "The missing current is odd in speed, proportional to tension and grows with "
    "the total bend, which rotor friction cannot do. Adding capstan friction removes 92 % of the "
    "squared error on held-out trials; no second effect brings more than the practical 2 %.",
    "unit": "A",
}
