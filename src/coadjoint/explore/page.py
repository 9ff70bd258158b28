"""The page: template, style, scripts, the generated kernel and data as one HTML file.

Comes in: the path of a spec. Goes out: the text of a page that needs no network and no other file.
Its policy lets the browser run this script and this style only, by their hashes, and load nothing.
Read next: `templates/explorer/page.html.j2`.
"""

from __future__ import annotations

import base64
import hashlib
import json
from collections.abc import Mapping
from functools import cache
from typing import Any, Final

from jinja2.sandbox import ImmutableSandboxedEnvironment
from markupsafe import Markup

from coadjoint.explore.scene import describe_scene
from coadjoint.pipeline import Rendered
from coadjoint.render.prose import set_text
from coadjoint.render.scripts import render_family_script, render_script
from coadjoint.render.strict import make_environment
from coadjoint.resources import templates_folder
from coadjoint.spec import Spec

#: The parts of the script, in order; the kernel stands before them.
SCRIPTS: Final = (
    "numerics.js",
    "noise.js",
    "waves.js",
    "rings.js",
    "matrices.js",
    "drawing.js",
    "model.js",
    "scenes.js",
    "particles.js",
    "portraits.js",
    "carriages.js",
    "members.js",
    "surfaces.js",
    "panels.js",
    "main.js",
)


def render_page(spec: Spec, rendered: Rendered) -> str:
    """The page of a system.

    Raises:
        KernelArgumentError: It shows no such system.
    """
    scene = describe_scene(spec, rendered)
    if rendered.family is not None:
        kernel = render_family_script(rendered.family.context)
    else:
        assert rendered.context is not None
        kernel = render_script(rendered.context)
    return assemble(scene, kernel)


def assemble(scene: Mapping[str, Any], kernel: str) -> str:
    """The page, from what it shows and the kernel.

    Args:
        scene: As `coadjoint.explore.scene.describe_scene` has it.
        kernel: The text of ``kernel.js``.
    """
    folder = templates_folder() / "explorer"
    parts = [(folder / name).read_text(encoding="utf-8") for name in SCRIPTS]
    flows = {flow for each in scene["methods"] for flow, _ in each["schedule"]}
    names = ", ".join([*scene["functions"], *sorted(flows)])
    code = f"const kernel = (() => {{\n{kernel}\nreturn {{ {names} }};\n}})();\n"
    script = '"use strict";\n' + _close_nothing(code + "\n".join(parts))
    style = (folder / "page.css").read_text(encoding="utf-8")
    return _environment().get_template("explorer/page.html.j2").render(
        scene=scene,
        tell=set_text,
        script=Markup(script),  # noqa: S704 (our files, and a kernel that `refuse_unsafe` passed)
        style=Markup(style),  # noqa: S704 (our file)
        data=Markup(_escape_json(scene)),  # noqa: S704 (escaped for a script element)
        policy=tell_policy(script, style),
    )  # fmt: skip


def tell_policy(script: str, style: str) -> str:
    """What a browser may do with the page: run one script and one style, and load nothing."""
    return (
        f"default-src 'none'; script-src '{_hash(script)}'; style-src '{_hash(style)}'; "
        "base-uri 'none'; form-action 'none'"
    )


def _hash(text: str) -> str:
    """The hash of an element's text, as policies have it."""
    return f"sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}"


def _close_nothing(script: str) -> str:
    """A script in which nothing ends its element, or opens a comment of HTML."""
    return script.replace("</", "<\\/").replace("<!--", "<\\!--")


def _escape_json(value: Any) -> str:
    r"""A value as JSON in which no character means anything to HTML.

    >>> _escape_json("</script>")
    '"\\u003c/script\\u003e"'
    """
    text = json.dumps(value, allow_nan=False)
    for character in "<>&":
        text = text.replace(character, f"\\u{ord(character):04x}")
    return text


@cache
def _environment() -> ImmutableSandboxedEnvironment:
    """The environment of the page, which escapes what a spec says."""
    return make_environment(autoescape=True)
