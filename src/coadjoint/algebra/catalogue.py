"""Lie algebras by name, and the representations that every algebra has.

Comes in: a name as a spec writes it, such as ``so(8)`` or ``sp(4)``. Goes out: a `LieAlgebra`, or
one of its representations. What a name costs is known before anything is built.
Read next: `coadjoint.algebra.families`, where the bases are.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from difflib import get_close_matches
from functools import cache
from types import MappingProxyType

from coadjoint.algebra import families, harmonics
from coadjoint.algebra.attitudes import attitude, quaternion
from coadjoint.algebra.extensions import subalgebra
from coadjoint.algebra.lie_algebra import LieAlgebra, SparseMatrix, check_size
from coadjoint.algebra.matrices import size, without_zero_places
from coadjoint.algebra.representation import (
    Representation,
    adjoint,
    coadjoint,
    columns,
    defining,
    rows,
    symmetric,
    trivial,
)
from coadjoint.errors import AlgebraError, LimitError
from coadjoint.limits import GENERATORS


@dataclass(frozen=True)
class Family:
    """Named algebras of one kind.

    Attributes:
        form: How the name is written, for messages.
        pattern: What a name of the family looks like; its groups are the sizes.
        accepts: Whether there is an algebra of these sizes.
        sizes: What is accepted, in words.
        dimension: The number of generators.
        build: The algebra.
    """

    form: str
    pattern: str
    accepts: Callable[..., bool]
    sizes: str
    dimension: Callable[..., int]
    build: Callable[..., LieAlgebra]


def _family(
    form: str, least: int, dimension: Callable[[int], int], build: Callable[[int], LieAlgebra]
) -> Family:
    """A family ``name(n)``, which may be written ``name(n,R)`` where its form says so."""
    letters = form.partition("(")[0]
    real = "(?:,R)?" if form.endswith(",R)") else ""
    pattern = rf"{letters}\((\d{{1,6}}){real}\)"
    return Family(
        form=form,
        pattern=pattern,
        accepts=lambda n: n >= least,
        sizes=f"n >= {least}",
        dimension=dimension,
        build=build,
    )


def _single(form: str, dimension: int, build: Callable[[], LieAlgebra]) -> Family:
    """A family of one."""
    pattern = re.escape(form)
    return Family(
        form=form,
        pattern=pattern,
        accepts=lambda: True,
        sizes="",
        dimension=lambda: dimension,
        build=build,
    )


FAMILIES = (
    _family("so(n)", 2, lambda n: n * (n - 1) // 2, families.so),
    Family(
        form="so(p,q)",
        pattern=r"so\((\d{1,6}),(\d{1,6})\)",
        accepts=lambda p, q: p >= 1 and q >= 1,
        sizes="p >= 1 and q >= 1",
        dimension=lambda p, q: (p + q) * (p + q - 1) // 2,
        build=families.so_indefinite,
    ),
    _family("se(n)", 2, lambda n: n * (n + 1) // 2, families.se),
    _family("su(n)", 2, lambda n: n * n - 1, families.su),
    _family("harmonics(n)", 2, lambda n: n * n - 1, harmonics.harmonics),
    _family("u(n)", 1, lambda n: n * n, families.u),
    _family("entries(n)", 1, lambda n: n * n, families.entries),
    _family("sl(n,R)", 2, lambda n: n * n - 1, families.sl),
    _family("gl(n,R)", 1, lambda n: n * n, families.gl),
    Family(
        form="sp(2n,R)",
        pattern=r"sp\((\d{1,6})(?:,R)?\)",
        accepts=lambda size: size >= 2 and size % 2 == 0,
        sizes="an even size of at least 2",
        dimension=lambda size: size * (size + 1) // 2,
        build=families.sp,
    ),
    _family("h(n)", 1, lambda n: 2 * n + 1, families.heisenberg),
    Family(
        form="R^n",
        pattern=r"R\^(\d{1,6})",
        accepts=lambda n: n >= 1,
        sizes="n >= 1",
        dimension=lambda n: n,
        build=families.translations,
    ),
    _single("g(3)", 10, families.galilei),
    _single("bargmann", 11, families.bargmann),
    _single("aff(1)", 2, families.affine),
    _single("quaternions", 3, families.quaternions),
    _single("coquaternions", 3, families.coquaternions),
)

ALIASES = {"heisenberg": "h(1)", "galilei": "g(3)"}

#: Members that lists show and laws are tried on: every family, in its smallest telling sizes.
CATALOGUE = (
    *("so(2)", "so(3)", "so(4)", "so(5)", "so(2,1)", "so(3,1)", "so(2,2)", "so(1,1)"),
    *("se(2)", "se(3)", "se(4)", "su(2)", "su(3)", "u(1)", "u(2)", "harmonics(3)"),
    "entries(2)",
    *("sl(2,R)", "sl(3,R)", "gl(1)", "gl(2)", "sp(2)", "sp(4)", "h(1)", "h(2)", "R^3"),
    *("g(3)", "bargmann", "aff(1)", "quaternions", "coquaternions"),
)


def algebra_by_name(name: str, most: int = GENERATORS) -> LieAlgebra:
    """The algebra that a spec names; blanks do not matter.

    Args:
        name: Such as ``so(8)``, ``so(2,1)``, ``sl(3,R)``, ``heisenberg``.
        most: How many generators it may have; by default the limit of the engine.

    Raises:
        AlgebraError: No algebra of that name or size; the message lists what there is.
        LimitError: It would have more generators; nothing has been built.

    >>> algebra_by_name("se(3)").blocks["translation"]
    (3, 4, 5)
    """
    plain = ALIASES.get("".join(name.split()), "".join(name.split()))
    for family in FAMILIES:
        result = re.fullmatch(family.pattern, plain, re.ASCII)
        if result:
            sizes = tuple(map(int, result.groups()))
            _check_sizes(name, family, sizes, most)
            return _build(family, sizes)
    near = get_close_matches(name, (*CATALOGUE, *ALIASES), n=3)
    hint = "Declare it by brackets or matrices."
    if near:
        hint = f"Did you mean {'? Or '.join(map(repr, near))}?"
    raise AlgebraError(
        f"no algebra is called {name!r}; expected one of "
        f"{', '.join((*(family.form for family in FAMILIES), *ALIASES))}. {hint}",
        found=name,
        near=near,
    )


@cache
def _build(family: Family, sizes: tuple[int, ...]) -> LieAlgebra:
    return family.build(*sizes)


def _check_sizes(name: str, family: Family, sizes: tuple[int, ...], most: int) -> None:
    if not family.accepts(*sizes):
        raise AlgebraError(
            f"there is no algebra {name!r}; {family.form} has {family.sizes}.",
            found=name,
            expected=family.sizes,
        )
    check_size(name, family.dimension(*sizes), most)


# -- representations ------------------------------------------------------------------------------

_REPRESENTATIONS: dict[str, Callable[[LieAlgebra], Representation]] = {
    "vector": lambda algebra: _vector(algebra),
    "dual": lambda algebra: _vector(algebra).dual(),
    "defining": lambda algebra: defining(algebra, "defining"),
    "adjoint": adjoint,
    "coadjoint": coadjoint,
    "symmetric": symmetric,
    "columns": columns,
    "rows": rows,
    "trivial": trivial,
}
#: The group element itself, which is seen from one side.
ATTITUDES: dict[str, Callable[[LieAlgebra, str], Representation]] = {
    "attitude": attitude,
    "quaternion": quaternion,
}
REPRESENTATIONS = (*_REPRESENTATIONS, *ATTITUDES)
#: What each of them is, for documents.
MEANINGS: Mapping[str, str] = MappingProxyType(
    {
        "vector": "rotations of vectors on so(n), se(n), g(3) and bargmann, where all else acts as "
        "zero; on other algebras the same as `defining`",
        "dual": "the dual of `vector`",
        "defining": "the algebra's own matrices on columns",
        "adjoint": "of the algebra on itself",
        "coadjoint": "of the algebra on its dual",
        "symmetric": "`S -> X S + S X^T` on symmetric matrices; the entries with the diagonal, row "
        "by row",
        "columns": "`A -> X A` on square matrices, row by row",
        "rows": "`A -> -A X` on square matrices, row by row",
        "trivial": "zero, on one number",
        "attitude": "the group element itself, a matrix row by row: `dg/dt = g xi`, or `xi g` if "
        "the motion is right invariant",
        "quaternion": "the group element as a unit quaternion q0 to q3, for so(3), su(2), and "
        "algebras that contain the rotations apart from the rest",
    }
)


def representation_by_name(
    algebra: LieAlgebra, name: str, invariance: str = "left"
) -> Representation:
    """A representation that every algebra has, by the name a spec uses.

    - ``vector``: the rotation block on R^n for so(n), se(n), g(3) and bargmann (all else acts as
      zero), else the defining matrices; ``dual`` is its dual;
    - ``defining``: the algebra's own matrices on column vectors;
    - ``adjoint``, ``coadjoint``: on the algebra and on its dual;
    - ``symmetric``: ``S -> X S + S X^T`` for the defining X, components S_ij, i <= j, row by row;
    - ``columns``: ``A -> X A`` on square matrices A, row by row;
    - ``rows``: ``A -> -A X`` on square matrices A, row by row;
    - ``trivial``: zero on R;
    - ``attitude``: ``g -> -g X`` on the group element itself, row by row (``X g`` if the motion is
      right-invariant); ``quaternion``: the same on the unit quaternions of so(3) and su(2).

    Raises:
        AlgebraError: No such representation, or it wants matrices and there are none.
    """
    if name in ATTITUDES:
        return ATTITUDES[name](algebra, invariance)
    if name in _REPRESENTATIONS:
        return _REPRESENTATIONS[name](algebra)
    near = get_close_matches(name, REPRESENTATIONS, n=1)
    hint = f" Did you mean {near[0]!r}?" if near else ""
    raise AlgebraError(
        f"{algebra.name} has no representation {name!r}; expected "
        f"{', '.join(map(repr, REPRESENTATIONS))} or one declared under [representations].{hint}",
        found=name,
    )


def representation_on_block(
    algebra: LieAlgebra, places: Sequence[int], name: str, invariance: str = "left"
) -> Representation:
    """A representation of one block, by which the whole algebra acts: the rest of it acts as zero.

    An attitude of a block is named so, since it is not the group element of the whole algebra.

    Args:
        algebra: The acting algebra.
        places: Where the block stands in its basis.
        name: As of `representation_by_name`, for the algebra that the block spans.
        invariance: As there.

    Raises:
        AlgebraError: The block is no subalgebra, has no such representation, or the rest of the
            algebra does not let it act alone.

    >>> turning = representation_on_block(algebra_by_name("se(3)"), (0, 1, 2), "vector")
    >>> turning.act([0, 0, 1, 5, 5, 5], [1, 0, 0])
    (0, 1, 0)
    """
    ones = {algebra.basis[i]: [int(i == k) for k in range(algebra.dimension)] for i in places}
    block = subalgebra(algebra, ones, f"the block {', '.join(ones)} of {algebra.name}")
    block = replace(block, matrices=without_zero_places(block.matrices))
    own = representation_by_name(block, name, invariance)
    title = f"{name} of a block" if name in ATTITUDES else name
    matrices: list[SparseMatrix] = [{} for _ in algebra.basis]
    for place, matrix in zip(places, own.matrices, strict=True):
        matrices[place] = matrix
    try:
        return Representation(algebra, title, own.dimension, tuple(matrices))
    except AlgebraError as error:
        a, b = error.parts["pair"]
        raise AlgebraError(
            f"{algebra.name} does not act through the block {', '.join(ones)} alone: [{a}, {b}] "
            "is not what the matrices of the block make of it. Choose a block that commutators "
            "with the rest of the algebra do not reach, such as a summand.",
            pair=[a, b],
        ) from error


def _vector(algebra: LieAlgebra) -> Representation:
    """The action on vectors of space, where the algebra is a named one that has rotations."""
    if "rotation" not in algebra.blocks or not _is_named(algebra):
        return defining(algebra)
    turning = algebra.blocks["rotation"]
    matrices = tuple(m if i in turning else {} for i, m in enumerate(algebra.matrices))
    return Representation(algebra, "vector", size(matrices), matrices)


def inverse_by(algebra: LieAlgebra) -> str:
    """How the inverse of an attitude is written out: the algebra must be kept by all such matrices.

    Returns:
        ``"transpose"`` for so(n), ``"motion"`` for se(n), ``"cofactors"`` for small linear groups;
        "" for others, whose matrices are the group's on some surface alone.
    """
    if not _is_named(algebra):
        return ""
    kinds = {
        r"so\(\d+\)": "transpose",
        r"se\(\d+\)": "motion",
        r"aff\(1\)|[gs]l\([123](,R)?\)": "cofactors",
    }
    return next((kind for form, kind in kinds.items() if re.fullmatch(form, algebra.name)), "")


def _is_named(algebra: LieAlgebra) -> bool:
    """Whether this is the algebra that its name stands for; a spec may call its own anything."""
    try:
        return algebra_by_name(algebra.name, algebra.dimension) == algebra
    except (AlgebraError, LimitError):
        return False
