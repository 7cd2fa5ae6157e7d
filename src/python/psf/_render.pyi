# The compiled renderer, where the package was built with it; see _rendering.py.
from collections.abc import Callable, Sequence

def render(
    scene: str,
    output: str,
    images: Sequence[str],
    resume: bool,
    settings: Sequence[tuple[str, str]],
    progress: Callable[[int, int], object] | None,
) -> tuple[str, list[str]]: ...
def options() -> list[tuple[str, str, str, str]]: ...
