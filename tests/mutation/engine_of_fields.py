"""Single changes of what derives fields and proves claims about them, each with its judges.

Derivations by routes have lists of their own: `tests.mutation.routes_over_fields`.
Read next: `tests.mutation.engine`.
"""

from __future__ import annotations

from tests.mutation.mutant import changes_of

GRID = "tests/derive/test_grid.py"
FIELDS_OF = "tests/derive/test_fields.py"
ENDS = "tests/derive/test_ends.py"
CLAIMS = "tests/prove/test_fields.py"
PLANE = "tests/prove/test_torus.py"
STRANDS = "tests/prove/test_strands.py"

DERIVED = (
    *changes_of(
        "fields/stencils",
        "width_of: rewrite (derivative + 1) // 2 -> derivative // 2",
        "width_of: rewrite _1 // 2 + order // 2 - 1 -> _1 // 2 + order // 2",
        "stencil: rewrite Fraction(factorial(derivative)) -> Fraction(derivative)",
        "stencil: rewrite Fraction(r) ** n -> Fraction(-r) ** n",
        "find_largest: reverse cos",
        "find_largest: unwrap sum",
        "find_largest: rewrite pi * n / ANGLES -> pi * n / ANGLES / 2",
        tests=(f"{GRID} -k stencil",),
    ),
    *changes_of(
        "fields/lattice",
        "Calculus.differentiate: rewrite -1 if derivative % 2 else 1 -> 1",
        "differentiate.at: rewrite 0 in known -> False",
        "Calculus.differentiate: rewrite self.inverse ** derivative -> self.inverse",
        "compose.row: rewrite _multiply(right, slope) -> slope",
        "compose.row: rewrite left(i) * moved(i) -> moved(i)",
        "Calculus.vary: rewrite k % 2 == 0 -> True",
        "LatticeField.shift: flip places",
        "LatticeField.vary: rewrite -r -> r",
        "LatticeField.still: let same = {}",
        tests=(f"{GRID} {CLAIMS} -k '(exact_waves and 2) or differences or rings or grows'",),
    ),
    *changes_of(
        "fields/jets",
        "Jets.still: rewrite i or j -> i",
        "Jets.still: rewrite i or j -> j",
        tests=(f"{FIELDS_OF} -k degree_zero",),
    ),
    *changes_of(
        "fields/sums",
        "explain_change: rewrite lattice.still(rate) -> lattice.field.zero",
        "explain_change: rewrite lattice.vary(rate).values() -> ()",
        "explain_change: rewrite '' if is_kept else _1 -> ''",
        tests=(f"{CLAIMS} -k 'equal_fields or examined'",),
    ),
    *changes_of(
        "fields/symbol",
        "look_at_symbol: rewrite order % 2 == 1 -> True",
        "look_at_symbol: rewrite order % 2 == 1 -> False",
        "look_at_symbol: rewrite x.imag if order % 2 else x.real -> x.real",
        "look_at_symbol: rewrite x.imag if order % 2 else x.real -> x.imag",
        "look_at_symbol: rewrite _count_bad(_1, odd=_2) -> 0",
        "find_matrix: rewrite tower[order] -> tower[order - 1]",
        "told: rewrite self.order != 1 -> False",
        "_count_bad: omit I",
        "_count_real: omit power",
        "_is_diagonalizable: rewrite _1.sqf_part() -> _1",
        "_split: rewrite value.as_real_imag() -> (value.as_real_imag()[0], sympy.S(0))",
        tests=(f"{FIELDS_OF} -k 'posed or magnet or jordan or heat'",),
    ),
    *changes_of(
        "fields/symbol",
        "_look_at_all_orders: rewrite range(order + 1) -> range(order, order + 1)",
        "_look_at_all_orders: rewrite tower[n] -> tower[order]",
        "_look_at_all_orders: rewrite power >= 1 -> True",
        "_find_growth: rewrite mpmath.mpc(0, k) -> mpmath.mpc(k, 0)",
        tests=(f"{FIELDS_OF} {CLAIMS} -k 'orders_that_differ or with_a_block or symbol'",),
    ),
    *changes_of(
        "prove/fields",
        "_about_posedness: rewrite not seen.is_diagonalizable -> False",
        tests=(f"{CLAIMS} -k of_a_symbol_with_a_block",),
    ),
    *changes_of(
        "fields/operators",
        "Term.adjoint: drop across",
        "Term.adjoint: rewrite Term(self.right * sign, _1, self.left, _2)"
        " -> Term(self.left * sign, _1, self.right, _2)",
        "apply: omit right in differentiate",
        "adjoint: rewrite row[i] -> operator[i][0]",
        "expand: rewrite comb(term.order, i) -> 1",
        "expand: rewrite comb(term.across, j) -> 1",
        "skew_defects: let return = {}",
        "order_of: drop across",
        tests=(f"{FIELDS_OF} {CLAIMS} {PLANE} -k 'operators or of_one_derivative'",),
    ),
    *changes_of(
        "fields/hamiltonian",
        "field_equations: rewrite circle.vary(setting, h, name)"
        " -> setting.field.derivative(h, name)",
        "density: rewrite close(setting, _1) -> _1",
        "density: rewrite legendre(setting).energy -> setting.lagrangian",
        "_entries: omit right",
        "_entries: rewrite enumerate(setting.state[i:], i) -> enumerate(setting.state)",
        "_name_term: rewrite term.right != 1 -> term.right == 1",
        "_name_term: rewrite 'D_y' if term.across else 'D_x' -> 'D_x' if term.across else 'D_y'",
        "_name_term: deny in_plane",
        tests=(
            f"{FIELDS_OF} -k 'vries or landau or compatibility or shown or lagrangians_of_strands'",
        ),
    ),
    *changes_of(
        "fields/rings",
        "Rings.make: omit weigh",
        "Rings.make: omit inverse in totals",
        "Rings._tensor: drop 1 in scale",
        "Rings._tensor: omit weigh",
        "Rings._tensor: rewrite right(j) -> right(i)",
        "Rings._tensor: rewrite left(i) -> left(j)",
        "Rings.matrix_row: flip r",
        "Rings.matrix_row: rewrite self.point.meets[n] -> not self.point.meets[n]",
        tests=(f"{GRID} {ENDS} -k 'rings or (every_claim and 2) or lost'",),
    ),
    *changes_of(
        "fields/profiles",
        "sample_profiles: drop has_ends",
        "evaluate_profile: omit length",
        "evaluate_profile: omit number in values",
        "sample_profiles: rewrite zip(*points, strict=True) -> tuple(points)",
        "_Numbers.number: rewrite mpmath.mpf(value.numerator) / value.denominator -> float(value)",
        "_Numbers.power: rewrite base ** exponent -> base * exponent",
        "check_profiles: rewrite [Fraction(0)] * _1 -> [Fraction(1, 3)] * _1",
        tests=(f"{GRID} -k profile",),
    ),
    *changes_of(
        "fields/emission",
        "velocities: never found",
        "velocities: rewrite field.reach(value) & closed.keys() -> False",
        "emit_fields: never route",
        "_check_posed: deny growth",
        "strand_terms: flip slope",
        "strand_terms: rewrite close(setting, setting.field[xi]) -> setting.field[strain]",
        "strand_terms: rewrite jets.total(close(setting, slope)) -> close(setting, slope)",
        tests=(f"{FIELDS_OF} -k 'posed or refused or book or compatibility or simo'",),
    ),
    *changes_of(
        "fields/emission",
        "_list_observables: rewrite close_jets(setting, x) -> x",
        "read_density: rewrite close_jets(setting, x) -> x",
        "close_jets: rewrite jets.total(value, *_1) -> value",
        tests=("tests/derive/test_field_velocities.py",),
    ),
    *changes_of(
        "routes/lax",
        "equations_of_pair: rewrite close_jets(setting, x) -> x",
        tests=("tests/derive/test_field_velocities.py -k pair",),
    ),
    *changes_of(
        "fields/grid",
        "make_grid: rewrite dict.fromkeys(changes, Kept.UNKNOWN) -> {}",
        "make_grid: skip check_profiles",
        "make_grid: skip check_least",
        "make_grid: rewrite (size, size + 1) -> (size, size)",
        "make_grid: drop 1 in size",
        "_list_sums: rewrite {} if _1 else {each.name: defects} -> {}",
        tests=(
            f"{CLAIMS} {GRID} -k 'differences or no_order or kdv-size or first_point or rings_are'",
        ),
    ),
)

