"""Bad logs are refused in a sentence or repaired and said; good ones pass untouched."""

import numpy as np
import pytest

from spirob.errors import DataError, MissingChannel, TooShort
from spirob.machine.description.rig import RigFile
from spirob.machine.recordings import checks
from spirob.machine.recordings.recording import prepare
from tests.machine.rigs import description

RIG = RigFile.model_validate(description())


def good(seconds=4.0, rate=500):
    t = np.arange(0, seconds, 1 / rate)
    q = 2 * np.sin(2 * np.pi * 0.7 * t) + 0.3 * np.sin(2 * np.pi * 1.9 * t)
    return {"t": t, "q": q, "u": 0.4 * np.cos(2 * np.pi * 0.7 * t) + 0.01 * np.sin(40 * t)}


@pytest.mark.parametrize("reach", [0, 1, 3, 9])
@pytest.mark.parametrize("count", [1, 4, 30])
def test_a_mask_is_widened_within_its_own_rows(count, reach):
    for row in range(count):
        mask = np.arange(count) == row
        np.testing.assert_array_equal(
            checks.widened(mask, reach), np.abs(np.arange(count) - row) <= reach
        )


def test_a_good_log_is_left_alone():
    assert prepare("log", good(), RIG).said == []


@pytest.mark.parametrize(
    ("column", "rows", "value", "sentence"),
    [
        ("u", slice(10, 20), np.nan, "10 missing values of 'u' were bridged"),
        ("q", slice(10, 13), np.inf, "3 missing values of 'q' were bridged"),
        ("q", slice(10, 40), np.nan, "'q' has no number in 30 rows in a run; the log was cut"),
        (
            "t",
            slice(500, 501),
            0.0,
            "1 rows whose time does not follow from those beside were",
        ),
        ("q", slice(700, 701), 90.0, "jumps of 'q' out and back were bridged"),
    ],
)
def test_small_damage_is_repaired_and_said(column, rows, value, sentence):
    log = good()
    log[column][rows] = value
    assert any(sentence in said for said in prepare("log", log, RIG).said)


def test_a_wrapped_encoder_is_unwrapped():
    log = good()
    wrapped = {**log, "q": np.mod(log["q"] + np.pi / 2, np.pi) - np.pi / 2}
    made = prepare("log", wrapped, RIG)
    assert any("wraps round by 3.1" in said for said in made.said)
    np.testing.assert_allclose(made.pieces[0].v, prepare("log", log, RIG).pieces[0].v, atol=0.05)


def test_a_gap_cuts_the_log_and_is_said():
    log = {name: np.delete(values, slice(900, 1100)) for name, values in good().items()}
    made = prepare("log", log, RIG)
    assert len(made.pieces) == 2
    assert any("1 gap, the longest 0.402 s" in said for said in made.said)


@pytest.mark.parametrize("column", ["q", "u"])
@pytest.mark.parametrize("sentinel", [3.4e38, -1e300, 1.7976931348623157e308, -9999.0, 999.0])
def test_a_number_that_stands_for_a_missing_one_is_taken_as_missing(column, sentinel):
    rng, log = np.random.default_rng(0), good()
    rows = rng.permutation(len(log["t"]))[:40]
    missing = {**log, column: log[column].copy()}
    log[column][rows], missing[column][rows] = sentinel, np.nan
    made, bridged = prepare("log", log, RIG), prepare("log", missing, RIG)
    assert any(f"40 values of '{column}', {abs(sentinel):.3g} and more" in s for s in made.said)
    for one, other in zip(made.pieces, bridged.pieces, strict=True):
        np.testing.assert_array_equal(one.q, other.q)
        np.testing.assert_array_equal(one.effort, other.effort)


