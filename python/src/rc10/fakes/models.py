"""The three DJI motors: what their manuals say, and what had to be chosen."""

from __future__ import annotations

from dataclasses import dataclass

from rc10.fakes.shaft import RPM_PER_RAD_S

SUPPLY_V = 24.0


@dataclass(frozen=True)
class MotorModel:
    """A motor with its drive. Mechanical values are at the output shaft.

    Attributes:
        name: "M3508", "M2006" or "GM6020".
        max_id: ids are 1 to this.
        feedback_base: feedback of id N comes as this + N.
        gear_ratio: rotor turns for one output turn; the encoder is on the rotor.
        kt_nm_per_a: torque at the output for each ampere.
        current_scale_raw: raw value of a command or feedback that means current_scale_a; also
            the limit of a command.
        current_scale_a: see current_scale_raw.
        reports_temperature: False: the temperature byte is null.
        no_load_rpm: speed at which the supply drives no current any more.
        stall_a: current that the supply drives at standstill. A drive reaches any current
            between the two lines that fall from +-stall_a by speed, up to its own limit.
        inertia_kg_m2: rotor, gear and a light load.
        coulomb_nm: friction that does not depend on speed; also what it takes to start.
        viscous_nms_per_rad: friction for each rad/s.
        heating_k_per_a2: final rise of the winding for each squared ampere.
        heating_time_s: after which 63 % of that rise is there.
        electrical_lag_s: L / R, where the host may command a voltage.
    """

    name: str
    max_id: int
    feedback_base: int
    gear_ratio: float
    kt_nm_per_a: float
    current_scale_raw: int
    current_scale_a: float
    reports_temperature: bool
    no_load_rpm: float
    stall_a: float
    inertia_kg_m2: float
    coulomb_nm: float
    viscous_nms_per_rad: float
    heating_k_per_a2: float
    heating_time_s: float = 120.0
    electrical_lag_s: float = 0.0

    @property
    def no_load_rad_s(self) -> float:
        """no_load_rpm in rad/s."""
        return self.no_load_rpm / RPM_PER_RAD_S


def _stall_a(rated_a: float, rated_rpm: float, no_load_rpm: float) -> float:
    """Draws the line from no load through the rated point on to standstill."""
    return rated_a * no_load_rpm / (no_load_rpm - rated_rpm)


# Scales, ratios, torque constants, speeds and rated points are the manuals'. Inertia, friction
# and heating are in no manual: chosen for a lightly loaded motor, so that an idle motor takes a
# few percent of its rated current at full speed and gets there within tenths of a second.
M3508 = MotorModel(
    name="M3508",
    max_id=8,
    feedback_base=0x200,
    gear_ratio=3591 / 187,
    kt_nm_per_a=0.3,
    current_scale_raw=16384,
    current_scale_a=20.0,
    reports_temperature=True,
    no_load_rpm=482.0,
    stall_a=_stall_a(rated_a=10.0, rated_rpm=469.0, no_load_rpm=482.0),
    inertia_kg_m2=0.010,
    coulomb_nm=0.06,
    viscous_nms_per_rad=0.002,
    heating_k_per_a2=0.6,
)

M2006 = MotorModel(
    name="M2006",
    max_id=8,
    feedback_base=0x200,
    gear_ratio=36.0,
    kt_nm_per_a=0.18,
    current_scale_raw=10000,
    current_scale_a=10.0,
    reports_temperature=False,
    no_load_rpm=500.0,
    stall_a=_stall_a(rated_a=3.0, rated_rpm=416.0, no_load_rpm=500.0),
    inertia_kg_m2=0.003,
    coulomb_nm=0.03,
    viscous_nms_per_rad=0.0005,
    heating_k_per_a2=4.0,
)

GM6020 = MotorModel(
    name="GM6020",
    max_id=7,
    feedback_base=0x204,
    gear_ratio=1.0,
    kt_nm_per_a=0.741,
    current_scale_raw=16384,
    current_scale_a=3.0,
    reports_temperature=True,
    no_load_rpm=320.0,
    stall_a=SUPPLY_V / 1.8,  # the manual gives resistance and inductance of a phase
    inertia_kg_m2=0.005,
    coulomb_nm=0.03,
    viscous_nms_per_rad=0.002,
    heating_k_per_a2=15.0,
    electrical_lag_s=5.78e-3 / 1.8,
)

# The manual of 2020 allows +-30000. Later code takes 25000 for the full supply, and that is what
# a careful driver keeps to.
GM6020_VOLTAGE_SCALE_RAW = 25000

MODELS = {model.name: model for model in (M3508, M2006, GM6020)}
