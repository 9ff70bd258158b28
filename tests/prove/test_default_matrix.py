"""The matrix of defaults: for each kind of system what there is, and why the rest is refused.

Facts alone decide here, of shipped systems; nothing is compiled.
"""

import pytest

from tests.prove.test_methods import default, judge_shipped

#: By kind of system: one of its kind, its default, methods that apply, and methods that do not with
#: a part of the reason.
MATRIX = {
    "momentum on one sphere": (
        "rigid_body",
        "spherical_midpoint",
        ("splitting4", "discrete_gradient", "gauss8", "kahan", "exact_body"),
        {"isospectral_midpoint": "other than so(3)", "nambu_gradient": "by Nambu's bracket"},
    ),
    "momentum on another dual": (
        "sp2_momentum",
        "coadjoint_mean",
        ("coadjoint_mean6", "average_gradient", "gauss8"),
        {"spherical_midpoint": "a product of so(3) and se(3)"},
    ),
    "matrices of so(n)": (
        "so5_body",
        "isospectral_midpoint4",
        ("isospectral_midpoint6", "gauss8", "discrete_gradient"),
        {"spherical_midpoint": "a product of so(3) and se(3)"},
    ),
    "other matrices with products": (
        "galilei",
        "isospectral_midpoint4",
        ("coadjoint_mean6", "average_gradient", "gauss8"),
        {"spherical_midpoint": "a product of so(3) and se(3)"},
    ),
    "symmetric matrices": (
        "bloch_iserles_3",
        "isospectral_midpoint4",
        ("coadjoint_mean", "midpoint", "discrete_gradient"),
        {"splitting": "no single rational frequency"},
    ),
    "body in a quadratic potential": (
        "quadratic_potential_so4",
        "splitting4",
        ("isospectral_midpoint4", "coadjoint_mean", "gauss8"),
        {"spherical_midpoint": "a product of so(3) and se(3)"},
    ),
    "semidirect product": (
        "heavy_top",
        "splitting4",
        ("spherical_midpoint", "midpoint", "discrete_gradient", "gauss8"),
        {"exact_body": "no free motion of three components"},
    ),
    "attitude in the state": (
        "rigid_body_attitude",
        "splitting4",
        ("coadjoint_mean", "gauss8"),
        {"spherical_midpoint": "a product of so(3) and se(3)"},
    ),
    "canonical": (
        "kepler",
        "splitting4",
        ("splitting6", "discrete_gradient", "gauss8"),
        {"coadjoint_mean": "linear in the state"},
    ),
    "Nambu's bracket": (
        "nambu_body",
        "midpoint",
        ("kahan", "nambu_gradient", "gauss8"),
        {},
    ),
    "constraints that are solved": (
        "euler_disk",
        "discrete_gradient",
        ("gauss8",),
        {"splitting": "not Poisson", "coadjoint_mean": "linear in the state"},
    ),
    "constraints that are kept": (
        "knife_edge_cvt",
        "",
        ("gauss8",),
        {"discrete_gradient": "multipliers", "splitting": "Poisson tensor", "kahan": "solves for"},
    ),
    "double bracket": (
        "double_bracket_body",
        "gauss4",  # discrete_gradient where a certificate proves that G is semidefinite
        ("discrete_gradient", "gauss8"),
        {"discrete_gradient4": "go back in time", "coadjoint_mean": "with its energy alone"},
    ),
    "metriplectic": (
        "metriplectic_body",
        "metriplectic_gradient",  # gauss4 where a certificate proves that G is semidefinite
        ("metriplectic_gradient", "gauss8"),
        {"discrete_gradient": "projects G along that", "coadjoint_mean": "with its energy alone"},
    ),
    "noise": (
        "stochastic_rigid_body",
        "spherical_midpoint",
        ("coadjoint_mean", "midpoint", "heun"),
        {"gauss4": "methods of their own", "splitting": "noise", "kahan": "noise"},
    ),
}


@pytest.mark.parametrize("kind", MATRIX)
def test_each_kind_has_its_default_and_reasons(kind):
    """What applies keeps something or says so; what does not gives a reason that fits."""
    system, first, fit, refused = MATRIX[kind]
    _, methods = judge_shipped(system)
    assert default(methods) == first
    assert {name for name in fit if not methods[name].applies} == set()
    for name, reason in refused.items():
        assert not methods[name].applies, name
        assert reason in methods[name].decides, (name, methods[name].decides)
    assert all(each.decides for each in methods.values())