@pytest.mark.parametrize("size", [1.5, 300.0])
def test_a_stretch_of_noise_is_cut_out(size):
    log, clean = good(12.0), prepare("log", good(12.0), RIG)
    noise = (log["t"] > 5.0) & (log["t"] < 6.5)
    log["q"][noise] = size * np.random.default_rng(0).standard_normal(int(noise.sum()))
    made = prepare("log", log, RIG)
    assert len(made.pieces) == 2
    assert made.pieces[0].seconds[-1] < 5.0
    assert made.pieces[1].seconds[0] > 6.5
    assert sum(len(p.q) for p in made.pieces) > 0.6 * sum(len(p.q) for p in clean.pieces)
    whole = np.interp(made.pieces[1].seconds, clean.pieces[0].seconds, clean.pieces[0].a)
    use = made.pieces[1].use
    np.testing.assert_allclose(made.pieces[1].a[use], whole[use], atol=0.02 * np.ptp(whole))


def test_no_motion_is_a_sentinel_however_short():
    """A log that stands nearly always, by an encoder with a little noise."""
    t = np.arange(0, 40, 2e-3)
    rng = np.random.default_rng(1)
    wide = np.exp(-(((t - 20) / 0.3) ** 2))
    for values in (wide, 1e-7 * rng.normal(size=len(t)) + wide, 1e6 * wide):
        said = []
        assert checks.without_sentinels("log", "q", values, values, said) is values
        assert said == []


@pytest.mark.parametrize("size", [20.0, 1e3, 1e6])
@pytest.mark.parametrize("rows", [[700], [700, 720, 1201]])
def test_single_efforts_that_outweigh_all_others_are_bridged(rows, size):
    log = good()
    log["u"][rows] = -size
    made, clean = prepare("log", log, RIG), prepare("log", good(), RIG)
    assert any(
        f"{len(rows)} single values of 'u', up to {size:.3g}, outweigh" in s for s in made.said
    )
    use = clean.pieces[0].use & made.pieces[0].use
    np.testing.assert_allclose(made.pieces[0].effort[use], clean.pieces[0].effort[use], atol=1e-3)


def test_efforts_that_a_machine_asks_for_are_left_alone():
    """Blows of a row among noise, an effort of two levels, two that are mostly nothing."""
    rng = np.random.default_rng(0)
    blows = rng.standard_normal(2000)
    blows[::100] *= 10.0
    few = np.zeros(2000)
    few[500:510] = 1.0
    rough = few.copy()
    rough[::150] += 0.1
    for effort in (blows, np.sign(blows), few, rough):
        said: list[str] = []
        assert np.all(checks.without_outliers("log", "u", effort, 2e-3, said) == effort)
        assert said == []


def changed(**columns):
    return {**good(), **columns}


@pytest.mark.parametrize(
    ("log", "sentence"),
    [
        (changed(u=np.where(np.arange(2000) % 900 < 700, np.nan, good()["u"])), "gaps leave less"),
        (
            changed(u=np.where(np.arange(2000) < 1990, np.nan, good()["t"])),
            "no number in 1990 of 2000",
        ),
        (changed(t=good()["t"][::-1].copy()), "time runs backwards in 1999 of 2000 rows"),
        (changed(t=good()["q"]), "is it another column"),
        (changed(q=np.random.default_rng(0).standard_normal(2000)), "no motion that can be foll"),
        (changed(q=1e300 * good()["q"]), r"'q' reaches 2\.\de\+300"),
        (changed(t=1e3 * good()["t"]), "is the unit of time right"),
        (changed(t=1e-3 * good()["t"]), "is the unit of time right"),
        (changed(q=np.round(1e4 * good()["q"])), "are these counts"),
        (changed(q=np.full(2000, 1.0)), "'q' is constant"),
        (changed(u=np.zeros(2000)), "'u' is constant"),
        (changed(q=good()["q"] + np.cumsum(np.arange(2000) % 90 == 0)), "'q' jumps by"),
    ],
)
def test_what_cannot_be_repaired_is_refused_in_a_sentence(log, sentence):
    with pytest.raises(DataError, match=sentence):
        prepare("log", log, RIG)


def test_too_short_and_missing_columns_are_named():
    with pytest.raises(DataError, match=r"0\.4 s long"):
        prepare("log", good(0.4), RIG)
    with pytest.raises(TooShort):
        prepare("log", good(0.05), RIG)
    log = good()
    del log["u"]
    with pytest.raises(MissingChannel, match="'u' is missing; present: q, t"):
        prepare("log", log, RIG)


