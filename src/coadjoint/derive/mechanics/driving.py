r"""Driving: how functions of the state change of themselves, by time and by inputs.

Along a motion :math:`\dot x = X(x, u, t)`,

.. math::
    \frac{df}{dt} = \frac{\partial f}{\partial x} X + \frac{\partial f}{\partial t}
        + \frac{\partial f}{\partial u} \dot u.

The second term is the explicit part, and so is the third where a spec says which input is the rate
of u. Otherwise nobody knows it, since inputs are any functions of time: rates may not need it, and
an integral that has it is one while the inputs are constant.
Comes in: a Setting and elements. Goes out: explicit parts, and whether inputs are named.
Read next: `coadjoint.prove.identities`.
"""

from __future__ import annotations

from collections.abc import Iterable

from coadjoint.derive.setting import Setting
from coadjoint.errors import DerivationError
from coadjoint.exact import Element


def explicit(setting: Setting, element: Element) -> Element:
    """``df/dt`` at fixed state and fixed inputs, but those whose rates are known."""
    field, rates = setting.field, setting.own_rates
    slopes = zip(field.gradient(element, list(rates)), rates.values(), strict=True)
    return field.sum(slope * rate for slope, rate in slopes if slope != 0)


def explicit_rate(setting: Setting, element: Element, what: str) -> Element:
    """The same, of what may not change with the inputs, since nobody knows their rates.

    Args:
        setting: The spec and its field.
        element: What is differentiated in a derivation.
        what: What it is, for the message.

    Raises:
        DerivationError: It depends on an input.
    """
    for name in _free(setting):
        if not setting.field.is_zero(setting.field.derivative(element, name)):
            path = str(setting.spec.path)
            raise DerivationError(
                f"{path}: {what} depends on the input {name}, so the motion needs the rate of "
                f"{name}; expected inputs that act without their rates, or whose rate is an input. "
                'Declare that input and name it, as rate = "..." of this one; or write a function '
                "of time or a parameter in its place.",
                path=path,
                found=name,
            )
    return explicit(setting, element)


def names_inputs(setting: Setting, elements: Iterable[Element]) -> bool:
    """Whether some element changes with an input, at fixed state."""
    field = setting.field
    return any(
        not field.is_zero(field.derivative(element, name))
        for element in elements
        for name in _free(setting)
    )


def list_time_reversed(setting: Setting) -> list[str]:
    """What changes its sign where a motion runs backwards: time, and rates of inputs.

    The rate of a rate keeps its value.
    """
    inputs = {each.name: each for each in setting.spec.inputs}
    turned = list(setting.time)
    for name in sorted(inputs.keys() - {each.rate for each in inputs.values()}):
        chain = [name]
        while inputs[chain[-1]].rate:
            chain.append(inputs[chain[-1]].rate)
        turned += [component for rate in chain[1::2] for component in inputs[rate].components]
    return turned


def _free(setting: Setting) -> list[str]:
    """Inputs whose rates are not known, by component."""
    return [name for name in setting.inputs if name not in setting.own_rates]
