r"""Slipping: forces that have no value where bodies do not slip.

Coulomb's law, :math:`-\mu N\, v / |v|` for the slip velocity v, has no value at v = 0. A slip speed
s in :math:`\sqrt{|v|^2 + s^2}` regularises it. Without one [domain] must exclude v = 0, since a
motion would come to rest where the rates are NaN.
Comes in: a Setting with forces. Goes out: nothing, or an error at the force.
Read next: `coadjoint.derive.mechanics.external`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import suppress

from coadjoint.derive import assembly
from coadjoint.derive.setting import Setting, fault, list_components, once
from coadjoint.elementary import ELEMENTARY
from coadjoint.errors import DerivationError
from coadjoint.exact import Element
from coadjoint.exact.signs import sign
from coadjoint.exact.text import element_text
from coadjoint.spec import Formula

#: Velocities, and momenta, by name.
Point = Mapping[str, Element]


@once
def check_slipping(setting: Setting) -> None:
    """Refuse forces without a value at velocities that [domain] does not exclude.

    Raises:
        DerivationError: There is such a force.
    """
    spec = setting.spec if setting.spec.reduction is None else setting.spec.reduction.whole
    if not spec.is_forced:
        return
    reactions = [name for each in spec.constraints for name in each.reactions]
    own = assembly.make_setting(spec, reactions)  # whose functions are not those of the routes
    names = list_components(spec.having_role("velocity"))
    seen = list[Element]()
    for formula, part in _acting(own, names):
        for divisor in _list_divisors(own, part):
            if divisor not in seen and _may_vanish(own, divisor, names):
                raise _without_value(own, formula, divisor)
            seen.append(divisor)


def _acting(setting: Setting, names: tuple[str, ...]) -> Iterator[tuple[Formula, Element]]:
    """The components of each force, and of the slopes of Rayleigh's function."""
    spec, reactions = setting.spec, setting.reactions
    for force in spec.forces.values():
        yield from ((force, part) for part in setting.components(force, reactions))
    if spec.dissipation is not None:
        lost = setting.formula(spec.dissipation, reactions)
        yield from ((spec.dissipation, x) for x in setting.field.gradient(lost, names))


def _list_divisors(setting: Setting, part: Element) -> Iterator[Element]:
    """The factors of a denominator, of square roots their arguments; arguments of logarithms."""
    field = setting.field
    roots = {each.generator for each in field.adjoined.values() if each.function == "sqrt"}
    called = (field.adjoined[name] for name in sorted(field.functions_in(part)))
    edged = (each for each in called if not ELEMENTARY[each.function].has_edge)
    yield from (inside for each in edged if (inside := field.domain_of(each)) is not None)
    for factor, _ in field.fraction(part.combine())[1] if part.parts else ():
        divisor = field.from_polynomial(factor)
        (name, *others) = field.names_in(divisor)
        is_root = not others and name in roots and divisor == field[name]
        yield field.adjoined[name].argument if is_root else divisor


def _may_vanish(setting: Setting, divisor: Element, names: tuple[str, ...]) -> bool:
    """Whether velocities in the domain are known at which a divisor is zero."""
    with suppress(ZeroDivisionError, OverflowError):  # where other divisors vanish, too
        point = _find_zero(setting, divisor, names)
        return point is not None and _is_in_domain(setting, {**point, **_momenta(setting, point)})
    return False


def _find_zero(setting: Setting, divisor: Element, names: tuple[str, ...]) -> Point | None:
    """Velocities at which a divisor is zero: all zero, or where a sum of squares is least."""
    field, point = setting.field, dict[str, Element]()
    rest = dict.fromkeys(names, field.zero)
    if not field.reach(divisor) & {*names}:
        return None
    if field.is_zero(field.substitute(divisor, rest)):
        return rest
    if all(field.substitute(slope, rest) == 0 for slope in field.gradient(divisor, names)):
        return None
    for name in names:
        slope = field.derivative(divisor, name)
        curve = field.derivative(slope, name)
        if name in field.reach(curve) or field.is_zero(curve):
            continue
        least = {name: (field[name] - slope / curve).combine()}
        divisor = field.substitute(divisor, least)
        point = {n: field.substitute(value, least) for n, value in point.items()} | least
    if not field.is_zero(divisor):
        return None
    return rest | {name: field.substitute(value, rest) for name, value in point.items()}


def _momenta(setting: Setting, point: Point) -> Point:
    """The momenta at velocities: ``dl/dv``, or 0 at rest where ``dh/dp`` is 0 there."""
    field, spec, names = setting.field, setting.spec, setting.momenta
    if names and spec.lagrangian is not None:
        slopes = field.gradient(setting.lagrangian, [xi for xi, _, _ in setting.conjugates])
        weighted = zip(setting.conjugates, slopes, strict=True)
        return {name: field.substitute(p * w, point) for (_, name, w), p in weighted}
    none = dict.fromkeys(names, field.zero)
    slopes = field.gradient(setting.hamiltonian, names) if names else ()
    rest = (field.substitute(slope, none) for slope in slopes)
    return none if not any(point.values()) and all(map(field.is_zero, rest)) else {}


def _is_in_domain(setting: Setting, point: Point) -> bool:
    """Whether velocities satisfy the constraints and no condition of [domain] excludes them."""
    field = setting.field
    sides = (
        left - right
        for each in setting.spec.constraints
        for left, right in zip(*map(setting.components, (each.left, each.right)), strict=True)
    )
    values = (
        (field.substitute(each.element, point), each.strict) for each in field.region.conditions
    )
    return all(field.is_zero(field.substitute(side, point)) for side in sides) and all(
        not strict if field.is_zero(value) else sign(field, value, strict=not strict) != -1
        for value, strict in values
    )


def _without_value(setting: Setting, formula: Formula, divisor: Element) -> DerivationError:
    """The error of a force that has no value where a divisor is zero."""
    text = element_text(setting.field, divisor)
    return fault(
        setting,
        formula,
        f"the force has no value where {text} is 0, as friction at zero slip; expected a force "
        f"with a value at every velocity in the domain. Add the square of a slip speed to {text}, "
        f'or write [domain] with slipping = "{text} > 0.0001".',
        text,
    )