PROVED = (
    *changes_of(
        "prove/fields",
        "decide_skew: rewrite [x for found in _1 for x in found] -> []",
        "decide_jacobi: always is_zero",
        "_Trivector.__init__: rewrite (n + k) % 3 -> k",
        "_Trivector._part: rewrite jets.rate(t.left, along) -> t.left",
        "_Trivector._part: rewrite jets.rate(t.right, along) -> t.right",
        tests=(f"{CLAIMS} -k 'wrong_sign_at or of_one_derivative or factor_two'",),
    ),
    *changes_of(
        "prove/fields",
        "_about_equality: rewrite a - b -> a - a",
        "_about_equality: drop other exact energy",
        tests=(f"{CLAIMS} -k 'compatibility or another_energy'",),
    ),
    *changes_of(
        "prove/fields",
        "_about_casimirs.decide: rewrite jets.euler(_1, _2) -> jets.field.derivative(_1, _2)",
        tests=(f"{CLAIMS} -k casimir",),
    ),
    *changes_of(
        "prove/fields",
        "_decide_between_ends: negate sum",
        "_decide_between_ends: drop flux in decide_zero",
        tests=(f"{ENDS} -k 'every_claim and free-2'",),
    ),
    *changes_of(
        "prove/grids",
        "_compare_rings: rewrite grid.windows -> grid.windows[:0]",
        "_differences: drop own",
        "_differences: let inverse = field.one",
        "_decide_energy: rewrite lattice.shift(back, r) -> back",
        "_decide_energy: flip shift",
        "_decide_by_parts: rewrite list(grid.defects) -> []",
        "_about_sums: never law",
        "_about_fourier_sum: rewrite not all(_1) -> False",
        "_about_jacobi: rewrite pointwise or _1 -> True",
        "_about_jacobi: rewrite field.is_zero(x) -> True",
        tests=(f"{CLAIMS} -k 'grid or rings or differences or no_order or balance or few'",),
    ),
    *changes_of(
        "prove/grids",
        "_differences: flip size in get",
        "_decide_energy_of_lines: rewrite tensor[j][i] -> -tensor[j][i]",
        tests=(f"{ENDS} -k '(every_claim and free-2) or lost'",),
    ),
    *changes_of(
        "prove/torus",
        "find_aliases: rewrite n != m and _1 -> _1",
        "find_aliases: rewrite 2 * K -> K",
        "_cross: rewrite k[0] * q[1] - k[1] * q[0] -> k[0] * q[1] + k[1] * q[0]",
        "find_defect: rewrite max(_1) <= most -> True",
        "find_defect: rewrite max(_1) <= most -> False",
        "_decide_projection: never decision",
        "_decide_aliases: drop 1 in find_aliases",
        "about_torus: always exact",
        tests=(PLANE,),
    ),
    *changes_of(
        "prove/fluxes",
        "decide_density: rewrite [*jets.variation(rate).values()] -> []",
        "decide_density: rewrite jets.integrate(-rate) -> jets.integrate(rate)",
        "_decide_still: rewrite [jets.still(rate)] -> []",
        "_list_bounds: let below = []",
        "_find_rate: rewrite circle.vary(setting, part, name, formula) -> jets.euler(part, name)",
        tests=(f"{CLAIMS} -k 'conserved_is or flux or grows or turns'",),
    ),
    *changes_of(
        "prove/fluxes",
        "decide_law: rewrite decision.verdict is Verdict.PROVED or not turning -> not turning",
        "_integrate_along: rewrite rest / moved * alone -> rest / moved",
        "_integrate_along: rewrite flux + part -> flux",
        "_integrate_highest: rewrite Fraction(1, n + 1) -> Fraction(1, 1)",
        "_integrate_highest: rewrite field[DEGREE] * field[x] -> field[x]",
        tests=(f"{STRANDS} -k '(both_equations and changes0) or kept_everywhere'",),
    ),
)

FIELDS = (*DERIVED, *PROVED)
