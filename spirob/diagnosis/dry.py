"""Laws of dry friction, known by what their kernels do, so that none is listed by name."""

from collections.abc import Collection

from spirob.effects import Effect

SPEEDS = {"motor.speed", "motor.rest_speed"}
SLOW, FAST = 1e3, 1e4  # rest speeds at which sliding friction has settled
LOW = (1.0, 3.0, 10.0)  # rest speeds among which a level is highest
HIGHER = 1.1
SETTLING = 100  # steps that a memory is given for that
STEP = 1e-3  # s


def is_dry(effect: type[Effect]) -> bool:
    """Whether this is a law of dry friction by speed alone: level at speed, and odd in it.

    Asked of the kernel itself, so that it holds for effects that nobody here has seen.
    """
    reads = set(effect.reads.values())
    if effect.port != "motor.torque" or "motor.speed" not in reads or not reads <= SPEEDS:
        return False
    slow, fast, back = (_settled(effect, v) for v in (SLOW, FAST, -FAST))
    return abs(fast) > 0.0 and abs(fast - slow) < 1e-3 * abs(fast) and fast * back < 0.0


def falls(effect: type[Effect]) -> bool:
    """Whether the level of a dry friction is higher at low speed than at high speed."""
    low = max(abs(_settled(effect, speed)) for speed in LOW)
    return low > HIGHER * abs(_settled(effect, FAST))


def _settled(effect: type[Effect], speed: float) -> float:
    given = {a: 1.0 if s == "motor.rest_speed" else speed for a, s in effect.reads.items()}
    given |= {f: p.nominal for f, p in effect.parameters().items()}
    given |= {"dt": STEP} if "dt" in effect.arguments() else {}
    memory = dict(effect.state)
    if not memory:
        return float(effect.kernel(**given))
    for _ in range(SETTLING):
        out = effect.kernel(**given, **memory)
        memory = dict(zip(memory, out[1:], strict=True))
    return float(out[0])


def another_dry(effect: type[Effect], others: Collection[type[Effect]]) -> bool:
    """Whether another law of dry friction is among the others, of which a machine has only one.

    The sum of two is a third one, with a transition that fits anything.  Only what they say of
    different things belongs together: how friction turns round at a reversal, and how its level
    falls with speed.
    """
    return is_dry(effect) and any(is_dry(o) and not _complete(effect, o) for o in others)


def _complete(one: type[Effect], other: type[Effect]) -> bool:
    """Whether one law tells how friction turns round, the other how its level falls with speed."""
    memory, level = (one, other) if one.state else (other, one)
    return bool(memory.state) and not level.state and falls(level)
