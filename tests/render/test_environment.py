"""Templates: strict names, no unused keys, no text that could end a comment."""

import re

import pytest
from jinja2 import UndefinedError
from jinja2.exceptions import SecurityError

from coadjoint.declared import Quantity
from coadjoint.errors import SpecError
from coadjoint.methods import STRUCTURED
from coadjoint.render import header
from coadjoint.render.environment import (
    PAGES,
    environment,
    names_read,
    refuse_unsafe,
    render_templates,
)
from coadjoint.render.families import FAMILY_FILES
from coadjoint.render.header import PLAIN
from coadjoint.render.kernels import TEMPLATES
from coadjoint.render.targets import FOLDERS, ON_DEMAND, OTHERS
from coadjoint.resources import derivations_folder, targets_folder, templates_folder


def test_every_kernel_template_is_rendered():
    """No template of a target lies unused, and none that is rendered is missing."""
    folder = templates_folder()
    present = {path.relative_to(folder).as_posix() for path in folder.rglob("*.j2")}
    rendered = {*TEMPLATES.values(), *(template for template, _ in FAMILY_FILES.values())}
    # parts of solver.c.j2; that of the isospectral midpoint tests/solve/methods renders alone
    methods = (*STRUCTURED.values(), *PLAIN.values())
    parts = {header.TEMPLATE} | {f"c/methods/{each.file}.c.j2" for each in methods}
    parts |= {"c/methods/lie_poisson.c.j2", "c/methods/isospectral_midpoint.c.j2"}
    parts |= {
        "c/methods/dop853_tables.c.j2",
        "c/methods/gauss_tables.c.j2",
        "c/normals.c.j2",
        "c/head.j2",
    }
    parts |= {"c/methods/sequence.c.j2", "c/methods/gradients.c.j2", "c/methods/spheres.c.j2"}
    own = ("steps", "gradients", "kinks")  # of family_solver.c.j2
    parts |= {f"c/methods/family_{each}.c.j2" for each in own}
    parts |= {"c/methods/stopping.c.j2", "c/methods/chord.c.j2", "c/methods/arc.c.j2"}
    parts |= {"c/methods/newton.c.j2", "c/methods/krylov.c.j2", "c/methods/bands.c.j2"}
    parts |= {*OTHERS["js"].files.values(), "js/family.js.j2"}  # of `coadjoint.render.scripts`
    assert {name for name in present if not name.startswith(PAGES)} == rendered | parts
    targets = {path.parent.name for path in targets_folder().glob("*/__init__.py")}
    assert targets == {*FOLDERS, *ON_DEMAND}
    assert {path.name for path in folder.iterdir() if path.is_dir()} >= targets


def test_a_key_that_no_template_reads_is_an_error():
    """A value given for nothing is found out at once, and so is one that is missing."""
    names = tuple(TEMPLATES.values())
    values = dict.fromkeys(frozenset().union(*map(names_read, names)), ())
    with pytest.raises(AssertionError, match="forgotten"):
        render_templates(names, {**values, "forgotten": 1})
    values.pop("routes")
    with pytest.raises(AssertionError, match="routes"):
        render_templates(names, values)


def test_an_undefined_name_is_an_error():
    """A template cannot print a name that it was not given."""
    with pytest.raises(UndefinedError, match="spec_path"):
        environment().from_string("{{ spec_path }}").render()


def test_the_sandbox_refuses_the_classic_escape():
    """Should spec text ever reach a template, attribute chains into Python are refused."""
    attack = "{{ ''.__class__.__mro__[1].__subclasses__() }}"
    with pytest.raises(SecurityError):
        environment().from_string(attack).render()


@pytest.mark.parametrize(
    "text", ["kg */ int x;", "a /* b", "a\\", "a??/", 'x"""', "a\nb", "\u00b5m", "a\rb", "\x00"]
)
def test_text_that_could_leave_its_comment_is_refused(text):
    """Comment marks, backslashes, quotes, trigraphs and control characters reach no file."""
    with pytest.raises(SpecError) as caught:
        refuse_unsafe([Quantity("m", (), text, ("m",))])
    assert repr(text) in str(caught.value)
    assert caught.value.found == text


def template_source(template):
    """The text of a template as it stands in its file."""
    return environment().loader.get_source(environment(), template)[0]


def test_templates_name_no_system():
    """No template has a special case: none contains the name of a shipped system."""
    systems = [path.stem for path in derivations_folder().glob("*.toml")]
    for template in TEMPLATES.values():
        words = set(re.findall(r"\w+", template_source(template)))
        assert not words & {*systems, "heavy_top", "rigid_body", "kirchhoff", "Gamma", "Omega"}


def test_twins_have_the_same_blocks_in_the_same_order():
    """The templates of all targets print the same parts in the same order."""
    blocks = [
        "spec",
        "licence",
        "id",
        "routes",
        "equations",
        "state",
        "parameters",
        "functions",
    ]
    comments = ["of the parameters alone", "of each member", "results"]
    for template in ("numpy/kernel.py.j2", "c/kernel.c.j2", "python/kernel_python.py.j2"):
        text = template_source(template)
        assert names_read(template) >= set(blocks)
        head = text[text.index("Generated by") :]
        places = [re.search(rf"\b{block}\b", head).start() for block in blocks]
        assert places == sorted(places)
        places = [text.index(comment) for comment in comments]
        assert places == sorted(places)
