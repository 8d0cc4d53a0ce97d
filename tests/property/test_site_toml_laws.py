"""A site that is shown can be pasted back."""

import msgspec
from hypothesis import given
from hypothesis import strategies as st

from models.config.site import SITE_VERSION, CameraConfig, Site, TabletConfig, decode_site
from services.site_file.rendering import render

# All that TOML can hold: halves of surrogate pairs are no characters.
TEXTS = st.text(st.characters(exclude_categories=["Cs"]), min_size=1, max_size=80)
PATHS = st.text(st.characters(exclude_categories=["Cs"], exclude_characters="\0"), min_size=1, max_size=60)
HOSTS = st.sampled_from(["0.0.0.0", "::1", "fe80::1%eth0", "gym-box.local", "turnhalle-süd", "体育馆"])  # noqa: S104 - as site files have it
CAMERAS = st.builds(
    CameraConfig,
    name=st.just("a"),
    kind=st.just("video"),
    path=PATHS,
    rate_hz=st.floats(1e-9, 240),
    shutter_delay_ms=st.floats(-1000, 1000),
)
SITES = st.builds(
    lambda name, calibration, first, second, host: Site(
        version=SITE_VERSION,
        name=name,
        calibration=calibration,
        cameras=[first, msgspec.structs.replace(second, name="b")],
        tablet=TabletConfig(host=host),
    ),
    TEXTS, PATHS, CAMERAS, CAMERAS, HOSTS,
)  # fmt: skip


@given(SITES)
def test_a_site_written_and_read_again_is_the_same(site: Site) -> None:
    assert decode_site(render(site).encode(), "shown") == site
