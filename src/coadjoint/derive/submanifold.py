"""Submanifold: what [reduction] says of the variables that the state is without, as elements.

Comes in: the Setting of a restricted motion, or of any other. Goes out: values by component.
Read next: `coadjoint.derive.reductions`.
"""

from __future__ import annotations

from collections.abc import Mapping

from coadjoint.derive.setting import Setting, once
from coadjoint.exact import Element


@once
def section_of(setting: Setting) -> Mapping[str, Element]:
    """``s(x)`` by the components of y; empty without [reduction]."""
    if setting.spec.reduction is None:
        return {}
    known = {variable.name: variable for variable in setting.spec.defined}
    return {
        component: value
        for name, formula in setting.spec.reduction.section.items()
        for component, value in zip(
            known[name].components, setting.components(formula), strict=True
        )
    }


def put_on_section(setting: Setting, element: Element) -> Element:
    """An element with s(x) in the place of y; the same without [reduction]."""
    section = section_of(setting)
    return setting.field.substitute(element, section) if section else element
