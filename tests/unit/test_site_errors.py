"""A site file that cannot be read says what to do about that very fault."""

import pytest

from models.config.site import decode_site
from models.errors import UserError


@pytest.mark.parametrize(
    ("text", "remedy"),
    [
        ('version = 2\nname = "Gym\ncalibration = "rig.toml"\n', "a quote is not closed in that line, or before it; close it"),
        ('version = 2\nname = "Gym', "a quote is not closed in that line, or before it; close it"),
        ("version = 2\nname = 'Gym", "a quote is not closed in that line, or before it; close it"),
        (
            "version = 2\n[[cameras]\n",
            "it is no TOML there; look for a quote, a bracket or an equals sign that is missing, and correct it",
        ),
        (
            "version = 2\nname Gym\n",
            "it is no TOML there; look for a quote, a bracket or an equals sign that is missing, and correct it",
        ),
        ("version = 2\nname = 3\n", "see docs/configuration.md for every key"),
        ('version = "2"\n', "see docs/configuration.md for every key"),
    ],
)
def test_the_remedy_fits_the_fault(text: str, remedy: str) -> None:
    with pytest.raises(UserError) as error:
        decode_site(text.encode(), "site.toml")
    assert str(error.value).startswith("site file site.toml: ")
    assert str(error.value).endswith(f"; {remedy}")
    assert "\n" not in str(error.value)
