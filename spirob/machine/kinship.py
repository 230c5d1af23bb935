"""Which effects say the same in richer or poorer words: at most one of them may be missing."""

from collections.abc import Collection

from spirob.effects import Effect

SPEEDS = {"motor.speed", "motor.rest_speed"}
SLOW, FAST = 1e3, 1e4  # rest speeds at which sliding friction has settled
SETTLING = 4000  # steps that a memory is given for that
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


def related(effect: type[Effect], others: Collection[type[Effect]]) -> bool:
    """Whether one of the others is the same kind of law, of which a machine has only one.

    The sum of two laws of dry friction is a third one, with a transition that fits anything.
    """
    return is_dry(effect) and any(is_dry(other) for other in others)


def _settled(effect: type[Effect], speed: float) -> float:
    given = {a: 1.0 if s == "motor.rest_speed" else speed for a, s in effect.reads.items()}
    given |= {f: p.nominal for f, p in effect.parameters().items()}
    given |= {"dt": STEP} if "dt" in effect.arguments() else {}
    memory = dict(effect.state)
    for _ in range(SETTLING if memory else 1):
        out = effect.kernel(**{a: (given | memory)[a] for a in effect.arguments()})
        if not memory:
            return float(out)
        memory = dict(zip(memory, out[1:], strict=True))
    return float(out[0])
