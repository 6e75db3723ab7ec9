"""Models of Damiao drives."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class DamiaoModel:
    """Differences between models, at the output shaft.

    Attributes:
        p_max_rad, v_max_rad_s, t_max_nm: what the ends of the fields mean, as delivered.
        gear: turns of the rotor for one of the output.
        kt_nm_per_a: torque for each ampere.
        max_a: 1.0 in per-unit currents.
        no_load_rpm: at its nominal voltage.
        inertia_kg_m2: rotor, gear and a light load.
    """

    p_max_rad: float
    v_max_rad_s: float
    t_max_nm: float
    gear: float
    kt_nm_per_a: float
    max_a: float
    no_load_rpm: float
    inertia_kg_m2: float


# Manuals, Seeed's table (docs/motors/damiao.md, "Sources"); inertias of the rotors behind
# their gear, doubled.
MODELS = {
    "DM3507": DamiaoModel(12.566, 50, 5, 7, 0.5439, 10.261194, 460, 8.5e-4),
    "DM4310": DamiaoModel(12.5, 30, 10, 10, 0.945, 10.261194, 200, 3.6e-3),
    "DM4340": DamiaoModel(12.5, 10, 28, 40, 4.074, 10.261194, 52.5, 6.4e-2),
    "DM6006": DamiaoModel(12.5, 45, 20, 6, 0.7308, 20.522388, 226, 4.2e-3),
    "DM8006": DamiaoModel(12.5, 45, 40, 6, 1.0206, 41.044776, 194.2, 8.3e-3),
    "DM8009": DamiaoModel(12.5, 45, 54, 9, 1.261575, 41.044776, 168, 3.2e-2),
    "DM10010": DamiaoModel(12.5, 20, 200, 10, 2.59875, 100.0, 75, 0.11),
    "DM10010L": DamiaoModel(12.5, 25, 200, 10, 2.00025, 99.7, 100, 0.11),
}
