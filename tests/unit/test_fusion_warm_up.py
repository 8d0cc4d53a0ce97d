"""What compiles the kernels before the first live frame must itself run: without it no box starts."""

from services.fusion.warm_up import warm_up


def test_the_warm_up_runs_to_its_end() -> None:
    warm_up()
