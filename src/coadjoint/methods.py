"""Methods: the one list of methods of integration that keep the structure of a motion.

Comes in: nothing. Goes out: an entry for each method, which choices, solvers, texts in C, messages
and documents read. For another method add an entry here, its step in NumPy as a module of
`coadjoint.solve.methods`, and the same in C below ``templates/c/methods``.
Read next: `coadjoint.solve.methods`.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any, Final

from coadjoint.limits import C_STATEMENTS

#: How many of its last offsets each search keeps for the next step.
TERMS: Final = 3
#: The method that is the motion itself, to rounding: its order is that of what its series leave
#: out, in parts of a step, and no run shows it.
EXACT: Final = "exact_body"
#: Of how many steps one is composed, by its order, which is 1 with noise.
STEPS: Final = MappingProxyType({1: 1, 2: 1, 4: 5, 6: 9})
#: The same in words, with the lengths of the steps.
_COMPOSED: Final = MappingProxyType(
    {
        4: "five steps with the lengths of M. Suzuki (Physics Letters A 146 (1990) 319) of ",
        6: "nine steps with the lengths of W. Kahan and R.-C. Li (Mathematics of Computation 66 "
        "(1997) 1089) of ",
    }
)


def list_fitting(judged: Iterable[Mapping[str, Any]]) -> list[Mapping[str, Any]]:
    """Of the methods that a certificate judges those that apply, as ``"auto"`` prefers them."""
    fitting = [each for each in judged if each["cost"]]
    return sorted(fitting, key=lambda each: (not each["rank"], each["rank"]))


#: Laws of a step that are no integrals: what forces, friction or a symmetric bracket do.
BALANCED: Final = "the balance of the energy"
FALLING: Final = "the energy never grows"
GROWING: Final = "the entropy never falls"


def list_kept(judged: Mapping[str, Any]) -> list[str]:
    """What one of them keeps exactly."""
    tensor = ["Poisson tensor"] if judged["is_poisson"] else []
    return [*judged["exactly"], *tensor, *judged.get("laws", ())]


def list_unfit(judged: Iterable[Mapping[str, Any]]) -> dict[str, list[str]]:
    """Those that do not apply, by the reason."""
    unfit = dict[str, list[str]]()
    for each in judged:
        if not each["cost"]:
            unfit.setdefault(each["decides"], []).append(each["name"])
    return unfit


def tell_order(name: str, order: float) -> str:
    """The order of a method as text; of the motion itself, which has none, that it is exact."""
    return "exact" if name == EXACT else f"{order:g}"


@dataclass(frozen=True)
class Sphere:
    """A factor so(3) or se(3) of an algebra, by places in the state.

    Attributes:
        rows: Those of the vector on the sphere: Pi, or Gamma of se(3).
        tangent: Those of Pi of se(3), or ().
    """

    rows: tuple[int, ...]
    tangent: tuple[int, ...] = ()

    @property
    def pairs(self) -> list[tuple[int, int]]:
        """Each row with that of the tangent; none where there is no tangent."""
        return list(zip(self.rows, self.tangent, strict=False))

    @property
    def turning(self) -> tuple[int, ...]:
        """Rows of the momentum, by whose slopes the energy turns all vectors of the factor."""
        return self.tangent or self.rows


@dataclass(frozen=True)
class Carrier:
    """What is reconstructed and turns with the vectors of a sphere.

    Attributes:
        sphere: The place of the sphere.
        rows: What they turn, by places below the state.
        is_half: Whether it turns by half the angle, as unit quaternions do.
        square: That of the multiple of the cross product that the bracket of the sphere is.
    """

    sphere: int
    rows: tuple[int, ...]
    is_half: bool
    square: float


@dataclass(frozen=True)
class StructuredMethod:
    """A method that keeps some structure of a motion, with steps of fixed length.

    Attributes:
        name: As a person writes it.
        file: Its module of `coadjoint.solve.methods`, and its file below ``templates/c/methods``.
        order: By what power of the step an error falls; with noise, that of a mean over paths.
        needs: Functions of the kernel that its steps call, the rates apart.
        keeps: What it keeps exactly, as a clause.
        theorem: What it is and why it keeps that, with the source.
        expects: Of a system to which it does not apply, what it expects of others.
        noise: How the theorem goes on where there is noise; "" of a method without noise.
    """

    name: str
    file: str
    order: int
    needs: tuple[str, ...]
    keeps: str
    theorem: str
    expects: str = "rates without kinks"
    noise: str = ""

    @property
    def macro(self) -> str:
        """What chooses it in C."""
        return self.name.upper()

    @property
    def stages(self) -> int:
        """How many states are searched for in a step; 0 of maps."""
        if self.file == "sequence":
            return 0
        return self.order // 2 if self.file == "gauss" else STEPS[self.order]

    def count_memory(self, rows: int) -> int:
        """How many numbers a step of a state of so many rows leaves for the next one.

        First what rounding took of the state; then, for each stage, where it was searched for with
        success, as far from the state, and how this changed.
        """
        return rows * self.parts

    @property
    def parts(self) -> int:
        """How many numbers of each row that are; sums of maps that keep nothing are plain."""
        return 0 if self.name == "kahan" else 1 + TERMS * self.stages

    def compose(self, *orders: int) -> tuple[StructuredMethod, ...]:
        """This method of order 2, and those of higher orders that are made of steps of it."""
        composed = (
            replace(
                self,
                name=f"{self.name}{order}",
                order=order,
                theorem=_COMPOSED[order] + self.theorem,
                noise="",
            )
            for order in orders
        )
        return (self, *composed)

    @property
    def of_paths(self) -> StructuredMethod:
        """The same method for motions with noise, in the sense of Stratonovich.

        A step on orbits asks for the gradient of the whole energy of a step, noise and all.
        """
        is_action = "orbits" in self.needs
        return replace(
            self,
            order=1,
            needs=tuple(each for each in self.needs if each not in ACTION),
            keeps=_ON_PATHS if is_action else self.keeps,
            theorem=f"{self.theorem}, {self.noise}",
            expects=self.expects + ", and noise by brackets" * is_action,
        )


@dataclass(frozen=True)
class JudgedMethod:
    """What is proved of a method that keeps structure, for one system.

    Attributes:
        name: Of the method.
        order: By what power of the step an error falls; with noise, that of a path, which is 1/2
            unless all processes commute.
        exactly: Integrals of this system that it keeps to the rounding of each step, by name; with
            noise, on each path.
        nearly: The other integrals; a step changes them by an error of its order.
        is_poisson: Whether its step is a Poisson map of this system; with noise, on each path.
        laws: What else holds in each step, to rounding: `BALANCED`, `FALLING` or `GROWING`.
        decides: The fact that decides: why it keeps these; of one that does not apply, why not.
        cost: What a step costs, in words; "" of one that does not apply.
        rank: Its place in the order in which ``"auto"`` takes methods, from 1; 0 for not at all.
    """

    name: str
    order: float
    exactly: tuple[str, ...] = ()
    nearly: tuple[str, ...] = ()
    is_poisson: bool = False
    laws: tuple[str, ...] = ()
    decides: str = ""
    cost: str = ""
    rank: int = 0

    @property
    def applies(self) -> bool:
        """Whether the system has it."""
        return bool(self.cost)


_QUADRATIC: Final = (
    "E. Hairer, C. Lubich and G. Wanner, Geometric Numerical Integration (2006), theorem IV.2.1"
)

#: Functions of the kernel of which a motion is made that is a bracket with an energy.
ACTION: Final = ("energy_gradient", "bracket_vector")
#: Those of it that discrete gradients call.
BALANCE: Final = (*ACTION, "energy")
#: Functions that a motion by Nambu's bracket keeps in addition to its energy, and their gradients.
DISTINGUISHED: Final = ("distinguished", "distinguished_gradient")
#: The entropy of a metriplectic motion, its gradient, and the matrix that this is multiplied by.
RELAXED: Final = ("entropy", "entropy_gradient", "metric_vector")
#: All that methods ask of a kernel beyond its rates.
ASKED: Final = (*BALANCE, *RELAXED, "sandwich", *DISTINGUISHED)
#: Files of methods by a discrete gradient of the energy alone, with one tensor.
BY_ENERGY: Final = ("discrete_gradient", "average_gradient")
#: The derivatives of the rates, by which Newton's method solves the equations of steps.
JACOBIAN: Final = "jacobian"
#: Those of a motion that stays on coadjoint orbits, on which the bracket acts.
_ORBITS: Final = (*ACTION, "orbits")
_ON_ORBITS: Final = (
    "Casimirs, to the rounding of each step, and the Poisson bracket: it stays on coadjoint orbits"
)
_ON_PATHS: Final = "Casimirs, to the rounding of each step, and the Poisson bracket"
_OF_ONE_ENERGY: Final = "with H + sum_k H_k dW_k/h as the energy of a step, in Stratonovich's sense"

_BALANCE: Final = (
    "the energy, to the rounding of each step, or its balance with the power of forces; Casimirs "
    "of degree 2 at the most"
)
_TENSOR: Final = (
    "J(m) times a discrete gradient of the energy, J an antisymmetric tensor at the middle m of a "
    "step (R. I. McLachlan, G. R. W. Quispel and N. Robidoux, Philosophical Transactions A 357 "
    "(1999) 1021)"
)
_TENSORS: Final = "an energy, and a Poisson or almost-Poisson tensor in closed form"

_ENTRIES: Final = (
    *StructuredMethod(
        name="midpoint",
        file="midpoint",
        order=2,
        needs=(),
        keeps="linear and quadratic integrals, to the rounding of each step",
        theorem=f"the implicit midpoint, which keeps quadratic integrals ({_QUADRATIC})",
        noise="and for Stratonovich's equations keeps them on each path (J. Hong, D. Xu and P. "
        "Wang, Applied Numerical Mathematics 87 (2015) 38), with bounded increments (G. N. "
        "Milstein, Yu. M. Repin and M. V. Tretyakov, SIAM Journal on Numerical Analysis 40 (2002) "
        "1583)",
    ).compose(4, 6),
    *StructuredMethod(
        name="coadjoint_mean",
        file="coadjoint_mean",
        order=2,
        needs=_ORBITS,
        keeps=_ON_ORBITS,
        theorem="the coadjoint-mean method, a Poisson map on the dual of any Lie algebra: the "
        "discrete Hamilton-Pontryagin principle with tau = exp (N. Bou-Rabee and J. E. Marsden, "
        "Foundations of Computational Mathematics 9 (2009) 197)",
        expects="a motion that is the bracket with its energy alone, which is linear in the state",
        noise=_OF_ONE_ENERGY,
    ).compose(4, 6),
    *StructuredMethod(
        name="spherical_midpoint",
        file="spherical_midpoint",
        order=2,
        needs=(*_ORBITS, "spheres"),
        keeps=f"{_ON_ORBITS}; on one sphere also a quadratic energy",
        theorem="the spherical midpoint, a Poisson map on products of the duals of so(3) (R. I. "
        "McLachlan, K. Modin and O. Verdier, Mathematics of Computation 86 (2017) 2325) and, as "
        "their limit in dual numbers, of se(3) (docs/decisions/coadjoint-orbits.md)",
        expects="a motion that is the bracket with its energy alone, on the dual of a product of "
        "so(3) and se(3)",
        noise=_OF_ONE_ENERGY,
    ).compose(4, 6),
    *StructuredMethod(
        name="isospectral_midpoint",
        file="isospectral_midpoint",
        order=2,
        needs=(*_ORBITS, "sandwich"),
        keeps=f"{_ON_ORBITS}; the spectrum of the matrix",
        theorem="the isospectral midpoint, a Poisson map on the dual of an algebra of matrices "
        "with all products B A B (K. Modin and M. Viviani, Foundations of Computational "
        "Mathematics 20 (2020) 889)",
        expects="a motion that is the bracket with its energy alone, on the dual of an algebra of "
        "3 to 28 matrices other than so(3) that has all products B A B, or lacks multiples of 1 or "
        "i alone: so(n), so(p,q), se(n), su(n), u(n), sl(n), gl(n), sp(2n), symmetric matrices "
        "with the bracket X N Y - Y N X, and so(n) with symmetric matrices that turn, in a basis "
        f"in which these products take at most {C_STATEMENTS} statements",
    ).compose(4, 6),
    *(
        StructuredMethod(
            name=f"gauss{order}",
            file="gauss",
            order=order,
            needs=(),
            keeps="linear and quadratic integrals, to the rounding of each step",
            theorem=f"the method of Gauss with {order // 2} stages, which keeps quadratic "
            f"integrals ({_QUADRATIC}), with shares of stages that sum to 1 without rounding "
            "(M. Antonana, J. Makazaga and A. Murua, Numerical Algorithms 76 (2017) 861)",
        )
        for order in (4, 6, 8)
    ),
    *StructuredMethod(
        name="discrete_gradient",
        file="discrete_gradient",
        order=2,
        needs=BALANCE,
        keeps=_BALANCE,
        theorem=f"{_TENSOR}, by the gradient at m corrected along the step (O. Gonzalez, Journal "
        "of Nonlinear Science 6 (1996) 449)",
        expects=_TENSORS,
    ).compose(4),
    StructuredMethod(
        name="average_gradient",
        file="average_gradient",
        order=2,
        needs=ACTION,
        keeps=f"{_BALANCE}, of energies that are polynomials of degree 10 at the most",
        theorem=f"{_TENSOR}, by the mean of the gradient along the step (E. Celledoni et al., "
        "Journal of Computational Physics 231 (2012) 6770)",
        expects=_TENSORS,
    ),
    StructuredMethod(
        name="metriplectic_gradient",
        file="metriplectic_gradient",
        order=2,
        needs=(*BALANCE, *RELAXED, "metriplectic"),
        keeps="the energy, to the rounding of each step; the entropy never falls",
        theorem="the bracket times a discrete gradient g of the energy plus G times one, s, of the "
        "entropy, at the middle of a step, the bracket projected along s and G along g, so that "
        "both conditions of degeneracy hold (P. J. Morrison, Physica D 18 (1986) 410; O. Gonzalez, "
        "Journal of Nonlinear Science 6 (1996) 449; H. C. Oettinger, Journal of Non-Equilibrium "
        "Thermodynamics 43 (2018) 89)",
        expects="a metriplectic motion P dh + G dS alone, with P dS = 0 and G dh = 0, whose tensor "
        "and G are in closed form",
    ),
    *StructuredMethod(
        name="nambu_gradient",
        file="nambu_gradient",
        order=2,
        needs=("energy", "energy_gradient", *DISTINGUISHED, "nambu"),
        keeps="the energy and all distinguished functions, to the rounding of each step",
        theorem="the product of discrete gradients of the energy and of all distinguished "
        "functions, which keeps each (R. I. McLachlan, G. R. W. Quispel and N. Robidoux, "
        "Philosophical Transactions A 357 (1999) 1021)",
        expects="a motion by Nambu's bracket alone, declared with at most six coordinates",
    ).compose(4),
)

_BLANES: Final = (
    " with the parts of S. Blanes and P. C. Moan, Journal of Computational and Applied Mathematics "
    "142 (2002) 313"
)

_MAPS: Final = (
    *(
        StructuredMethod(
            name=f"splitting{suffix}",
            file="sequence",
            order=order,
            needs=("flow1",),
            keeps="the Poisson tensor, all Casimirs and leaves, to rounding; the energy within a "
            "bound",
            theorem=f"a symmetric product of flows of parts of the energy{parts}, a Poisson map "
            "(R. I. McLachlan, Physical Review Letters 71 (1993) 3043; E. Hairer, C. Lubich and G. "
            "Wanner, Geometric Numerical Integration (2006), VII.4 and IX)",
        )
        for suffix, order, parts in (("", 2, ""), ("4", 4, _BLANES), ("6", 6, _BLANES))
    ),
    StructuredMethod(
        name="kahan",
        file="sequence",
        order=2,
        needs=("kahan",),
        keeps="nothing exactly; many quadratic motions that are integrable keep modified integrals",
        theorem="(1 - h/2 f'(x)) d = h f(x), symmetric and birational, and no Poisson map (E. "
        "Celledoni, R. I. McLachlan, B. Owren and G. R. W. Quispel, Journal of Physics A 46 (2013) "
        "025201)",
    ),
    StructuredMethod(
        name="exact_body",
        file="sequence",
        order=10,
        needs=("exact_body",),
        keeps="all that the free motion of a body keeps, to rounding",
        theorem="the exact flow of Euler's top by elliptic functions (E. Celledoni, F. Fasso, N. "
        "Safstrom and A. Zanna, SIAM Journal on Scientific Computing 30 (2008) 2084)",
    ),
)

_HEUN: Final = StructuredMethod(
    name="heun",
    file="heun",
    order=1,
    needs=(),
    keeps="linear integrals, to the rounding of each step",
    theorem="Heun's method for Stratonovich's equations (W. Ruemelin, SIAM Journal on Numerical "
    "Analysis 19 (1982) 604), which keeps linear integrals on each path",
)

#: With a fixed step, without a method that keeps structure; and with noise.
PLAIN: Final = "dop853"
PLAIN_WITH_NOISE: Final = "midpoint"

#: What orders and integrals of methods are those of, with noise.
OF_PATHS: Final = (
    "in the sense of Stratonovich, what is kept is kept on each path; orders are those of paths, "
    "and those of means over paths are 1"
)

#: Methods of motions with noise, by name.
NOISY: Final = MappingProxyType(
    {_HEUN.name: _HEUN} | {each.name: each.of_paths for each in reversed(_ENTRIES) if each.noise}
)
_TABLE: Final = {each.name: each for each in _ENTRIES}
#: Every method that keeps structure, by name.
STRUCTURED: Final = MappingProxyType(_TABLE)
_MAPPED: Final = {each.name: each for each in _MAPS}
#: Those whose steps are a sequence of maps: explicit, or with one linear equation.
MAPPED: Final = MappingProxyType(_MAPPED)


#: Why compositions are refused where energy is lost.
BACKWARD: Final = (
    "some of its steps go back in time, where friction gives energy: those of a composition of "
    "order above 2, whose lengths have cubes with the sum 0"
)


def list_backward() -> set[str]:
    """Names of methods that are compositions with steps back in time.

    >>> sorted(list_backward())[:3]
    ['coadjoint_mean4', 'coadjoint_mean6', 'discrete_gradient4']
    """
    composed = (each for each in (*_ENTRIES, *_MAPS) if each.file != "gauss")
    return {each.name for each in composed if each.name[-1] in "46"}


def list_structured(functions: Collection[str]) -> tuple[StructuredMethod, ...]:
    """The methods that the functions of a solver allow.

    Motions with noise have methods of their own, and steps that end at kinks are explicit.

    Args:
        functions: Their names, ``kinks`` among them where the rates have some, ``orbits`` where
            the motion stays on coadjoint orbits, ``spheres`` where these are spheres, ``nambu``
            where the motion is Nambu's product of gradients, and ``metriplectic`` where it is a
            bracket with the energy and G times the gradient of the entropy.

    >>> [method.name for method in list_structured(["rhs"])]
    ['midpoint', 'midpoint4', 'midpoint6', 'gauss4', 'gauss6', 'gauss8']
    >>> list_structured(["rhs", "noise"])
    ()
    """
    if "noise" in functions or "kinks" in functions:
        return ()
    refused = BY_ENERGY if "entropy" in functions else ()
    able = (each for each in _ENTRIES if each.file not in refused)
    return tuple(each for each in able if set(each.needs) <= set(functions))


def list_noisy(functions: Collection[str]) -> tuple[StructuredMethod, ...]:
    """The methods for noise that the functions of a solver allow; none without noise.

    Args:
        functions: As of `list_structured`: ``orbits`` where drift and noise stay on coadjoint
            orbits, ``spheres`` where these are spheres.

    >>> [method.name for method in list_noisy(["rhs", "noise"])]
    ['heun', 'midpoint']
    >>> list_noisy(["rhs"])
    ()
    """
    if "noise" not in functions:
        return ()
    return tuple(each for each in NOISY.values() if set(each.needs) <= set(functions))