def test_slow_rows_are_left_out_in_the_unit_of_the_rig():
    degrees = {"column": "q", "unit": "deg"}
    rig = RigFile.model_validate(description(position=degrees, rows={"minimum_speed": 120.0}))
    log = good()
    made = prepare("log", {**log, "q": np.degrees(log["q"])}, rig)
    piece = made.pieces[0]
    assert np.abs(piece.v[piece.use]).min() >= np.radians(120.0)
    assert any("left out as too slow" in said for said in made.said)


def test_rows_at_the_limit_of_the_drive_are_left_out():
    effort = {"column": "u", "unit": "N·m", "kind": "torque", "limit": 0.35}
    rig = RigFile.model_validate(description(effort=effort))
    piece = prepare("log", good(), rig).pieces[0]
    assert np.abs(piece.raw[piece.use]).max() < 0.98 * 0.35
    log = good()
    clipped = prepare("log", {**log, "u": np.clip(log["u"], -0.3, 0.3)}, RIG)
    assert any("where the drive saturates" in said for said in clipped.said)


def test_a_relay_is_no_saturation():
    log = good()
    made = prepare("log", {**log, "u": np.where(log["u"] > 0, 4.0, -4.0)}, RIG)
    assert any("steps of the command" in said and "`effort.limit`" in said for said in made.said)
    assert not any("saturates (" in said or "where the drive" in said for said in made.said)
    assert made.pieces[0].use.mean() > 0.8


@pytest.mark.parametrize("share", [0.1, 0.25, 0.4])
def test_a_drive_that_clips_loses_those_rows(share):
    log = good()
    limit = np.quantile(np.abs(log["u"]), 1 - share)
    made = prepare("log", {**log, "u": np.clip(log["u"], -limit, limit)}, RIG)
    assert any("where the drive saturates" in said for said in made.said)
    assert not any("steps of the command" in said for said in made.said)


def test_a_command_is_what_the_axis_got_unless_its_limit_is_given():
    log = good()
    clipped = {**log, "u": np.clip(log["u"], -0.3, 0.3)}
    for limit, left in (({}, 1.0), ({"limit": 0.3}, 0.98)):
        effort = {"column": "u", "unit": "N·m", "kind": "torque", "origin": "command", **limit}
        made = prepare("log", clipped, RigFile.model_validate(description(effort=effort)))
        piece = made.pieces[0]
        assert np.abs(piece.raw[piece.use]).max() <= left * 0.3
        assert np.any(np.abs(piece.raw[piece.use]) == 0.3) == (not limit)
        assert any("saturates" in said for said in made.said) == bool(limit)


def test_an_effort_of_one_sign_rests_at_zero():
    log = good()
    made = prepare("log", {**log, "u": np.maximum(log["u"], 0.0)}, RIG)
    assert not any("saturates" in said for said in made.said)


@pytest.mark.parametrize("period", [2.0, 8.0])
@pytest.mark.parametrize("top", [0.8, 0.797])  # of a step of 0.01
def test_the_tops_of_a_slow_curve_in_coarse_steps_are_no_saturation(period, top):
    log = good(24.0)
    curve = np.round(top * np.sin(2 * np.pi / period * log["t"]), 2)
    made = prepare("log", {**log, "u": curve}, RIG)
    assert not any("where the drive saturates" in said for said in made.said)
    clipped = prepare("log", {**log, "u": np.clip(curve, -0.6, 0.6)}, RIG)
    assert any("where the drive saturates" in said for said in clipped.said)


