"""Command ``explore``: a page is written, and what it cannot show ends with status 2."""

from tests.cli.conftest import *  # noqa: F403
