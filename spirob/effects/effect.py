"""What an effect is: a declaration and one pure scalar function.

It declares where it acts (`port`), what it reads, what it remembers, its numbers and how to
recognise it.  Everything else is derived from that: the compiled loop, the parameter vector, the
check of the configuration, the diagnosis' sentence and the tests.

Two motors of one machine differ.  A friction level is much the same in two motors of one make.  A
number that may have either sign, the phase of a ripple or the offset of a sensor, is an accident of
the single motor: a machine with two of them gets such a number twice, as mean and half difference
(left minus right).
"""

import ast
import inspect
from collections.abc import Callable, Mapping
from typing import Any, ClassVar

import numpy as np

from spirob.errors import EffectError
from spirob.parameter import Numbers, Parameter
from spirob.ports import PORTS, READABLE, SIGNALS

OPTIONAL = {"dt"}  # a kernel may ask for the step [s]
TEXTS = ("title", "signature", "explanation", "tell_apart", "needs", "references")
TRAITS = {"dissipative", "odd_in_speed", "even_in_speed", "rate_independent", "constant"}


class Effect(Numbers):
    """Base class of all effects; declare the attributes below and `kernel`.

    port        name in `ports.PORTS`
    reads       kernel argument -> name in `ports.SIGNALS`
    state       kernel argument -> initial value; the kernel returns (contribution, next states...)
    free        states that may begin with any value, of which the motion tells nothing: a swing.
                Where a log of a plain axis begins, or goes on after a gap, it is fitted; what the
                kernel returns is linear in them. One of the drive, which passes on a share of its
                torque, is fitted where a log begins
    neutral     numbers at which the effect vanishes; setting them makes the models nested
    held        numbers that no fit moves: they only say in which sizes the others count
    taught      argument -> lowest and highest value in the motion that taught the law; its numbers
                are then those of that machine, and are brought to the size of no other
    traits      claims on the kernel, each a test
    equation    independent statement of the contribution in the symbols of the numbers and the
                names of the arguments; a state there is its next value
    evolution   state -> its rate of change, in the same names; where the state obeys such a law
    title       what a reader calls it
    signature   how it shows in data, one sentence
    explanation what happens physically, one or two sentences
    tell_apart  rival effect -> experiment that separates the two
    stands_for  numbers of the arm's model that do just the same; where one is fitted the effect is
                no candidate, for a wrong number is not a missing effect
    needs       what a trial must contain for the effect to show
    references  literature

    `kernel` is a static method; its arguments are exactly: `upstream` (for a pipe port), then
    reads, state and numbers by name, and `dt` if it wants it.  It uses only arithmetic and `math`.
    `class Other(Effect, told_as=One)` is another law of an effect, with the texts of One.

    Raises EffectError when the class is created with anything that does not fit.
    """

    port: ClassVar[str] = ""
    reads: ClassVar[Mapping[str, str]] = {}
    state: ClassVar[Mapping[str, float]] = {}
    free: ClassVar[tuple[str, ...]] = ()
    neutral: ClassVar[Mapping[str, float]] = {}
    held: ClassVar[frozenset[str] | set[str]] = frozenset()
    taught: ClassVar[Mapping[str, tuple[float, float]]] = {}
    traits: ClassVar[frozenset[str] | set[str]] = frozenset()
    equation: ClassVar[str] = ""
    evolution: ClassVar[Mapping[str, str]] = {}
    title: ClassVar[str] = ""
    signature: ClassVar[str] = ""
    explanation: ClassVar[str] = ""
    tell_apart: ClassVar[Mapping[str, str]] = {}
    stands_for: ClassVar[tuple[str, ...]] = ()
    needs: ClassVar[str] = ""
    references: ClassVar[tuple[str, ...]] = ()
    kernel: ClassVar[Callable[..., Any]]

    def __init_subclass__(cls, told_as: "type[Effect] | None" = None, **kwargs: Any) -> None:
        for text in TEXTS if told_as else ():
            setattr(cls, text, getattr(told_as, text))
        cls.owner = cls.__module__.rsplit(".", 1)[-1]
        super().__init_subclass__(**kwargs)
        _check_declaration(cls)

    @classmethod
    def name(cls) -> str:
        """The effect's name: that of its file."""
        return cls.owner

    @classmethod
    def fitted(cls) -> list[str]:
        """The numbers that a fit moves."""
        return [field for field in cls.parameters() if field not in cls.held]

    @classmethod
    def arguments(cls) -> list[str]:
        """The kernel's argument names in order."""
        return list(inspect.signature(cls.kernel).parameters)


def _check_declaration(cls: type[Effect]) -> None:
    who = f"effect '{cls.owner}' ({cls.__name__})"
    _check_place(cls, who)
    _check_arguments(cls, who)
    _check_numbers(cls, who)
    if unknown := set(cls.traits) - TRAITS:
        raise EffectError(f"{who}: unknown traits {sorted(unknown)}; known: {sorted(TRAITS)}")
    for what, named in {"evolution": cls.evolution, "free": cls.free}.items():
        if unknown := {*named} - set(cls.state):
            raise EffectError(f"{who}: {what} of {sorted(unknown)}; states: {sorted(cls.state)}")
    for text in ("title", "signature", "explanation"):
        if not getattr(cls, text):
            raise EffectError(f"{who}: '{text}' is empty")


