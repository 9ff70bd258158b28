"""Single changes of the engine beside derivations that must not survive: a sign, an index, a check.

Derivations have lists of their own: `tests.mutation.routes`. The tests that judge a module stand in
`tests.mutation.test_mutants`, unless a line names its own.
"""

from __future__ import annotations

from dataclasses import replace

from tests.mutation.mutant import Mutant, module


def of(name: str, *lines: str, tests: tuple[str, ...] = ()) -> tuple[Mutant, ...]:
    """Changes of one module below ``src/coadjoint``, or of one template."""
    file = f"templates/{name}" if name.endswith(".j2") else module(name)
    return tuple(Mutant(file, line, tests=tests) for line in lines)


#: Structure constants, ad* and the choice of minus or plus: tried in every run.
SIGNS = (
    *of(
        "algebra/families",
        "hat: rewrite {_1: 1, _2: -1} -> {_1: -1, _2: 1}",
        "_rotations: rewrite {_1: 1, _2: -1} -> {_1: -1, _2: 1}",
        "se: rewrite {_1: -1, _2: 1} -> {_1: 1, _2: -1}",
        "galilei: rewrite unit(3, 4) -> unit(3, 4, -1)",
    ),
    *of("algebra/matrices", "commutator: turn a b"),
    *of("lie_algebra", "from_brackets: flip 1", "ad_star: rewrite xi[i] -> -xi[i]"),
    *of("algebra/invariants", "structure: flip c"),
    *of(
        "poisson/brackets",
        "lie_poisson: rewrite mu[k] if _1 else opposite[k] if _2 else _3"
        " -> opposite[k] if _1 else mu[k] if _2 else _3",
    ),
)
#: Checks that compare less than they say, or nothing, and lowering that multiplies everything
#: out: tried in every run, by the few tests that see them.
CHECKS = (
    *of(
        "equivalence",
        "rate_defects: rewrite zip(_1.rates, _2.rates, strict=True) -> zip(_1.rates[:1], _2.rates)",
        tests=("tests/prove/test_equivalence.py -k velocities",),
    ),
    *of(
        "prove/constrained",
        "same_solves: skip rate_name",
        tests=("tests/prove/test_equivalence.py -k solves",),
    ),
    *of(
        "check",
        "_find_differing_elements: never is_zero",
        "_find_differing_elements: rewrite enumerate(_1) -> list(enumerate(_1))[:1]",
        tests=("tests/lower/test_lowering.py -k one_changed_node",),
    ),
    *of(
        "check",
        "_find_differing_residues: never a",
        tests=("tests/derive/test_projection.py -k undone",),
    ),
    *of(
        "lower/definitions",
        "shorten: then element",
        tests=("tests/lower/test_lowering.py -k 'careful_hand and landau_lifshitz_gilbert'",),
    ),
    *of(
        "measures",
        "_refusal: rewrite _is_certain(_1, _2, _3, conditions, _4) -> conditions",
        tests=("tests/prove/test_measures.py -k larger_rank",),
    ),
    *of(
        "regenerate",
        "check: never differences",
        tests=("tests/test_regenerate.py -k check_says_what_to_do",),
    ),
)
MUTANTS = (
    *of(
        "lower/jets",
        "_with_partner: rewrite Call(own.partner, _1) -> Call(value.function, _1)",
        "_times: rewrite Multiply(factor, node) -> node",
        tests=("tests/lower/test_jets.py",),
    ),
    *of(
        "lower/polynomials",
        "sum_of: rewrite Negate(term) if _1 else term -> term",
        "multiply: rewrite x * y -> x",
        tests=("tests/lower/test_jets.py", "tests/lower/test_motion.py"),
    ),
    *of(
        "render/recurrences",
        "_recurrence: rewrite Negate(whole) if _1 else whole -> whole",
        "_divisor: rewrite Number(Fraction(2)) -> Number(Fraction(1))",
        tests=("tests/lower/test_jets.py",),
    ),
    *of(
        "solve/runge_kutta",
        "RungeKutta4.try_step: rewrite h * 0.5 -> h",
        tests=("tests/crosscheck/test_solvers.py -k steps_of_numpy",),
    ),
    *of(
        "methods/midpoint",
        "Midpoint.sweep: rewrite 0.5 * rise -> rise",
        "Midpoint.sweep: rewrite arc.low + _1 -> _1 - arc.low",
        tests=("tests/solve/test_structured.py -k 'bits or quadratic'",),
    ),
    *of(
        "solve/steps",
        "Taylor._choose: rewrite 0.7 / _1 -> 0.9 / _1",
        "_evaluate_path: rewrite total * after + _1 -> total + _1",
        tests=("tests/crosscheck/test_solvers.py -k steps_of_numpy",),
    ),
    *of(
        "solve/runge_kutta",
        "_multiply_out: rewrite path[order] / h -> path[order] * h",
        tests=("tests/solve/test_ensemble.py -k the_path",),
    ),
    *(replace(mutant, always=True) for mutant in (*CHECKS, *SIGNS)),
    *of("identities", "drift: flip equations", tests=("tests/prove/test_driven.py",)),
    *of("prove/constrained", "_differentiate: drop own", tests=("tests/prove/test_driven.py",)),
    *of(
        "driven",
        "own_change: flip lagrangian",
        "while_constant: deny needed",
        tests=("tests/prove/test_driven.py",),
    ),
    *of(
        "prove/symmetries",
        "_commutators: flip explicit",
        "_move_state: flip name",
        tests=("tests/prove/test_driven.py",),
    ),
    *of(
        "prove/almost_poisson",
        "forces: flip explicit",
        tests=("tests/prove/test_driven.py",),
    ),
    *of(
        "prove/almost_poisson",
        "forces: flip x in moved",
        "gradient_defects: flip drift",
        tests=("tests/prove/test_almost_poisson.py",),
    ),
    *of(
        "prove/carried",
        "_carry_added: flip explicit",
        "_carry_tensor: flip value",
        tests=("tests/prove/test_kept_brackets.py",),
    ),
    *of(
        "derive/mechanics/relaxed",
        "_without_positions: flip dot",
        "_pull: flip x",
        tests=("tests/prove/test_relaxed_velocities.py",),
    ),
    *of(
        "bound_symmetries",
        "_shift: flip tau",
        tests=("tests/prove/test_motion_symmetries.py",),
    ),
    *of(
        "prove/reached",
        "_commute: flip along_Y",
        tests=("tests/prove/test_kept_brackets.py",),
    ),
    *of(
        "numpy/kernel.py.j2",
        "driving: use 2 for 1 in given ndim reshape",
        tests=("tests/crosscheck/test_driven.py",),
    ),
    *of(
        "c/kernel.c.j2",
        "state_inputs: use 0 for _n in _row _member",
        "driving: use < for != in _member _stride",
        tests=("tests/crosscheck/test_driven.py",),
    ),
    *of(
        "algebra/families",
        "hat: flip 1 in return",
        "_columns: rewrite unit(i, column) -> unit(i, column, -1)",
        "hat: reverse axis",
        "so_indefinite: flip 1",
        "bargmann: rewrite {_1: 1, _2: 1} -> {_1: 1, _2: -1}",
        "sp.generators: flip 1",
        "su: rewrite {(0, 1): -half, (1, 0): half} -> {(0, 1): half, (1, 0): -half}",
        "coquaternions: rewrite {(0, 1): -1, (1, 0): 1} -> {(0, 1): 1, (1, 0): -1}",
    ),
    *of(
        "algebra/harmonics",
        "spin_matrices: rewrite n - j -> n",
        "_generators: rewrite commutator(up, U) -> commutator(U, up)",
        "_generators: rewrite (-1, U) -> (1, U)",
        tests=("tests/algebra/test_harmonics.py",),
    ),
    *of(
        "solve/strands",
        "_magnus: rewrite last - first -> first - last",
        "_magnus: rewrite b + two -> b - two",
        "transport: rewrite step @ frames[n] -> frames[n] @ step",
        tests=("tests/solve/test_strands.py -k 'solves or order'",),
    ),
    *of("algebra/matrices", "commutator: flip 1"),
    *of(
        "lie_algebra",
        "jacobi_violation: rewrite -inner * outer -> inner * outer",
        "ad_star: rewrite xi[i] -> xi[j]",
        "bracket: flip multiply_constant",
    ),
    *of(
        "representation",
        "act: flip multiply_constant",
        "diamond: flip multiply_constant",
        "dual: flip v",
        "dual: rewrite {(c, r): -v for _1, v in _2} -> {(r, c): -v for _1, v in _2}",
    ),
    *of(
        "algebra/products",
        "semidirect_product: negate value in setdefault",
        "semidirect_sum: negate value in setdefault",
    ),
    *of(
        "extensions",
        "complexification: flip c",
        "_form: then value",
        "leibniz_extension: negate c in row",
    ),
    *of("element", "diff: flip exponent in append", "__neg__: flip numer"),
    *of(
        "field",
        "_differentiate: rewrite each * slope -> each",
        "square_of: rewrite cast(Element, _1) -> -cast(Element, _1)",
    ),
    *of(
        "exact/dense",
        "_expand: omit 1 j",
        "_adjugate: omit 1 i j",
        "subtract: use add for sub",
        "hat: flip a3",
        "cross: rewrite a3 * b1 - a1 * b3 -> a1 * b3 - a3 * b1",
    ),
    *of(
        "group",
        "Ad: mirror inverse",
        "Ad_star: unwrap transpose",
        "ad_star: exchange ad_star",
    ),
    *of(
        "actions",
        "coadjoint_motion_defect: unwrap inverse in inverse",
        "right_invariant_field: use right_translation for left_translation",
    ),
    *of(
        "maps",
        "pairing_su2: flip HALF",
        "breve: rewrite mu[k][j] - mu[j][k] -> mu[j][k] - mu[k][j]",
    ),
    *of(
        "quaternions",
        "__mul__: rewrite _1 - s * (c * z - d * y) -> _1 + s * (c * z - d * y)",
        "norm: flip planes",
    ),
    *of("rotations", "ad_star: rewrite mu * xi - xi * mu -> xi * mu - mu * xi"),
    *of("hopf", "reduced_motion: flip 4"),
    *of("theory/charts", "north_point: rewrite zeta.norm - 1 -> 1 - zeta.norm"),
    *of(
        "theory/vector_fields",
        "vorticity_rate: flip lie_derivative",
        "hamiltonian_vector_field: rewrite scale(-1, _1) -> _1",
    ),
    *of("central_forces", "monopole_force: flip lam in magnetic"),
    *of("complex_numbers", "realify: flip im in tuple"),
    *of(
        "poisson/brackets",
        "nambu_tensor: rewrite (-1) ** (i + j) -> (-1) ** (i + j + 1)",
        "magnetic: negate scale a",
        "magnetic: negate value in entries",
    ),
    *of("poisson/structure", "antisymmetric: reverse opposite", "_affine: flip field"),
    *of("jacobi", "schouten_bracket: else middle"),
    *of("polynomial_bracket", "is_casimir: omit factor", "along: omit power"),
    Mutant(
        "src/coadjoint/poisson/polynomial_bracket.py",
        "is_casimir: rewrite _1 + factor * value -> _1 - 2 * factor * value",
        equivalent="the sum is only compared with zero, and every term of it has the same factor",
    ),
    *of("theory/nambu", "rigid_body_pendulum: flip i3 in cylinder"),
    *of(
        "identities",
        "antisymmetry_defects: rewrite _1 + tensor[j][i] -> _1 - tensor[j][i]",
        "hamiltonian_defects: flip in_velocities",
    ),
    *of("agreement", "_same_rates: flip other"),
    *of(
        "prove/brackets",
        "about_casimirs: rewrite decide().verdict is Verdict.PROVED -> decide()",
    ),
    *of(
        "equivalence",
        "rate_defects: flip second",
        "velocity_defects: flip field",
        "energy_defects: rewrite _1 - energy -> _1 + energy",
    ),
    *of(
        "casimirs",
        "select_independent: rewrite independent_rows(_1, slopes) -> range(len(slopes))",
        "search_summands: rewrite len(given) >= expected -> given",
    ),
    *of("summands", "summands: leave reached", "restrict_algebra: then a"),
    *of(
        "measures",
        "_is_certain: rewrite rank == len(_1) - _2 -> rank == len(_1) - _2 or conditions",
    ),
    *of("densities", "powers_along: flip divergence"),
    *of("invariant_factors", "is_invariant: rewrite rate != 0 and _1 -> rate == 0 or _1"),
    *of("reversibility", "about_reversal: rewrite name and _1 -> not name"),
    *of("prove/almost_poisson", "_defects_at: always plain in defects"),
    *of(
        "completeness",
        "completeness: rewrite structure.dimension - _1 -> structure.dimension + 0 * _1",
    ),
    *of(
        "prove/charts",
        "_closed_defects: rewrite own - _1 -> own - own",
        "_definition_defects: rewrite whole - _1 -> whole - whole",
        "decide_kept: rewrite self.other.close(_1) -> self.field.zero",
        "rank: drop 0",
        "image_relations: compare-GtE _rank_on_domain",
        "reach: rewrite len(relations) == missing and _1 -> bool(relations) and _1",
    ),
    *of(
        "ranks",
        "largest_pivot: always sign",
        "_sample: rewrite islice(primes(), TRIES) -> [2**61 - 1] * TRIES",
    ),
    *of(
        "prove/functions",
        "Experiment.__init__: then _turn",
        "_add_turns: then _inverse",
        "_root: skip _functions",
    ),
    *of("samples", "obstacle: always proper"),
    *of(
        "candidates",
        "polynomials: rewrite not unproved -> True",
        "_count: rewrite bounded and _1 -> _1",
    ),
    *of(
        "polynomial_families",
        "count_relations: rewrite moved.keys() <= place.keys() -> moved.keys() & place.keys()",
    ),
    *of(
        "ideals",
        "remainder: bare _basis",
        "_solve: flip slope",
        "_split_branches: rewrite self.field.normal(self._on(_1, _2)) -> self.field.normal(_2)",
    ),
    *of("prove/points", "_step: flip by", tests=("tests/prove/test_points.py",)),
    *of(
        "zero",
        "_decide_on_branches: rewrite not rest.contains(value) -> rest.contains(value)",
        "_decide_on_branches: rewrite [_1(each, branch.solved) for each in _2] -> [*_2]",
        "_near_value: compare-GtE ON_BRANCH",
        "_look: rewrite not min(counts) -> min(counts)",
    ),
    *of(
        "prove/symmetries",
        "_noether: compare-NotEq rate",
        "_commutators: use X for motion in X",
        "_claimed_bracket: swap structure",
        "_motion_defects: flip 1",
    ),
    *of(
        "prove/lax",
        "lax_decision: rewrite settled(left - _1) -> settled(left - left)",
        "_complete: rewrite own == together == _1 -> own == _1",
        "_decide_conserved: rewrite same.value - value -> value - value",
        "_bracket: rewrite x * tensor[i][j] * y -> x * tensor[i][i] * y",
    ),
    *of(
        "bound_symmetries",
        "lift: flip explicit",
        "motion_defects: flip explicit",
        "ConstrainedAction.law: flip energy",
        "_rate: flip explicit",
        "ConstrainedAction.constraint_defects: flip X",
        "ConstrainedAction.constraint_defects: flip late",
        "lift: flip v",
        "ConstrainedAction.law: flip power",
        "_changes: flip in_state",
        tests=("tests/prove/test_bound_symmetries.py",),
    ),
    *of(
        "derive/reductions",
        "velocities: rewrite self(value) -> -self(value)",
        tests=("tests/prove/test_reductions.py -k rayleigh",),
    ),
    *of(
        "mechanics/parts",
        "whole: rewrite outer * slope -> slope",
        "whole: rewrite outer * slope -> outer",
        "_is_part: rewrite not definition.arguments and not _1 -> not definition.arguments",
        tests=("tests/derive/test_friction.py",),
    ),
    *of(
        "mechanics/solver",
        "_row: rewrite self._rest(j, i) -> self._rest(i, j)",
        "_rest: rewrite self._w[i, k] * self._u[k, j] -> self._w[i, k] * self._u[k, i]",
        "_eliminate: rewrite value * share -> value",
        tests=("tests/derive/test_friction.py", "tests/derive/test_solver.py"),
    ),
    *of(
        "momentum_maps",
        "action_defects: flip moved",
        "bracket_defects: rewrite _1 - moved[a][b] -> _1 + moved[a][b]",
        "field_defects: flip b",
        "cocycle: flip _along",
        "_in_algebra: then sign",
        "sigma: then value",
        "lift: flip weight in components",
        "generating_function: drop _degree",
    ),
    *of(
        "spec/core/definitions",
        "place: rewrite argument[1] + isinstance(part, Index) -> 1",
        "_component: rewrite replace(_1, name=_2) -> whole",
        "_expand_call: rewrite len(given) != len(definition.arguments) -> not given",
        "_check_arguments: rewrite arguments[:place] -> []",
        "define: rewrite expand(_1, known, _2) -> expand(_1, {}, _2)",
    ),
    *of(
        "derive/symmetries",
        "momentum_map: let resting = values[len(generators)]",
        tests=("tests/prove/test_symmetries.py -k moving_time",),
    ),
    *of(
        "derive/symmetries",
        "momentum_map: flip equations",
        tests=("tests/prove/test_symmetries.py -k by_the_place",),
    ),
    *of(
        "decided",
        "value: let closed = self.field.zero",
        tests=("tests/derive/test_decided.py",),
    ),
    *of("lower/sums", "_signed_coefficient: flip 1", "_apply_sign: compare-Lt sign"),
    *of(
        "graph",
        "multiply: rewrite self.negate(self.multiply(a, _1)) -> self.multiply(a, _1)",
        "_slope: rewrite _1(_2, self.multiply(a, db)) -> _1(_2, self.negate(self.multiply(a, db)))",
        "_slope: unwrap negate in divide",
        "_call_slope: rewrite map(self.multiply, outer, inner) -> inner",
    ),
    *of("lower/program", "evaluate: flip evaluate"),
    *of(
        "printers",
        "_link: rewrite ('-', operand) -> ('+', operand)",
        "text: drop -",
        "_link: rewrite ('/', node.right) -> ('*', node.right)",
    ),
    *of(
        "c/kernel.c.j2",
        "state_inputs: flip _n in state_stride",
        "member_statements: use function.outputs[-loop.index][0] for row in c_assignment row",
        "functions: flip _n in parameter_inputs parameters_stride",
        'of_member: use name ~ " = -" for name in c_assignment',
    ),
    *of(
        "numpy/kernel.py.j2",
        "outputs: use function.outputs[-loop.index][0] for row in numpy_assignment",
        "of_member: use name ~ ' = -' for name in numpy_assignment",
    ),
    *of(
        "prove/reductions",
        "_decide_kept: rewrite decide_zero(drifts, _1, _2) -> decide_zero([], _1, _2)",
    ),
    *of(
        "derive/reductions",
        "section_defects: flip name",
        tests=("tests/prove/test_reductions.py",),
    ),
    *of(
        "identities",
        "drift: flip followed",
        "followed_rate: let return = field.zero",
        tests=("tests/prove/test_followed_integrals.py -k space",),
    ),
    *of(
        "derive/structure",
        "_add_pairs: rewrite field.number(-weight) -> field.number(weight)",
        "_add_pairs: rewrite known.get((a, b), field.zero) -> field.zero",
        tests=("tests/derive/test_products.py",),
    ),
    *of(
        "routes/poisson",
        "_define_of_product: rewrite weights[p] -> -weights[p]",
        "_velocities_of_product: let return = []",
        tests=("tests/derive/test_products.py",),
    ),
    *of(
        "shared_frames",
        "name_frames: let definitions = equations.exact.definitions",
        "_rewrite_quotient: let return = total",
        "_element: rewrite field[name] ** e -> field[name]",
        "rewrite: rewrite whole if shorter else element -> element",
        tests=("tests/lower/test_shared_frames.py",),
    ),
    *of(
        "section_brackets",
        "along: flip own",
        "induced_bracket: rewrite {a: -value for a, value in of_state[x].items()} -> of_state[x]",
        "induced_bracket: rewrite of_state[x][a] * w -> of_state[x][a] - of_state[x][a]",
        "induced_bracket: rewrite of_state[x][a] * u -> of_state[x][a] - of_state[x][a]",
        tests=("tests/prove/test_section_brackets.py",),
    ),
    *of(
        "packed",
        "_add: rewrite (prime - entry) * other -> entry * other",
        "nullspace: rewrite prime - share -> share",
    ),
    *of("rationals", "_replace_in: rewrite values[n] ** e -> values[n]"),
    *of("linear", "nullspace_modulo: use equations[1:] for equations in SpanModulo"),
    *of("ansatz", "solve_with_right_side: deny last"),
    *of(
        "python/kernel_python.py.j2",
        "outputs: use function.outputs[-loop.index][0] for row in plain_assignment row",
        "functions: use 1 for 0 in range",
    ),
    *of(
        "solve/methods/lie_poisson",
        "keep_offset: rewrite first - kept[1] -> first",
        "continue_offset: rewrite first + second -> first",
        tests=("tests/solve/test_clock.py -k 'differences or last_ones'",),
    ),
    *of(
        "algebra/planes",
        "_commute: rewrite ahead - back -> ahead + back",
        tests=("tests/algebra/test_planes.py",),
    ),
    *of(
        "solve/methods/coadjoint_mean",
        "_find_rest: rewrite length * 0.5 -> length",
        "_follow: rewrite turn + _1 -> turn",
        "sweep: rewrite 2.0 * parts -> parts",
        tests=("tests/solve/methods/test_lie_poisson.py",),
    ),
    *of(
        "solve/methods/spherical_midpoint",
        "is_root: rewrite self.scale > 0.0 -> self.scale < 9.0",
        "apply: rewrite 1.5 - part * both -> 1.25 - part * both",
        tests=("tests/solve/methods/test_lie_poisson.py",),
    ),
    *of(
        "solve/methods/average_gradient",
        "find_excess: rewrite 2.0 * at_middle -> at_middle",
        "move: rewrite rates + turn -> rates - turn",
        tests=("tests/solve/methods/test_gradients.py",),
    ),
    *of(
        "solve/methods/discrete_gradient",
        "sweep: rewrite last - first -> first - last",
        "sweep: rewrite kept.factor * chord -> chord",
        tests=("tests/solve/methods/test_gradients.py",),
    ),
    *of(
        "derive/times_vector",
        "_apply: rewrite x * v -> -x * v",
        "divide: rewrite first + place -> place",
        tests=("tests/derive/test_times_vector.py",),
    ),
    *of(
        "derive/sandwich",
        "_emit: rewrite a + field['_bwz'] * b -> a",
        "_find_products: rewrite sign * each -> each",
        tests=("tests/derive/test_sandwich.py",),
    ),
    *of(
        "solve/methods/isospectral_midpoint",
        "sweep: rewrite half * xi -> xi",
        tests=("tests/solve/methods/test_lie_poisson.py",),
    ),
    *of(
        "lower/orbits",
        "_is_sphere: rewrite (b, a, -scale) -> (b, a, scale)",
        "is_product.find: rewrite a + -b -> a + -a",
        tests=("tests/lower/test_orbits.py",),
    ),
)
