"""Every effect of the contract in forms of its own, and strangers that no library has."""

from __future__ import annotations

from . import drive, foreign, friction, measurement, strangers, structure
from .foreign import FOREIGN
from .form import DEVELOPMENT, FORMS, SEALED, Form

__all__ = [
    "CAUSES", "DEVELOPMENT", "FOREIGN", "FORMS", "SEALED", "STRANGERS", "Form", "forms_of",
]  # fmt: skip

_MODULES = (drive, friction, structure, measurement, strangers, foreign)

STRANGERS = tuple(sorted({f.effect for f in FORMS.values() if f.effect.startswith("stranger_")}))
CAUSES = tuple(sorted({f.effect for f in FORMS.values()} - set(STRANGERS)))


def forms_of(effect: str, kept_for: str) -> list[Form]:
    """Forms of an effect in one of the sets, by name."""
    return [FORMS[k] for k in sorted(FORMS) if k[0] == effect and FORMS[k].kept_for == kept_for]