def _check_place(cls: type[Effect], who: str) -> None:
    if cls.port not in PORTS:
        raise EffectError(f"{who}: port '{cls.port}' is unknown; ports: {', '.join(PORTS)}")
    port = PORTS[cls.port]
    for argument, signal in cls.reads.items():
        if signal not in SIGNALS:
            raise EffectError(f"{who}: reads '{signal}'; signals: {', '.join(SIGNALS)}")
        if SIGNALS[signal].each not in READABLE[port.each]:
            raise EffectError(f"{who}: '{argument}' reads '{signal}', not seen at {cls.port}")
    if port.every == "once" and cls.state:
        raise EffectError(f"{who}: {cls.port} is asked once, so there is nothing to remember")


def _check_arguments(cls: type[Effect], who: str) -> None:
    if "kernel" not in vars(cls):
        raise EffectError(f"{who}: no kernel; define it as a static method")
    if not isinstance(inspect.getattr_static(cls, "kernel"), staticmethod):
        raise EffectError(f"{who}: the kernel must be a static method")
    pipe = PORTS[cls.port].combine == "pipe"
    wanted = [*(["upstream"] if pipe else []), *cls.reads, *cls.state, *cls.parameters()]
    got = [a for a in cls.arguments() if a not in OPTIONAL]
    if set(got) != set(wanted) or len(wanted) != len(set(wanted)):
        raise EffectError(f"{who}: kernel takes ({', '.join(got)}), declared: {', '.join(wanted)}")


def _check_numbers(cls: type[Effect], who: str) -> None:
    numbers = cls.parameters()
    for field, value in cls.neutral.items():
        if field not in numbers:
            raise EffectError(f"{who}: neutral names '{field}'; numbers: {', '.join(numbers)}")
        if not numbers[field].low <= value <= numbers[field].high:
            raise EffectError(f"{who}: neutral {field} = {value} is outside its bounds")
    if unknown := {*cls.held} - set(numbers):
        raise EffectError(f"{who}: held names {sorted(unknown)}; numbers: {', '.join(numbers)}")
    if unknown := set(cls.taught) - set(cls.reads):
        raise EffectError(f"{who}: taught names {sorted(unknown)}; reads: {', '.join(cls.reads)}")
    if not cls.neutral:
        raise EffectError(f"{who}: no neutral numbers, so models would not be nested")
    symbols = [about.symbol for about in numbers.values()]
    taken = [s for s in symbols if symbols.count(s) > 1 or s in cls.arguments()]
    if taken:
        raise EffectError(f"{who}: symbol '{taken[0]}' has two meanings")
    for field, about in numbers.items():
        if not (about.unit and about.symbol and about.meaning):
            raise EffectError(f"{who}: number '{field}' needs a unit, a symbol and a meaning")


SUFFIX = "_difference"


def differences(effect: type[Effect]) -> dict[str, Parameter]:
    """Half differences of the amplitudes of either sign, by field name; neutral at zero."""
    if PORTS[effect.port].each != "motor":
        return {}
    found = {}
    for field, neutral in effect.neutral.items():
        about = effect.parameters()[field]
        if about.low < neutral < about.high:
            reach = min(neutral - about.low, about.high - neutral)
            found[field + SUFFIX] = Parameter(
                0.0,
                -reach,
                reach,
                about.unit,
                f"Δ{about.symbol}",
                f"half of left minus right: {about.meaning}",
            )
    return found


FUNCTIONS = {  # that an equation may use
    "Abs": np.abs,
    "Max": np.maximum,
    "Min": np.minimum,
    "sign": np.sign,
    "sqrt": np.sqrt,
    "exp": np.exp,
    "log": np.log,
    "sin": np.sin,
    "cos": np.cos,
    "tanh": np.tanh,
    "pi": np.pi,
}


def evaluate(
    effect: type[Effect],
    text: str,
    numbers: Mapping[str, float],
    arguments: Mapping[str, np.ndarray | float],
) -> np.ndarray:
    """Value of an effect's equation for numbers by field name and arguments by name.

    Raises EffectError when the text is no expression in those names.
    """
    symbols = {about.symbol: numbers[name] for name, about in effect.parameters().items()}
    names = {**FUNCTIONS, **arguments, **symbols, "__builtins__": {}}
    try:
        tree = _Real().visit(ast.parse(text.strip(), mode="eval"))
        value = eval(compile(ast.fix_missing_locations(tree), "<equation>", "eval"), names)
    except (SyntaxError, NameError, TypeError) as wrong:
        known = ", ".join([*symbols, *arguments, *FUNCTIONS])
        raise EffectError(f"equation '{text}': {wrong}; it may use {known}") from wrong
    return np.asarray(value, dtype=float) * np.ones(_length(arguments))


class _Real(ast.NodeTransformer):
    """Whole numbers as numbers of a machine: a power of powers of those overflows at once."""

    def visit_Constant(self, node: ast.Constant) -> ast.AST:
        return ast.Constant(float(node.value)) if type(node.value) is int else node


def _length(arguments: Mapping[str, np.ndarray | float]) -> int:
    return max((np.size(v) for v in arguments.values()), default=1)
