from .acquisition import (
    Acquisition as Acquisition,
)
from .analysis.regime import (
    Regime as Regime,
    friction_regime as friction_regime,
)
from .bushing import (
    LumpedBushing as LumpedBushing,
    lumped_bushing as lumped_bushing,
)
from .motion import (
    Motion as Motion,
    simulate_motion as simulate_motion,
)
from .run import (
    Run as Run,
    simulate as simulate,
)
from .shaft import (
    ConstantSpeed as ConstantSpeed,
    LoggedSpeed as LoggedSpeed,
    Oscillation as Oscillation,
    ShaftMotion as ShaftMotion,
    SpeedRamp as SpeedRamp,
)
