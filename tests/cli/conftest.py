"""What the tests of commands share: a runner, an empty working folder, and a cache of their own."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest
from click.testing import CliRunner

from coadjoint.cli import main
from tests.specs import RIGID_BODY


@pytest.fixture(scope="session", autouse=True)
def cache(shared_cache):
    """A cache that holds nothing of the user's, of all processes that run these tests."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("COADJOINT_CACHE", str(shared_cache))
        yield


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """An empty working folder."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def run(folder):
    """A command in this process: result with exit code, output and error text."""

    def invoke(*words):
        result = CliRunner().invoke(main, [str(word) for word in words])
        assert result.exception is None or isinstance(result.exception, SystemExit)
        return result

    return invoke


@pytest.fixture
def process(folder):
    """A command in a process of its own, its streams apart."""

    def invoke(*words, **options):
        command = [sys.executable, "-P", "-m", "coadjoint.cli", *map(str, words)]
        options = {"capture_output": True, "text": True} | options
        return subprocess.run(command, check=False, env={**os.environ}, **options)

    return invoke


@pytest.fixture
def rigid_body(folder):
    """A spec in the working folder."""
    path = folder / "body.toml"
    path.write_text(RIGID_BODY, encoding="utf-8")
    return path


@pytest.fixture
def false_claim(folder):
    """A spec with a claim that is false."""
    path = folder / "liar.toml"
    path.write_text(RIGID_BODY.replace('"dot(Pi, Pi)"', '"Pi[1] + Pi[2]"'), encoding="utf-8")
    return path
