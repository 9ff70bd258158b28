r"""Noise by Hamiltonians: that it keeps the bracket, and what it keeps and changes.

A field :math:`g_k = \{x, h_k\}` is Poisson, so that each path stays on its symplectic leaf:

.. math:: \{g^i, x^j\} + \{x^i, g^j\} = g(\{x^i, x^j\}).

By the chain rule of Stratonovich a function F is kept on each path where
:math:`\{F, h\} = \{F, h_k\} = 0`. Two processes commute where :math:`[g_k, g_l] = 0`; where all do,
methods that take increments alone can have the strong order 1, else 1/2 (Kloeden and Platen 1992).
Comes in: a motion with noise. Goes out: statements, and what must be zero.
Read next: `coadjoint.prove.claims`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from functools import partial
from itertools import combinations

from coadjoint.derive import Equations
from coadjoint.derive.mechanics.noise import NoiseField, ito_drift, noise_fields
from coadjoint.exact import Element
from coadjoint.exact.dense import dot
from coadjoint.prove.findings import finding, first_nonzero, for_parameters
from coadjoint.prove.identities import casimir_defects, gradient, noise_rates
from coadjoint.prove.motion import Motion
from coadjoint.prove.zero import Examined
from coadjoint.spec import Formula


def has_noise(motion: Motion) -> bool:
    """Whether Wiener processes move the state."""
    return bool(motion.spec.noise)


def about_noise(motion: Motion) -> Iterator[Examined]:
    """The fields, what Ito's calculus adds, Casimirs, and which processes commute."""
    first, fields = motion.equations, noise_fields(motion.setting)
    for each, declared in zip(fields, motion.spec.noise, strict=True):
        yield (
            f"{each.name} moves the state by {{x, {declared.formula.in_one_line}}}",
            "noise",
            partial(_field_defects, first, each),
        )
        yield (
            f"{each.name} keeps the Poisson bracket: {{g_i, x_j}} + {{x_i, g_j}} = g({{x_i, x_j}})",
            "noise",
            partial(_bracket_defects, first, each),
        )
    yield (
        "in the sense of Ito the drift has 1/2 sum_k {{x, h_k}, h_k} in addition",
        "noise",
        partial(_ito_defects, first, fields),
    )
    for casimir in motion.spec.casimirs:
        parts = motion.setting.components(casimir)
        yield (
            tell_kept(casimir),
            "conserved",
            partial(_list_rates, first, parts),
        )
    for one, other in combinations(fields, 2):
        yield _about_pair(motion, one, other)


def tell_kept(casimir: Formula) -> str:
    """The statement that the noise keeps a Casimir."""
    return f"the noise keeps {casimir.in_one_line} on each path: {{C, h_k}} = 0"


def tell_commuting(one: str, other: str) -> str:
    """The statement that two processes commute."""
    return f"{one} and {other} commute: [g_k, g_l] = 0"


def _field_defects(first: Equations, each: NoiseField) -> list[Element]:
    """``g - {x, h_k}``."""
    brackets = casimir_defects(first, each.hamiltonian)
    return [g - x for g, x in zip(each.field, brackets, strict=True)]


def _bracket_defects(first: Equations, each: NoiseField) -> list[Element]:
    """``{g_i, x_j} + {x_i, g_j} - g({x_i, x_j})`` for i < j."""
    tensor = first.exact.poisson_tensor
    assert tensor is not None, "noise acts by a bracket"
    slopes = [gradient(first, g) for g in each.field]
    return [
        dot(slopes[i], [row[j] for row in tensor])
        + dot(tensor[i], slopes[j])
        - dot(gradient(first, tensor[i][j]), each.field)
        for i, j in combinations(range(len(tensor)), 2)
    ]


def _ito_defects(first: Equations, fields: Sequence[NoiseField]) -> list[Element]:
    """What Ito's drift has in addition, minus the brackets that it is."""
    ring, half = first.setting.field, Fraction(1, 2)
    tensor = first.exact.poisson_tensor
    assert tensor is not None, "noise acts by a bracket"
    twice = []
    for each in fields:
        slopes = gradient(first, each.hamiltonian)
        columns = [dot(row, slopes) for row in tensor]
        twice.append([dot(gradient(first, inner), columns) for inner in columns])
    sums = [ring.sum(row) * half for row in zip(*twice, strict=True)]
    return [a - b for a, b in zip(ito_drift(first.setting), sums, strict=True)]


def _list_rates(first: Equations, parts: Sequence[Element]) -> list[Element]:
    """``{F, h_k}`` of some functions."""
    return [rate for part in parts for rate in noise_rates(first, part)]


def _about_pair(motion: Motion, one: NoiseField, other: NoiseField) -> Examined:
    """Whether two processes commute."""
    first, names = motion.equations, motion.setting.state
    values = {
        name: dot(gradient(first, b), one.field) - dot(gradient(first, a), other.field)
        for name, a, b in zip(names, one.field, other.field, strict=True)
    }
    name, decision = first_nonzero(values, motion.field)
    scope = for_parameters(motion.setting, [values.get(name, motion.field.zero)])
    pair = f"{one.name} and {other.name}"
    return finding(
        "noise",
        decision,
        tell_commuting(one.name, other.name),
        f"{pair} do not commute{scope}: they move {name} otherwise in the other order",
    )
