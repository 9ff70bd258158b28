r"""Peakons on a circle: peaks that move are weak solutions of Camassa and Holm's equation.

Peaks of momenta :math:`p_i` at places :math:`q_0 < \dots < q_{N-1} < q_0 + L` have the velocity

.. math:: u(s) = \sum_i p_i G(s - q_i), \qquad
    G(x) = \frac{\cosh((x - L/2)/\alpha)}{2 \alpha \sinh(L/2\alpha)}, \quad 0 \le x \le L.

With :math:`A = 1 - \alpha^2 \partial_s^2` the weak form is, for all smooth functions :math:`\psi`
on the circle,

.. math:: \frac{d}{dt} \oint u\, A\psi\, ds
    = \oint \tfrac12 u^2 A\psi_s + (u^2 + \tfrac12 \alpha^2 u_s^2)\, \psi_s\, ds.

Every smooth function is some :math:`A\psi`, so that nothing is lost. Where :math:`\alpha^2 u_{ss} =
u` between peaks, where u is continuous and :math:`[u_s] = -p_i/\alpha^2` at each of them, integrals
by parts over the gaps give :math:`\oint u A\psi = \sum p_i \psi(q_i)` on the left, and on the right
:math:`\psi''(q_i)` drops out and the integrand left, :math:`\tfrac12 (u^2 - \alpha^2 u_s^2)`, is
constant in each gap. What stays are the factors of :math:`\psi(q_i)` and :math:`\psi'(q_i)`,

.. math:: \dot p_i = \tfrac12 \alpha^2 [u_s^2]_i, \qquad
    p_i \dot q_i = -\alpha^2 u(q_i)\, [u_s]_i .

All of these are identities of a field with cosh and sinh. Both sides of the last two are sums over
pairs of peaks, so that they hold for every N if they do for two peaks and for three.
Comes in: rates of places and momenta. Goes out: what has to vanish. Read next:
`coadjoint.theory.jets`.

Source:
    Camassa and Holm, Phys. Rev. Lett. 71 (1993) 1661, on the line; steps for the circle as above.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

from coadjoint.derive import Equations
from coadjoint.exact import Element, Field
from coadjoint.theory.jets import JetField

#: The place at which a velocity is looked at.
PLACE = "_s"


@dataclass(frozen=True)
class Peaks:
    """Peaks in order around a circle.

    Attributes:
        field: With symbols for all, and room for cosh and sinh.
        places: Symbols of the places, in order.
        momenta: Symbols of the momenta.
        length: The symbol of the length of the circle.
        decay: The symbol of the length alpha over which a peak decays.
    """

    field: Field
    places: tuple[str, ...]
    momenta: tuple[str, ...]
    length: str
    decay: str

    def velocity(self, gap: int) -> Element:
        """The velocity at `PLACE` behind the peak of a number, and before the next one."""
        field = self.field
        L, alpha = field[self.length], field[self.decay]
        weight = 2 * alpha * field.call("sinh", L / (2 * alpha))
        terms = list[Element]()
        for i, (q, p) in enumerate(zip(self.places, self.momenta, strict=True)):
            x = field[PLACE] - field[q] + (L if i > gap else 0)
            terms.append(field[p] * field.call("cosh", (x - L / 2) / alpha) / weight)
        return field.sum(terms)

    def sides(self, peak: int) -> tuple[tuple[Element, Element], tuple[Element, Element]]:
        """Velocity and slope at a peak, from the gap before it and from that behind it."""
        before, after = self._limit(peak, peak - 1), self._limit(peak, peak)
        return before, after

    def _limit(self, peak: int, gap: int) -> tuple[Element, Element]:
        """Velocity and slope at a peak, of a gap; the gap before the first peak is the last one."""
        field, place = self.field, self.field[self.places[peak]]
        if gap < 0:
            gap, place = len(self.places) - 1, place + field[self.length]
        u = self.velocity(gap)
        both = (u, field.derivative(u, PLACE))
        u, slope = (field.substitute(each, {PLACE: place}) for each in both)
        return u, slope


def peaks_of(equations: Equations) -> Peaks:
    """The peaks of a system with coordinates, conjugate momenta and parameters alpha and L.

    Args:
        equations: Of peaks that are written out.
    """
    state, count = equations.setting.state, len(equations.setting.state) // 2
    slots = 2 * (count + 1) ** 2  # cosh and sinh of differences of places, on both sides of each
    field = Field([PLACE, *state, "alpha", "L"], slots, ["alpha", "L"])
    return Peaks(
        field=field,
        places=tuple(state[:count]),
        momenta=tuple(state[count:]),
        length="L",
        decay="alpha",
    )


def read_in_order(peaks: Peaks, equations: Equations, element: Element) -> Element:
    """An element of a system where the peaks are in order: distances are differences of places."""
    field, own = peaks.field, equations.setting.field
    distances = [field[b] - field[a] for a, b in combinations(peaks.places, 2)]

    def call(function: str, *arguments: Element) -> Element:
        found = [x for x in distances if function == "sqrt" and x * x == arguments[0]]
        return found[0] if found else field.call(function, *arguments)

    values = {name: field[name] for name in own.reach(element)}
    return own.evaluate(element, values, field.number, call)


def weak_defects(peaks: Peaks, rates: Mapping[str, Element]) -> Iterator[tuple[str, Element]]:
    """What vanishes if peaks that move solve the weak form.

    Args:
        peaks: In order.
        rates: Of places and momenta, by name.

    Yields:
        What is stated, and a difference that is zero if it is so.
    """
    field, square = peaks.field, peaks.field[peaks.decay] ** 2
    for gap, name in enumerate(peaks.places):
        u = peaks.velocity(gap)
        bent = field.derivative(field.derivative(u, PLACE), PLACE)
        yield f"alpha^2 u_ss = u behind {name}", square * bent - u
    for i, (q, p) in enumerate(zip(peaks.places, peaks.momenta, strict=True)):
        (u, slope), (other, behind) = peaks.sides(i)
        yield f"u is continuous at {q}", other - u
        yield f"alpha^2 [u_s] = -{p} at {q}", square * (behind - slope) + field[p]
        carried = field[p] * rates[q] + square * u * (behind - slope)
        yield f"{p} d{q}/dt = -alpha^2 u [u_s] at {q}", carried
        pushed = rates[p] - square * (behind**2 - slope**2) / 2
        yield f"d{p}/dt = alpha^2 [u_s^2]/2 at {q}", pushed


def energy_defect(peaks: Peaks, energy: Element) -> Element:
    """The energy of a system minus that of the field, which is half the integral of u m."""
    field = peaks.field
    parts = (field[p] * peaks.sides(i)[0][0] for i, p in enumerate(peaks.momenta))
    return energy - field.sum(parts) / 2


def momentum_map_defect(names: Sequence[str] = ("v", "w")) -> Element:
    r"""``{J^v, J^w} - J^(w v_s - v w_s)`` of one peak, for all vector fields v and w.

    :math:`J^v = \sum_i p_i v(q_i)` is the integral of v m for :math:`m = \sum p_i \delta(s - q_i)`.
    The brackets of different peaks vanish, so that places and momenta go to m by a Poisson map.
    """
    v, w = names
    field = JetField(["q"], [v, w], order=1, parameters=["p"])
    J, K = field["p"] * field[v], field["p"] * field[w]
    bracket = field.derivative(J, "q") * field.derivative(K, "p")
    bracket -= field.derivative(J, "p") * field.derivative(K, "q")
    other = field[w] * field.derivative(field[v], "q") - field[v] * field.derivative(field[w], "q")
    return bracket - field["p"] * other
