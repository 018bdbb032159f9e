"""Which bushing is compared with where the rig file states none: that shipped for its material."""

from __future__ import annotations

from collections.abc import Sequence

from models.rig import Rig
from models.rig_file import load_material_rig, material_names


def assumed_fit(rig: Rig, interferences: Sequence[float]) -> str:
    """Say which shipped fit a rig has that was given none of its own; empty where it was.

    Parameters
    ----------
    rig : Rig
    interferences : sequence of float
        Of the recordings [m].

    Examples
    --------
    >>> assumed_fit(load_material_rig("fluorocarbon-thesis"), [0.279e-3])
    'no [[fit]] of its own in the rig file: the bushing is that shipped for fluorocarbon-thesis, \
0.279 mm: 665 Nm/rad, breaks at 10.7, slides at 8 N m'
    """
    shipped = [name for name in material_names() if load_material_rig(name).fits == rig.fits]
    if not shipped:
        return ""
    name = rig.material if rig.material in shipped else shipped[0]
    fits = [rig.fit(interference) for interference in sorted(set(interferences))]
    each = "; ".join(
        f"{1e3 * fit.interference:.3g} mm: {fit.elastomer_stiffness:.4g} Nm/rad, breaks at "
        f"{fit.critical_torque:.3g}, slides at {fit.kinetic_torque:.3g} N m"
        for fit in fits
    )
    return f"no [[fit]] of its own in the rig file: the bushing is that shipped for {name}, {each}"