def held_for(u, rows):
    """An effort that its controller gives anew only once in so many rows."""
    return u[np.arange(len(u)) // rows * rows]


def random_steps(t):
    """Levels that are held for 0.1 s to 0.4 s each."""
    rng = np.random.default_rng(0)
    ends = np.cumsum(rng.uniform(0.1, 0.4, 100))
    return rng.choice(np.linspace(-0.4, 0.4, 7), 100)[np.searchsorted(ends, t)]


def up_and_down(t):
    return 0.1 * np.abs((t // 0.25) % 12 - 6)


@pytest.mark.parametrize("steps", [random_steps, up_and_down])
def test_the_outermost_steps_of_a_staircase_are_no_saturation(steps):
    log = good(12.0)
    made = prepare("log", {**log, "u": steps(log["t"])}, RIG)
    assert any("steps of the command" in said for said in made.said)
    assert not any("where the drive" in said for said in made.said)


def test_a_share_that_rounds_to_nothing_is_not_told():
    log = good(30.0)
    steps = held_for(np.random.default_rng(0).normal(size=len(log["t"])), 8)
    full = np.mean((steps == steps.max()) | (steps == steps.min()))
    assert 0.0 < full < 0.005
    made = prepare("log", {**log, "u": steps}, RIG)
    assert not any("the largest or smallest of the log" in said for said in made.said)
    assert not any("where the drive" in said for said in made.said)


@pytest.mark.parametrize("pace", [lambda u: held_for(u, 8), lambda u: 0.05 * np.round(u / 0.05)])
def test_a_drive_that_clips_a_slow_or_coarse_effort_loses_those_rows(pace):
    log = good(12.0)
    made = prepare("log", {**log, "u": np.clip(pace(log["u"]), -0.35, 0.35)}, RIG)
    assert any("where the drive saturates" in said for said in made.said)
    assert not any("steps of the command" in said for said in made.said)


def test_a_step_of_the_motor_is_no_jump():
    """Standing most of the time, then there within 20 ms, as in a step test."""
    log = good(12.0)

    def risen(seconds):
        x = np.clip((log["t"] % 6.0 - seconds) / 0.02, 0, 1)
        return 0.5 * x * x * (3 - 2 * x)

    log["q"] = risen(1.0) - risen(4.0)
    assert prepare("log", log, RIG).said == []


@pytest.mark.parametrize("size", [0.06, 3.0, -40.0])
def test_a_jump_cuts_the_log_and_is_said(size):
    log = good()
    made = prepare("log", {**log, "q": log["q"] + size * (log["t"] > 2.05)}, RIG)
    assert len(made.pieces) == 2
    assert made.pieces[1].seconds[0] == pytest.approx(2.052)
    assert any("'q' jumps by" in said and "the log was cut there" in said for said in made.said)
    whole = prepare("log", log, RIG).pieces[0]
    late = made.pieces[1]
    same = np.interp(late.seconds, whole.seconds, whole.v)
    np.testing.assert_allclose(late.v[late.use], same[late.use], atol=0.02)


def test_counts_with_a_factor_are_no_counts_any_more():
    log = good()
    turns = {"column": "q", "unit": "turn", "factor": 1 / 4096}
    rig = RigFile.model_validate(description(position=turns))
    log["q"] = np.round(log["q"] / (2 * np.pi) * 4096)
    assert prepare("log", log, rig).pieces[0].v.max() > 5.0
    with pytest.raises(DataError, match="are these counts"):
        prepare("log", log, RIG)


def test_whole_degrees_with_the_factor_one_are_degrees():
    log = good()
    whole = {**log, "q": np.round(np.degrees(log["q"]))}
    degrees = {"column": "q", "unit": "deg", "factor": 1.0}
    made = prepare("log", whole, RigFile.model_validate(description(position=degrees)))
    assert np.ptp(made.pieces[0].q) == pytest.approx(np.ptp(log["q"]), rel=0.05)


def test_a_signed_register_read_as_unsigned_is_read_as_negative():
    true = np.round(300 * np.sin(np.arange(200) / 9.0))
    said: list[str] = []
    found = checks.signed("log", "load", true % 65536, said)
    np.testing.assert_array_equal(found, true)
    assert "16 bits" in said[0]


@pytest.mark.parametrize(
    "values", [np.arange(65000.0), 1e-3 * (np.arange(9.0) % 65536), np.array([0.0, 70000.0])]
)
def test_other_whole_numbers_are_left_alone(values):
    said: list[str] = []
    np.testing.assert_array_equal(checks.signed("log", "load", values, said), values)
    assert said == []
